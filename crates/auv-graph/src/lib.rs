//! Waypoint networks: waypoints, edges that each have a task, routes over them, and the criteria that a
//! feasible route meets (equations 1 and 6 to 10, Fig. 6).
//!
//! ```
//! use auv_graph::{Edge, EdgeSet, Network, NodeId, Route, Task, Waypoint};
//! use auv_types::Point3;
//!
//! let waypoints = [0.0, 900.0, 1800.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 20.0)));
//! let task = Task { priority: 6.0, risk: 2.0, completion_time_s: 60.0 };
//! let edges = [Edge::undirected(0, 1, task), Edge::undirected(1, 2, task)];
//! let network = Network::new(&waypoints, &edges, 3.0)?;
//! let route = Route::new([0, 1, 2].map(NodeId).to_vec());
//! let totals = network.evaluate(&route, &EdgeSet::empty(), None)?;
//! assert_eq!((totals.weight, totals.time_s, totals.tasks), (6.0, 720.0, 2));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Features
//!
//! None is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `serde` | networks, routes and tasks can be written and read; module `format` reads instance files |

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod builder;
mod edge_set;
pub mod format;
mod ids;
mod instance;
mod network;
#[cfg(feature = "serde")]
mod network_serde;
mod profile;
mod quickest;
mod route;
mod terrain;
mod time_model;
mod timed_task;
mod unknown_waypoint;
mod waypoint;

pub use builder::NetworkBuilder;
pub use edge_set::EdgeSet;
pub use ids::{ArcId, EdgeId, NodeId};
pub use instance::RouteInstance;
pub use network::{Network, NetworkArc};
pub use profile::{Profile, Profiles};
pub use quickest::QuickestTo;
pub use route::{Infeasible, Route, RouteTotals};
pub use terrain::{NoInstance, Positions, Terrain, Topology, UniformRange};
pub use time_model::{Chain, Passing, TimeModel, Visits};
pub use timed_task::{TIME_TOLERANCE_S, TaskName, TaskPlace, TimedTask};
pub use unknown_waypoint::UnknownWaypoint;
pub use waypoint::{Edge, Task, Waypoint};
