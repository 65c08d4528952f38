//! Predictors: from scans to the regions planners see.

use crate::{Region, Scan};
use auv_types::Vector3;
use std::fmt::Debug;

/// Turns what the sonar reports into what the obstacles will cover.
///
/// # Determinism
/// Equal scans in equal order give equal regions, bit for bit.
pub trait ObstaclePredictor: Debug + Send {
    /// Takes in one scan. Malformed, stale or repeated scans and echoes change nothing.
    fn observe(&mut self, scan: &Scan);

    /// What the obstacles cover from `time_s` on, as far as known now.
    fn at(&self, time_s: f64) -> Vec<Region>;
}

/// Knows the truth as its caller sets it: the upper bound of what prediction can give.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Perfect {
    /// What [`ObstaclePredictor::at`] answers; set it to `truth::ObstacleField::now` before asking.
    pub regions: Vec<Region>,
}

impl ObstaclePredictor for Perfect {
    fn observe(&mut self, _scan: &Scan) {}

    fn at(&self, _time_s: f64) -> Vec<Region> {
        self.regions.clone()
    }
}

/// Believes that everything stays where the last scan showed it: the baseline a tracker must beat.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Frozen {
    /// Obstacles known beforehand, always part of the answer.
    pub charted: Vec<Region>,
    seen: Vec<Region>,
}

impl ObstaclePredictor for Frozen {
    fn observe(&mut self, scan: &Scan) {
        self.seen.clear();
        self.seen.extend(
            scan.detections
                .iter()
                .filter(|d| d.position.iter().all(|x| x.is_finite()) && d.radius_m.is_finite())
                .map(|d| Region {
                    velocity_mps: Vector3::zeros(),
                    ..Region::ball(d.position, d.radius_m.max(0.0))
                }),
        );
    }

    fn at(&self, _time_s: f64) -> Vec<Region> {
        [self.charted.as_slice(), self.seen.as_slice()].concat()
    }
}
