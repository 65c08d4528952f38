//! Independent checks of plans: [`verify_route`] for routes, [`verify_trajectory`] for
//! trajectories, [`verify_way_on`] for what is flown after a trajectory's end.
//!
//! Nothing here is shared with the planners. Times and weights are added up again from waypoints
//! and tasks. Clearance to moving and growing regions has a closed form of its own. The altitude
//! between samples is proven from the bed's slope. A report gives every figure and *everything*
//! that is wrong, not only the first.
//!
//! ```
//! use auv_obstacles::Region;
//! use auv_planning::{PathProblem, Vehicle};
//! use auv_types::Point3;
//! use auv_verify::{PathViolation, verify_trajectory};
//!
//! let vehicle = Vehicle::paper();
//! let rocks = [Region::ball(Point3::new(150.0, 12.0, 20.0), 10.0)];
//! let (start, target) = (Point3::new(0.0, 0.0, 20.0), Point3::new(300.0, 0.0, 20.0));
//! let mut problem = PathProblem { regions: &rocks, ..PathProblem::new(start, target, &vehicle) };
//! let straight = problem.timed(&[start, target])?;
//! let report = verify_trajectory(&problem, &straight);
//! assert!(report.is_valid() && (report.min_clearance_m() - 2.0).abs() < 1e-9);
//!
//! problem.clearance_m = 5.0;
//! let report = verify_trajectory(&problem, &straight);
//! assert!(matches!(report.violations[..], [PathViolation::TooClose { .. }]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Features
//! `conformance` adds the kit that any planner must pass, also your own.

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]
#![allow(
    clippy::neg_cmp_op_on_partial_ord,
    reason = "a NaN must fail a check, so limits are written as !(value <= limit)"
)]

mod altitude;
mod clearance;
mod closed_loop;
#[cfg(feature = "conformance")]
pub mod conformance;
mod motion;
mod obstacles;
mod path;
mod path_report;
mod route;
mod route_in_time;
mod show;
mod sum;
mod way_on;
mod way_on_report;

pub use obstacles::ClosestApproach;
pub use path::{RequiredEnds, verify_motion, verify_part, verify_trajectory};
pub use path_report::{PathReport, PathViolation};
pub use route::{RouteReport, RouteViolation, verify_route};
pub use route_in_time::{TimeViolation, verify_route_in_time};
pub use way_on::{WayOn, verify_way_on};
pub use way_on_report::{EndState, KeptEnd, WayOnReport, WayOnViolation};
