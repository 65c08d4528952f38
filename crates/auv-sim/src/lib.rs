//! Closed-loop simulated missions: the true sea, the vehicle, the sonar, and the judge.
//!
//! The synchroniser and its planners see what a real vehicle sees: charts, regions predicted from sonar
//! scans, and the vehicle's position. The truth (obstacles, current, sea bed) stays in this crate. The
//! [`Judgement`] compares the flown track with the truth continuously.

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
mod judge;
mod limits;
#[cfg(feature = "serde")]
mod log;
#[cfg(feature = "mission-file")]
pub mod mission_file;
mod navigator;
pub mod oracle;
mod preset;
mod recorder;
mod scenario;
mod simulate;
pub mod statistics;
mod summary;
mod unavoidable;
mod varied;
mod vehicle;
mod way;

pub use altimeter::Altimeter;
pub use body::Body;
pub use campaign::Campaign;
pub use fences::{Fence, Fences};
pub use following::Following;
pub use judge::Judgement;
pub use limits::{Limit, LimitBroken};
#[cfg(feature = "serde")]
pub use log::Log;
pub use preset::{Preset, PresetCurrent, PresetValues};
pub use recorder::{Entry, Recorder};
pub use scenario::Scenario;
pub use simulate::simulate;
pub use summary::{EndReason, MissionOutcome, Summary};
pub use unavoidable::unavoidable_s;
