//! The Imperialist Competitive Algorithm for prioritised tasks in a time budget, which the paper
//! compares its genetic algorithm with (Section 8.1).
//!
//! Countries are priority vectors. They are decoded and costed as the genetic algorithm's initial
//! routes are, and under the same seed the first countries are the same vectors. Colonies move towards
//! their imperialists, undergo revolutions and replace worse imperialists; the weakest empire loses
//! colonies until it is eliminated.
//!
//! # Determinism
//! Equal seed and evaluation budget give equal routes at any number of threads. If the clock or the
//! caller cuts a search short, the answer is no worse than that of
//! [`auv_planning::baseline::GreedyRoute`].
//!
//! # References
//! E. Atashpaz-Gargari and C. Lucas, "Imperialist competitive algorithm", IEEE CEC 2007.
//!
//! ```
//! use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
//! use auv_ica_route::{IcaRoute, IcaSettings};
//! use auv_planning::{Budget, RoutePlanner, RouteProblem, Run};
//! use auv_types::{Point3, Seed};
//!
//! let waypoints = [0.0, 900.0, 1800.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 20.0)));
//! let task = Task { priority: 6.0, risk: 2.0, completion_time_s: 60.0 };
//! let edges = [(0, 1), (1, 2), (0, 2)].map(|(a, b)| Edge::undirected(a, b, task));
//! let network = Network::new(&waypoints, &edges, 3.0)?;
//! let problem = RouteProblem::new(&network, NodeId(0), NodeId(2), 800.0);
//! let mut run = Run::new(Seed(0), Budget::evaluations(1_000));
//! let planned = IcaRoute::new(IcaSettings::paper()).plan_route(&mut run, &problem)?;
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

mod empires;
mod imperialism;
mod planner;
mod settings;

pub use auv_route_encoding::{Decoding, RouteRanking};
pub use planner::IcaRoute;
pub use settings::IcaSettings;
