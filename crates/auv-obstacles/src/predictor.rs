//! Predictors: from scans to predicted regions.

use crate::{Region, Scan};
use auv_types::Vector3;
use std::fmt::Debug;

/// Predicts the regions that obstacles will cover, from scans of the sonar.
///
/// # Determinism
/// Equal scans in equal order give equal regions, bit for bit.
pub trait ObstaclePredictor: Debug + Send {
    /// Processes one scan. Malformed, stale or repeated scans and echoes change nothing.
    fn observe(&mut self, scan: &Scan);

    /// The predicted regions from `time_s` on.
    fn at(&self, time_s: f64) -> Vec<Region>;
}

/// Returns the truth its caller has set: the upper bound of any prediction.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Perfect {
    /// The result of [`ObstaclePredictor::at`]: set it to `truth::ObstacleField::now` beforehand.
    pub regions: Vec<Region>,
}

impl ObstaclePredictor for Perfect {
    fn observe(&mut self, _scan: &Scan) {}

    fn at(&self, _time_s: f64) -> Vec<Region> {
        self.regions.clone()
    }
}

/// Predicts that everything stays where the last scan showed it: the baseline for trackers.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Frozen {
    /// Charted obstacles, part of every prediction.
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
