//! A true obstacle in its initial state.

use crate::RegionShape;
use auv_types::{Point3, Vector3, Violations};

/// The paper's four classes of obstacles (section 3.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum ObstacleClass {
    /// Class 1: fixed position and radius, on the chart.
    Static,
    /// Class 2: fixed position, a new random radius every step.
    Uncertain,
    /// Class 3: moves on its own (Eq. 4).
    Moving,
    /// Class 4: moves on its own and with the current, and its region grows (Eq. 4, 5). Without a velocity
    /// of its own it is the paper's "floating" obstacle.
    Drifting,
}

impl ObstacleClass {
    /// All classes in the paper's order.
    pub const ALL: [Self; 4] = [Self::Static, Self::Uncertain, Self::Moving, Self::Drifting];
}

/// A true obstacle in its initial state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Obstacle {
    /// Its class.
    pub class: ObstacleClass,
    /// Ball or vertical cylinder (fishing gear, farms, hulls).
    pub shape: RegionShape,
    /// Centre, metres (NED).
    pub centre: Point3<f64>,
    /// Radius r0, metres.
    pub radius_m: f64,
    /// Velocity through the water, m/s (classes 3 and 4).
    pub velocity_mps: Vector3<f64>,
    /// U_r of Eq. 5: growth of the position uncertainty per m/s of current and per step, metres (class 4).
    pub uncertainty_m: f64,
    /// Mission time from which it exists, seconds.
    pub appears_s: f64,
}

impl Obstacle {
    /// A ball at rest that exists from the start.
    #[must_use]
    pub fn new(class: ObstacleClass, centre: Point3<f64>, radius_m: f64) -> Self {
        Self {
            class,
            shape: RegionShape::Ball,
            centre,
            radius_m,
            velocity_mps: Vector3::zeros(),
            uncertainty_m: 1.0,
            appears_s: 0.0,
        }
    }

    /// The same obstacle with a velocity through the water, m/s.
    #[must_use]
    pub fn with_velocity(mut self, velocity_mps: Vector3<f64>) -> Self {
        self.velocity_mps = velocity_mps;
        self
    }

    /// Adds everything malformed to a list, under the name `place`.
    pub fn validate_into(&self, place: &str, violations: &mut Violations) {
        let finite = |values: &[f64]| values.iter().all(|x| x.is_finite() && x.abs() <= 1e9);
        violations.require(
            finite(self.centre.coords.as_slice())
                && finite(self.velocity_mps.as_slice())
                && finite(&[self.uncertainty_m, self.appears_s]),
            place,
            || "holds a value that is not finite; give metres, m/s and seconds".into(),
        );
        violations.require_positive(self.radius_m, &format!("{place}.radius_m"));
        if let RegionShape::Cylinder { top_m, bottom_m } = self.shape {
            violations.require(top_m < bottom_m, place, || {
                format!("reaches from depth {top_m} to {bottom_m}; give top < bottom")
            });
        }
    }
}
