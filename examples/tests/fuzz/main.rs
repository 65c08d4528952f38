//! Damaged and extreme input ends in an error or an answer: never a panic, a hang, a NaN, or memory without end.
//!
//! Each test is a target. It runs a number of cases that takes some seconds; `AUV_FUZZ_RUNS` sets another number, and
//! `AUV_FUZZ_FIRST` the first case, so that one case can be run again:
//!
//! ```sh
//! AUV_FUZZ_RUNS=1000000 cargo test --release -p auv-examples --test fuzz -- scenes
//! ```
//!
//! Charts, models and ship tracks have targets of their own beside their readers (`tests/damaged.rs` of auv-ocean and
//! auv-obstacles, `AUV_DAMAGED_FILES`); sequences of events in `own_checkpoints.rs` of auv-mission.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test that fails should say where"
)]

mod cases;
mod checkpoints;
mod files;
mod mutation;
mod planners;
mod scans;
