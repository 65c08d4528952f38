//! An exact planner for prioritised tasks in a time budget: branch and bound over partial routes with
//! bounds from relaxed walks. It proves optimality on small networks and gives a proven bound on
//! larger ones.
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

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod arc_fixing;
mod digraph;
mod incumbent;
mod knapsack;
mod labels;
mod memory;
mod planner;
mod prices;
mod proof;
mod settings;
mod subgradient;
#[cfg(test)]
mod testing;
mod walks;

pub use planner::ExactRoute;
pub use settings::ExactSettings;
