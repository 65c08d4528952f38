//! Branch and bound for prioritised tasks in a time budget, with a proven bound.

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]
