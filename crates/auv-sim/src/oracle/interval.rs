//! The truth between two mission times.

use auv_obstacles::{Region, TimedPoint};
use auv_types::{Point3, Vector3};

/// The truth between two mission times.
#[derive(Clone, Debug, PartialEq)]
pub struct SeaInterval {
    /// Start, mission time in seconds.
    pub from_s: f64,
    /// End, seconds.
    pub until_s: f64,
    /// True position of the vehicle at the start.
    pub place: Point3<f64>,
    /// The true obstacles.
    pub regions: Vec<Region>,
    /// Reference value of the current that carries the vehicle, m/s.
    pub water: Vector3<f64>,
    /// Greatest difference between the current at any place and `water`, m/s.
    pub water_differs_mps: f64,
    /// The vehicle's greatest speed through the water, m/s.
    pub max_speed_mps: f64,
}

impl SeaInterval {
    pub(super) fn duration_s(&self) -> f64 {
        self.until_s - self.from_s
    }

    /// Least distance from a fixed position to a region during the interval, metres.
    pub(super) fn clearance_m(&self, region: &Region, place: Point3<f64>) -> f64 {
        let (from, to) = self.rest(place);
        region.clearance(&from, &to).clearance_m
    }

    pub(super) fn rest(&self, place: Point3<f64>) -> (TimedPoint, TimedPoint) {
        (
            TimedPoint::new(place, self.from_s),
            TimedPoint::new(place, self.until_s),
        )
    }
}
