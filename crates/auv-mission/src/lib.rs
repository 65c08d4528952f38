//! The synchroniser: flies a mission leg by leg with any route planner and any path planner.
//!
//! [`Synchroniser`] is a pure state machine: events in (the vehicle's place, predicted regions, answers
//! of planners), commands out (plan a route, plan a path, follow a trajectory). A driver calls the
//! planners: [`driver::Stepped`] one after the other and reproducibly, `driver::Threaded` while the
//! vehicle moves. A real vehicle's software can be the driver.
//!
//! ```
//! use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
//! use auv_mission::{Mission, Observation, Outcome, SyncSettings, Synchroniser, driver::Stepped};
//! use auv_planning::{Vehicle, baseline::{GreedyRoute, StraightPath}};
//! use auv_types::{Point3, Seed, Vector3};
//! use std::sync::Arc;
//!
//! let waypoints = [0.0, 900.0, 1800.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 20.0)));
//! let task = Task { priority: 6.0, risk: 2.0, completion_time_s: 60.0 };
//! let edges = [Edge::undirected(0, 1, task), Edge::undirected(1, 2, task)];
//! let network = Arc::new(Network::new(&waypoints, &edges, 3.0)?);
//! let mission = Arc::new(Mission::new(network, NodeId(0), NodeId(2), 1_000.0, Vehicle::paper()));
//! let mut synchroniser = Synchroniser::new(mission, SyncSettings::default(), Seed(0))?;
//! let driver = Stepped::new(&GreedyRoute, &StraightPath);
//!
//! // A perfect vehicle: it follows the trajectory exactly and ticks at its end.
//! let mut time_s = 0.0;
//! while synchroniser.outcome().is_none() {
//!     let (position, velocity) = synchroniser
//!         .trajectory()
//!         .map_or((Point3::new(0.0, 0.0, 20.0), Vector3::zeros()), |t| t.at(time_s));
//!     driver.tick(&mut synchroniser, Observation { time_s, position, position_sigma_m: 0.0, velocity, regions: [].into() });
//!     time_s = synchroniser.due_s();
//! }
//! assert_eq!(synchroniser.outcome(), Some(Outcome::Docked));
//! assert_eq!((synchroniser.tasks(), synchroniser.available_s()), (2, 280.0));
//! # Ok::<(), auv_types::Violations>(())
//! ```
//!
//! # Features
//!
//! None is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `serde` | checkpoints, settings and tables can be written and read |
//! | `threads` | `driver::Threaded` plans while the vehicle moves |

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod activity;
mod agenda;
#[cfg(feature = "serde")]
mod any_number;
mod approach;
mod astray;
mod battery;
mod beliefs;
mod bow;
mod check;
#[cfg(feature = "serde")]
mod checkpoint;
mod climb;
mod climb_clear;
#[cfg(feature = "serde")]
mod consistency;
mod contingency;
mod course;
mod courses;
mod decide;
mod decision_table;
mod drift;
pub mod driver;
mod due;
mod emergency;
mod evade;
mod event;
mod facts;
#[cfg(feature = "serde")]
mod fingerprint;
mod fixes;
mod fixes_ahead;
#[cfg(test)]
mod fixture;
mod forecast;
mod fronts;
mod ladder;
mod leads;
mod ledger;
mod leg_time;
mod misplacement;
mod mission;
mod mode;
mod model_check;
mod navigation;
mod outcome;
mod outlook;
#[cfg(test)]
#[cfg(feature = "serde")]
mod own_checkpoints;
mod passage;
mod path_question;
mod pattern;
mod pattern_room;
mod pattern_way;
mod preflight;
mod question;
mod reflex;
mod room;
mod route_from_vehicle;
mod route_question;
mod senses;
mod set_point;
mod settings;
mod shortfall;
mod soundings;
mod state;
mod station_keeping;
mod surfacing;
mod synchroniser;
mod table2;
mod tide;
mod times;
mod trigger;
mod uncertainty;
mod view;
mod way_on;
mod works;

pub use activity::Activity;
pub use battery::Battery;
#[cfg(feature = "serde")]
pub use checkpoint::{Checkpoint, ResumeError};
pub use contingency::Contingency;
pub use courses::Courses;
pub use emergency::{Emergency, EmergencyCause};
pub use event::{Command, Event, Observation, PathRequest, RouteRequest};
pub use misplacement::Misplacement;
pub use mission::Mission;
pub use navigation::{Docking, Navigation, Surfacing};
pub use outcome::{AbortReason, Outcome, PathCall, RouteCall, RouteReason};
pub use outlook::{Earliest, Outlook, Stop};
pub use pattern::{Manner, Pattern};
pub use room::{Room, Shortage};
pub use set_point::{SetPoint, set_point};
pub use settings::{
    ComputeCharge, ExpectedTime, MarginSettings, PlanningSettings, ReplanPolicy, ReplanSettings,
    SyncSettings, WaitingSettings, WatchdogSettings, WithoutSonar,
};
pub use synchroniser::Synchroniser;
