//! Planners with one fault each: the check meant for it catches it, and a mission flown with it ends
//! without a collision. Hanging planners are flown by the tests of the threaded driver.

#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "faults panic on purpose, and a test may"
)]

#[path = "../../../crates/auv-verify/tests/main/faulty.rs"]
mod faulty;
#[path = "../../../crates/auv-verify/tests/main/misread.rs"]
mod misread;
mod paths;
mod routes;

use auv_mission::driver::Stepped;
use auv_planning::{PathPlanner, RoutePlanner};
use auv_sim::{Campaign, Log, simulate};
use auv_types::Seed;
use auv_verify::conformance::FailedChecks;
use std::time::Duration;

/// Wastes time as a slow planner does.
#[allow(
    clippy::disallowed_methods,
    reason = "a fault under test is to be slow"
)]
fn pause(milliseconds: u64) {
    std::thread::sleep(Duration::from_millis(milliseconds));
}

/// The kit's failures hold the check meant for a fault.
fn assert_caught(outcome: Result<(), FailedChecks>, check: &str) {
    let failures = outcome.unwrap_err().0;
    let is_caught = failures.iter().any(|failure| failure.check == check);
    assert!(is_caught, "\"{check}\" does not fail, but: {failures:#?}");
}

/// A mission of the Table 2 set-up with these planners hits nothing.
fn assert_harmless(routes: &dyn RoutePlanner, paths: &dyn PathPlanner, fault: &str) {
    let scenario = Campaign::table2(Seed(7)).unwrap().scenario(1).unwrap();
    let driver = Stepped::new(routes, paths);
    let summary = simulate(&scenario, &driver, &mut Log::hash_only()).unwrap();
    assert_eq!(summary.judgement.collisions, 0, "{fault}: {summary}");
}
