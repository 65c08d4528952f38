//! The circle on which a vehicle that cannot stop stays at a place.

use crate::{Trajectory, Vehicle};
use auv_types::{Vector3, libm};

/// Its radius in turn radii: a little more than the vehicle needs.
const RADII: f64 = 1.05;
/// The least turn radius it is made for, metres.
const LEAST_RADIUS_M: f64 = 5.0;
/// A vehicle that arrives pitched levels out before it circles: the tangents of that corner, in turn
/// radii.
pub const LEVELLING_RADII: f64 = 0.6;

/// Longest step of an arc, radians.
const LONGEST_STEP_RAD: f64 = 0.5;
/// Share of a step of the circle by which a vehicle may be pitched when it begins the circle.
const PITCHED_SHARE: f64 = 0.4;

/// The angle between two points of a level arc of a radius, so that its chords stay within
/// [`Trajectory::CHORD_ERROR_M`], radians.
#[must_use]
pub fn arc_step_rad(radius_m: f64) -> f64 {
    let error = 2.0 * Trajectory::CHORD_ERROR_M / radius_m.abs().max(1e-6);
    (2.0 * libm::sqrt(error)).min(LONGEST_STEP_RAD)
}

/// Whether a vehicle that arrives with a velocity may begin a level circle of a radius at once: it is pitched
/// by less than the circle turns from one point to the next. Otherwise it levels out first.
#[must_use]
pub fn begins_level(velocity: &Vector3<f64>, radius_m: f64) -> bool {
    velocity.z.abs() <= PITCHED_SHARE * arc_step_rad(radius_m) * velocity.norm()
}

/// Radius of the tightest circle that the vehicle flies to stay at a place, metres.
#[must_use]
pub fn tightest_circle_m(vehicle: &Vehicle) -> f64 {
    RADII * vehicle.turn_radius_m.max(LEAST_RADIUS_M)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vehicle_pitched_by_less_than_a_step_begins_its_circle_at_once() {
        let radius_m = tightest_circle_m(&Vehicle::default());
        assert_eq!(radius_m, 21.0);
        let pitched = |sine: f64| begins_level(&Vector3::new(1.5, 0.0, 1.5 * sine), radius_m);
        assert!(pitched(0.0) && pitched(0.02) && pitched(-0.02));
        assert!(!pitched(0.1) && !pitched(-0.1));
        // A wide circle has short steps.
        assert!(!begins_level(&Vector3::new(1.5, 0.0, 0.03), 1e4));
    }
}
