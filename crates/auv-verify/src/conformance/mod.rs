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
//! A planner that panics fails the check it panics in. A planner that never ends makes the kit hang,
//! but for [`path_planner_within`] and [`route_planner_within`], which name the check that hangs.
//! [`paths_on_threads`] and [`routes_on_threads`] check that plans do not depend on the number of
//! threads: how many a planner uses, only its own settings know.

mod any_planner;
mod checks;
mod drawn_network;
mod malformed_paths;
mod path;
mod path_at_sea;
mod path_call;
mod path_regions;
mod route;
mod route_in_time;
mod threads;
mod warm_starts;
mod watch;

pub use checks::{FailedCheck, FailedChecks};
pub use path::{path_planner, path_planner_within};
pub use route::{route_planner, route_planner_within};
pub use threads::{paths_on_threads, routes_on_threads};
