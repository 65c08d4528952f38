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

    /// The charted obstacles: part of every prediction, unchanged.
    fn charted_regions(&self) -> &[Region];

    /// The regions of what was seen, from `time_s` on, without the charted obstacles.
    fn contacts(&self, time_s: f64) -> Vec<Region>;

    /// Mission time of the last accepted scan, seconds; `None` before the first.
    fn fresh_s(&self) -> Option<f64>;

    /// Whether something closes in so fast that the vehicle should decide now, not at its next tick.
    fn is_urgent(&self) -> bool {
        false
    }

    /// How far predictions reach beyond the time they are made for, seconds.
    fn horizon_s(&self) -> f64;

    /// The predicted regions from `time_s` on: what is charted, then what was seen.
    fn at(&self, time_s: f64) -> Vec<Region> {
        [self.charted_regions(), &self.contacts(time_s)].concat()
    }

    /// Sets by how much the vehicle's own place may be wrong, metres: so far from where it should be, an echo may
    /// still be that of a charted obstacle. Call this before each scan.
    fn unsure_of_place(&mut self, _by_m: f64) {}

    /// Sets the ships whose transponders report them, as they are reported now: the whole volume of each.
    /// Their echoes tell of nothing else. They are part of no prediction. Call this before each scan.
    fn reported(&mut self, _ships: Vec<Region>) {}

    /// The vehicle's own place was put right by a fix: what was seen moves along.
    fn moved(&mut self, _by: &Vector3<f64>) {}
}

/// Returns the truth its caller has set: the upper bound of any prediction.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Perfect {
    /// The result of [`ObstaclePredictor::contacts`]: set it to `truth::ObstacleField::now` beforehand.
    pub regions: Vec<Region>,
}

impl ObstaclePredictor for Perfect {
    fn observe(&mut self, _scan: &Scan) {}

    fn charted_regions(&self) -> &[Region] {
        &[]
    }

    fn contacts(&self, _time_s: f64) -> Vec<Region> {
        self.regions.clone()
    }

    /// Always fresh.
    fn fresh_s(&self) -> Option<f64> {
        Some(f64::INFINITY)
    }

    fn horizon_s(&self) -> f64 {
        f64::INFINITY
    }
}

/// Predicts that everything stays where the last scan showed it: the baseline for trackers.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Frozen {
    /// Charted obstacles, part of every prediction.
    pub charted: Vec<Region>,
    seen: Vec<Region>,
    fresh_s: Option<f64>,
}

impl ObstaclePredictor for Frozen {
    fn observe(&mut self, scan: &Scan) {
        self.fresh_s = Some(scan.time_s);
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

    fn charted_regions(&self) -> &[Region] {
        &self.charted
    }

    fn contacts(&self, _time_s: f64) -> Vec<Region> {
        self.seen.clone()
    }

    fn fresh_s(&self) -> Option<f64> {
        self.fresh_s
    }

    fn horizon_s(&self) -> f64 {
        f64::INFINITY
    }

    fn moved(&mut self, by: &Vector3<f64>) {
        for region in &mut self.seen {
            region.centre += by;
        }
    }
}
