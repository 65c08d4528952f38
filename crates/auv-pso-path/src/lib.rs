//! Paths for one leg among static, uncertain, moving and drifting obstacles, behind
//! [`auv_planning::PathPlanner`]. One planner, two searches:
//!
//! - [`PathSearch::paper`] and [`PathSearch::standard`]: the paper's particle swarm over the control
//!   points of a B-spline (Eq. 11, 13-18), eight particles at a time, on any number of threads.
//! - [`PathSearch::default`]: the time-optimal search. A string under tension is tightened between the
//!   regions at its own arrival times. A lattice search finds a path where many regions crowd, and
//!   random detours look for better sides while there is time.
//!
//! Either way a violation of 0 means that the returned polyline passed the exact check against every
//! region, the box, the sea bed and the vehicle's limits, also between its vertices.
//!
//! # Determinism
//! Equal seed, problem and evaluation budget give equal bits at any number of threads. A deadline
//! only stops.
//!
//! ```
//! use auv_obstacles::Region;
//! use auv_planning::{Budget, PathPlanner, PathProblem, Run, Vehicle};
//! use auv_pso_path::{PathSearch, PsoPath};
//! use auv_types::{Point3, Seed};
//!
//! let vehicle = Vehicle::paper();
//! let regions = [Region::ball(Point3::new(500.0, 20.0, 50.0), 100.0)];
//! let problem = PathProblem {
//!     regions: &regions,
//!     ..PathProblem::new(Point3::new(0.0, 0.0, 50.0), Point3::new(1_000.0, 0.0, 50.0), &vehicle)
//! };
//! let mut run = Run::new(Seed(0), Budget::evaluations(200));
//! let planned = PsoPath::new(PathSearch::default()).plan_path(&mut run, &problem)?;
//! assert_eq!(planned.violation, 0.0);
//! assert!(planned.best.length_m() < 1_014.0);
//! # Ok::<(), auv_planning::PlanError>(())
//! ```
//!
//! # Features
//!
//! `parallel` is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `parallel` | several threads evaluate the swarm (`with_workers`); the results are the same |
//! | `serde` | settings can be written and read |

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod error;
mod examine;
mod path_search;
mod planner;
mod swarm;
mod taut;

pub use path_search::PathSearch;
pub use planner::PsoPath;
pub use swarm::{Acceleration, PathRanking, SwarmSettings, Windows};
pub use taut::TautSettings;
