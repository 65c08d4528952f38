//! An exact planner for prioritised tasks in a time budget: branch and cut on a linear relaxation. It
//! proves optimality on networks of up to a few hundred nodes and gives a proven bound on larger ones.
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
//!
//! # Features
//!
//! None is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `serde` | settings can be written and read |

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod branch_and_cut;
mod branching;
mod connectivity;
mod cut;
mod decision;
mod dense;
mod digraph;
mod flow;
mod in_time;
mod incumbent;
mod inverse;
mod knapsack;
mod links;
mod multipliers;
mod parity;
mod part;
mod planner;
mod program;
mod proof;
mod relaxation;
mod root_bound;
mod separation;
mod settings;
mod simplex;
mod support;
#[cfg(test)]
mod testing;

pub use planner::ExactRoute;
pub use settings::ExactSettings;
