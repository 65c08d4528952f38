//! Closed-loop simulated missions: the true sea, the vehicle, the sonar, and the judge.
//!
//! The synchroniser and its planners see what a real vehicle sees: charts, regions predicted from sonar
//! scans, and the vehicle's position. The truth (obstacles, current, sea bed) stays in this crate. The
//! [`Judgement`] compares the flown track with the truth continuously.
//!
//! - [`simulate`] flies a [`Scenario`] to its end; [`Simulation`] flies it step by step, with any driver, vehicle
//!   ([`SimulatedVehicle`]), sonar ([`SimulatedSonar`]) and tracker ([`auv_obstacles::ObstaclePredictor`]).
//! - [`Campaign`] draws the missions of the paper's Table 2; [`faults`] injects faults; [`oracle`] and [`unavoidable_s`]
//!   tell whether a collision could have been avoided.
//! - A [`Recorder`] sees everything: `Log` (feature `serde`), or pictures by `auv-report`.
//!
//! ```
//! use auv_mission::driver::Stepped;
//! use auv_planning::baseline::{GreedyRoute, StraightPath};
//! use auv_sim::{Campaign, MissionOutcome, simulate};
//! use auv_types::Seed;
//!
//! let mut campaign = Campaign::table2(Seed(1))?;
//! campaign.obstacles = 4;
//! let scenario = campaign.scenario(0)?;
//! let summary = simulate(&scenario, &Stepped::new(&GreedyRoute, &StraightPath), &mut ())?;
//! assert_eq!((summary.outcome, summary.judgement.collisions), (MissionOutcome::Docked, 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Features
//!
//! None is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `serde` | summaries and settings can be written; `Log` |
//! | `mission-file` | missions from TOML files: module `mission_file` |
//! | `netcdf` | their charts and currents from NetCDF files |
//! | `geotiff` | their charts from GeoTIFF files |

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod altimeter;
mod body;
mod campaign;
mod closed_loop;
mod disturbance;
mod drawn_current;
pub mod faults;
mod fences;
mod following;
mod guidance;
mod judge;
mod limits;
#[cfg(feature = "serde")]
mod log;
#[cfg(feature = "mission-file")]
pub mod mission_file;
mod navigator;
pub mod oracle;
mod point_vehicle;
mod preset;
mod recorder;
mod scans;
mod scenario;
mod simulate;
mod simulation;
mod sonar;
pub mod statistics;
mod summary;
mod unavoidable;
mod varied;
mod vehicle;

pub use altimeter::Altimeter;
pub use body::Body;
pub use campaign::Campaign;
pub use fences::{Fence, Fences};
pub use following::Following;
pub use guidance::Guidance;
pub use judge::Judgement;
pub use limits::{Limit, LimitBroken};
#[cfg(feature = "serde")]
pub use log::Log;
pub use preset::{Preset, PresetCurrent, PresetValues};
pub use recorder::{Entry, Recorder};
pub use scenario::Scenario;
pub use simulate::simulate;
pub use simulation::Simulation;
pub use sonar::SimulatedSonar;
pub use summary::{EndReason, MissionOutcome, Summary};
pub use unavoidable::unavoidable_s;
pub use vehicle::SimulatedVehicle;
