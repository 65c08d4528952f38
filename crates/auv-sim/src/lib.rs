//! Closed-loop simulated missions: the true ocean, the vehicle, the sonar, and the judge.
//!
//! The synchroniser and its planners see what a vehicle would see: charts, scans turned into
//! predicted regions, their own position. What is true stays here: obstacles, current, sea bed; the
//! [`Judgement`] compares the flown track with it continuously.

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod campaign;
mod disturbance;
pub mod faults;
mod judge;
#[cfg(feature = "serde")]
mod log;
#[cfg(feature = "serde")]
pub mod mission_file;
pub mod oracle;
mod recorder;
mod scenario;
mod simulate;
mod summary;
mod vehicle;

pub use campaign::Campaign;
pub use judge::Judgement;
#[cfg(feature = "serde")]
pub use log::Log;
pub use recorder::{Entry, Recorder};
pub use scenario::Scenario;
pub use simulate::simulate;
pub use summary::{MissionOutcome, Summary};
