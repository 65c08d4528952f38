//! The interface between planners and their callers: the two traits every planner implements, what a
//! planner is given ([`RouteProblem`], [`PathProblem`], [`Run`]) and what it gives back ([`Planned`],
//! [`Trajectory`], [`PlanError`]). [`motion`] has the motion geometry that planners and missions
//! share; [`front`] has the fronts of earliest arrival; [`LegTime`] tells how long a leg takes. What problems are made of is here too, so that a planner's crate
//! depends on this one alone: [`graph`], [`obstacles`], [`ocean`], [`bspline`], [`types`].
//!
//! Planners are given time, seed and data. They read no clock, no global randomness and no files, and
//! print nothing. Equal seed and equal evaluation budget give equal bits at any thread count.
//!
//! A *violation* is a number: how far a plan is from feasible (0: feasible). [`Violations`] is a list:
//! all errors in an input.
//!
//! [`Violations`]: auv_types::Violations
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
//!
//! # Features
//!
//! None is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `serde` | problems and plans can be written and read; module `format` reads scenes |

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

pub mod baseline;
mod budget;
pub mod departure;
mod edges_left_out;
#[cfg(feature = "serde")]
pub mod format;
pub mod front;
mod leg_manoeuvres;
mod leg_outline;
mod leg_time;
pub mod motion;
mod objective;
mod path_problem;
mod path_timing;
mod planned;
mod planner;
pub mod polyline;
mod quickest_route;
mod restarts;
mod route_problem;
mod run;
mod schedule;
mod score;
mod stats;
pub mod timed;
mod trajectory;
mod vehicle;

// A planner's crate needs this crate alone.
pub use auv_bspline as bspline;
pub use auv_graph as graph;
pub use auv_obstacles as obstacles;
pub use auv_ocean as ocean;
pub use auv_types as types;

pub use budget::Budget;
pub use edges_left_out::edges_left_out;
pub use leg_outline::{Arrival, LegOutline, UnderWay};
pub use leg_time::{LegDuration, LegTime};
pub use motion::NotFlyable;
pub use objective::{Objective, RouteCost, TaskCost};
pub use path_problem::PathProblem;
pub use planned::{PlanError, Planned};
pub use planner::{PathPlanner, RoutePlanner};
pub use quickest_route::QuickestRoute;
pub use restarts::Restarts;
pub use route_problem::RouteProblem;
pub use run::{Deadline, Generation, Run};
pub use schedule::{Schedule, TaskDone};
pub use score::Score;
pub use stats::{Stats, StopReason};
pub use trajectory::Trajectory;
pub use vehicle::Vehicle;
