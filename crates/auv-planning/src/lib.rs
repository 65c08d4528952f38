//! The seam of the workspace: the two traits every planner implements, what a planner is given
//! ([`RouteProblem`], [`PathProblem`], [`Run`]) and what it gives back ([`Planned`], [`Trajectory`],
//! [`PlanError`]).
//!
//! Planners are given time, seed and data; they read no clock, no global randomness and no files,
//! and print nothing. Equal seed and equal evaluation budget give equal bits at any thread count.
//!
//! ```
//! use auv_planning::baseline::StraightPath;
//! use auv_planning::{Budget, PathPlanner, PathProblem, Run, Vehicle};
//! use auv_types::{Point3, Seed};
//!
//! let vehicle = Vehicle::paper();
//! let problem = PathProblem::new(Point3::origin(), Point3::new(300.0, 0.0, 10.0), &vehicle);
//! let mut run = Run::new(Seed(0), Budget::evaluations(1));
//! let planned = StraightPath.plan_path(&mut run, &problem)?;
//! assert!(planned.violation == 0.0 && (planned.best.duration_s() - 100.05).abs() < 0.01);
//! # Ok::<(), auv_planning::PlanError>(())
//! ```

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

pub mod baseline;
#[cfg(feature = "serde")]
pub mod format;
mod leg_time;
pub mod motion;
mod objective;
mod path_problem;
mod planned;
mod planner;
pub mod polyline;
mod quickest_route;
mod route_problem;
mod run;
mod score;
mod trajectory;
mod vehicle;

pub use leg_time::{LegDuration, LegOutline, LegTime};
pub use motion::NotFlyable;
pub use objective::{Objective, RouteCost, TaskCost};
pub use path_problem::PathProblem;
pub use planned::{PlanError, Planned, Stats};
pub use planner::{PathPlanner, RoutePlanner};
pub use quickest_route::QuickestRoute;
pub use route_problem::RouteProblem;
pub use run::{Budget, Deadline, Generation, Run, StopReason};
pub use score::Score;
pub use trajectory::Trajectory;
pub use vehicle::Vehicle;
