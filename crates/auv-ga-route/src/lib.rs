//! A genetic algorithm for prioritised tasks in a time budget.

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]
