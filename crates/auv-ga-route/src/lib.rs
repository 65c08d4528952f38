//! Genetic algorithms that choose which waypoints to visit, and in which order, within a time budget,
//! so that the tasks on the edges travelled have the greatest total weight.
//!
//! [`GaRoute`] runs one of two algorithms, chosen by its [`GaSettings`]:
//! - [`GaSettings::paper`]: the paper's generational algorithm (Sections 4.1 to 4.6, Fig. 5 to 9) with
//!   priority vectors, roulette selection, uniform crossover, insertion, swap and inversion;
//! - [`GaSettings::default`]: a memetic algorithm with edge-assembly crossover (Nagata and Kobayashi
//!   2013), extended to nodes that may be left out, and a local search on profit and time together. It
//!   minimises [`auv_planning::Objective::MostWeight`] and the paper's cost with `1 / W_R`. Under the
//!   paper's two literal variants of that cost the generational algorithm runs in its place.
//!
//! # Determinism
//! Equal seed and evaluation budget give equal routes at any number of threads. One evaluation is
//! one route decoded or assembled, or one descent step. If the clock or the caller cuts a search
//! short, the answer is no worse than that of [`auv_planning::baseline::GreedyRoute`].
//!
//! ```
//! use auv_ga_route::{GaRoute, GaSettings};
//! use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
//! use auv_planning::{Budget, RoutePlanner, RouteProblem, Run};
//! use auv_types::{Point3, Seed};
//!
//! let waypoints = [0.0, 900.0, 1800.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 20.0)));
//! let task = Task { priority: 6.0, risk: 2.0, completion_time_s: 60.0 };
//! let edges = [(0, 1), (1, 2), (0, 2)].map(|(a, b)| Edge::undirected(a, b, task));
//! let network = Network::new(&waypoints, &edges, 3.0)?;
//! let problem = RouteProblem::new(&network, NodeId(0), NodeId(2), 800.0);
//! let mut run = Run::new(Seed(0), Budget::evaluations(1_000));
//! let planned = GaRoute::new(GaSettings::default()).plan_route(&mut run, &problem)?;
//! assert_eq!((planned.best.nodes().len(), planned.cost, planned.violation), (3, -6.0, 0.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Features
//!
//! `parallel` is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `parallel` | several threads evaluate a population (`with_workers`); the results are the same |
//! | `serde` | settings can be written and read |

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod corridor_route;
mod crossover;
mod evolution;
mod evolution_settings;
mod in_time;
mod memetic;
mod memetic_settings;
mod mutation;
mod planner;
mod repair;
mod settings;

pub use auv_route_encoding::{Decoding, RouteRanking};
pub use evolution_settings::{EvolutionSettings, InvalidOffspring};
pub use memetic_settings::MemeticSettings;
pub use planner::GaRoute;
pub use settings::GaSettings;
