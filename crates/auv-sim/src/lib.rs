//! Closed-loop simulated missions.

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]
