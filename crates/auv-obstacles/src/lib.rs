//! Obstacles for planning under water: the regions planners see, their estimation, and the true
//! obstacles.
//!
//! - [`Region`]: a predicted region, the only form in which planners see obstacles. A ball or a vertical
//!   cylinder that moves and grows linearly within a time window; its clearance to a timed segment has a
//!   closed form.
//! - [`Sonar`], [`Scan`], [`Detection`]: the measurements.
//! - [`ObstaclePredictor`] with its implementations [`Tracker`], [`Perfect`] and [`Frozen`]: from scans to
//!   regions. [`ClearancePolicy`]: the margins added to regions.
//! - [`ShipForecast`]: the prediction of a ship that its transponder reports.
//! - [`truth`]: the paper's four obstacle classes and ships, for simulators only.
//! - Feature `ais`: recorded ship tracks from comma-separated text.
//!
//! ```
//! use auv_obstacles::{Region, TimedPoint};
//! use auv_types::{Point3, Vector3};
//!
//! let rock = Region::ball(Point3::new(50.0, 10.0, 0.0), 4.0);
//! let from = TimedPoint::new(Point3::origin(), 0.0);
//! let to = TimedPoint::new(Point3::new(100.0, 0.0, 0.0), 50.0);
//! let closest = rock.clearance(&from, &to);
//! assert!((closest.clearance_m - 6.0).abs() < 1e-9 && (closest.time_s - 25.0).abs() < 1e-6);
//! ```
//!
//! From true obstacles through a sonar to predicted regions:
//! ```
//! use auv_obstacles::truth::{ObstacleClass, FieldSettings, Obstacle, ObstacleField};
//! use auv_obstacles::{ObstaclePredictor, Sonar, Tracker, TrackerSettings};
//! use auv_types::{Point3, Seed, Vector3};
//!
//! # fn main() -> Result<(), auv_types::Violations> {
//! let swimmer = Obstacle::new(ObstacleClass::Moving, Point3::new(400.0, 0.0, 50.0), 20.0)
//!     .with_velocity(Vector3::new(-0.4, 0.1, 0.0));
//! let mut field = ObstacleField::new(vec![swimmer], FieldSettings::campaign(), Seed(1))?;
//! let (sonar, mut tracker) = (Sonar::paper(), Tracker::new(TrackerSettings::campaign())?);
//! let mut random = Seed(2).stream(0);
//! for _ in 0..30 {
//!     field.step(10.0, &|_, _| Vector3::zeros());
//!     let here = Point3::new(0.0, 0.0, 50.0);
//!     tracker.observe(&sonar.scan(field.now(), &here, 0.0, field.time_s(), &mut random));
//! }
//! let predicted = tracker.at(field.time_s());
//! assert!(!predicted.is_empty());
//! # Ok(())
//! # }
//! ```
//!
//! # Features
//!
//! None is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `ais` | recorded ship tracks from comma-separated text |
//! | `serde` | regions, scans, trackers and their settings can be written and read |

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

#[cfg(feature = "ais")]
pub mod ais;
mod approach;
mod clearance;
mod detection;
mod predictor;
mod random;
mod region;
mod sonar;
mod tracker;
mod transponder;
pub mod truth;
#[cfg(feature = "serde")]
mod unbounded;

pub use approach::Closest;
pub use clearance::{ClearancePolicy, RegionSource};
pub use detection::{Detection, Scan};
pub use predictor::{Frozen, ObstaclePredictor, Perfect};
pub use region::{ObstacleId, Region, RegionShape, TimedPoint};
pub use sonar::Sonar;
pub use tracker::{Rejected, Track, Tracker, TrackerSettings, sigmas_in_space};
pub use transponder::ShipForecast;
