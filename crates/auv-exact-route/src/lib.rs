//! The exact planner for prioritised tasks in a time budget: branch and bound over partial routes
//! with bounds from relaxed walks, proving optimality on small networks and giving a proven bound
//! on all.
//!
//! ```
//! use auv_exact_route::ExactRoute;
//! use auv_graph::Terrain;
//! use auv_planning::{Budget, RoutePlanner, RouteProblem, Run, StopReason};
//! use auv_types::Seed;
//!
//! let instance = Terrain::paper(10, 40).draw(Seed(1))?;
//! let problem = RouteProblem::new(&instance.network, instance.start, instance.destination, 9000.0);
//! let mut run = Run::new(Seed(0), Budget::to_the_cap());
//! let planned = ExactRoute::default().plan_route(&mut run, &problem)?;
//! assert_eq!(planned.stats.stop, StopReason::Optimal);
//! assert_eq!(planned.bound, Some(planned.cost));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod digraph;
mod labels;
mod planner;
mod prices;
mod relaxation;
mod settings;

pub use planner::ExactRoute;
pub use settings::ExactSettings;
