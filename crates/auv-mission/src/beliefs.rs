//! What the synchroniser believes: time, place, altitude, predicted obstacles.

use crate::Mission;
use crate::drift::Drift;
use auv_obstacles::Region;
use auv_types::{Point3, Vector3};
use std::sync::Arc;

/// What the synchroniser believes.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Beliefs {
    pub(crate) now_s: f64,
    /// Ticks in a row at which the clock stood still.
    pub(crate) stalls: u32,
    /// Time of the last fix that was believed.
    pub(crate) fixed_s: f64,
    pub(crate) position: Point3<f64>,
    /// Standard deviation of its horizontal error, metres.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) sigma_m: f64,
    /// When the vehicle was below the surface last, and when it last had been at the surface for as long as a fix
    /// takes.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) under_s: f64,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) fix_s: f64,
    pub(crate) velocity: Vector3<f64>,
    pub(crate) altimeter: Altimeter,
    pub(crate) drift: Drift,
    /// Predicted regions in the drifting frame: the believed drift is subtracted from their velocities.
    pub(crate) regions: Arc<[Region]>,
}

/// When the altitude was measured last, and what was not placed yet.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Altimeter {
    /// Never.
    Silent,
    /// Since the last tick, metres. It is dated and placed by the next tick, because it may have come at any
    /// time up to then.
    Fresh(#[cfg_attr(feature = "serde", serde(with = "crate::any_number"))] f64),
    /// At this tick.
    At(f64),
}

impl Beliefs {
    pub(crate) fn new(mission: &Mission) -> Self {
        Self {
            now_s: 0.0,
            stalls: 0,
            fixed_s: 0.0,
            position: mission.position_of(mission.start),
            sigma_m: 0.0,
            under_s: 0.0,
            fix_s: 0.0,
            velocity: Vector3::zeros(),
            altimeter: Altimeter::Silent,
            drift: Drift::default(),
            regions: Arc::new([]),
        }
    }

    /// Whether the altitude was measured once and has been silent for longer than a time.
    pub(crate) fn altitude_is_lost(&self, silence_s: f64) -> bool {
        matches!(self.altimeter, Altimeter::At(time_s) if self.now_s - time_s > silence_s)
    }
}
