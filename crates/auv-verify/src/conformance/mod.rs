//! The kit any planner must pass, also your own: call it in a test of your planner's crate.
//!
//! ```
//! use auv_planning::baseline::{GreedyRoute, StraightPath};
//!
//! auv_verify::conformance::route_planner(&GreedyRoute)?;
//! auv_verify::conformance::path_planner(&StraightPath)?;
//! # Ok::<(), auv_verify::conformance::FailedChecks>(())
//! ```
//!
//! The kit does not watch the clock: a planner that ignores its deadline makes it hang. A planner
//! that panics fails the check it panics in.

mod any_planner;
mod checks;
mod drawn_network;
mod path;
mod route;
mod route_in_time;

pub use checks::{FailedCheck, FailedChecks};
pub use path::path_planner;
pub use route::route_planner;
