//! Departures that turn from the direction flown towards the target.

use super::manoeuvre::DepartureManoeuvre;
use crate::PathProblem;
use auv_types::{Vector3, libm};

/// A velocity slower than this has no direction, m/s. A direction whose horizontal part is shorter
/// than `VERTICAL` is vertical.
const LEAST_SPEED_MPS: f64 = 1e-6;
const VERTICAL: f64 = 1e-6;
/// How far beyond the direction to the target a corner ahead lets the vehicle turn, radians. The
/// string may leave the corner sideways, to pass a region.
const MORE_TURN_RAD: [f64; 3] = [0.1, 0.5, 1.0];
/// Sharpest corner that is rounded by one arc, radians. The tangents of a sharper one are too long.
const SHARPEST_RAD: f64 = 2.3;
/// Sharpest corner for which the saved length is computed, radians: a little less.
const SHARPEST_SAVED_RAD: f64 = 2.2;
/// Spare length of the tangents of a corner ahead, in turn radii.
const SPARE_TANGENT: f64 = 0.1;
/// A turn to the side: steps ahead, to the side, and back, in turn radii. A quarter circle needs one
/// radius of each tangent; two quarter circles in a row need two of their common tangent.
const OUT: f64 = 1.1;
const ASIDE: f64 = 2.3;
const BACK: f64 = 2.1;

/// Turns, the shortest first. Where any direction serves there is one, which leaves straight away.
/// Otherwise the turns lead through ever wider corners ahead, then round to either side.
#[must_use]
pub fn turns(problem: &PathProblem<'_>) -> Vec<DepartureManoeuvre> {
    let radius_m = problem.vehicle.turn_radius_m;
    let Some(velocity) = problem.start_velocity else {
        return vec![DepartureManoeuvre::none(problem)];
    };
    if radius_m <= 0.0 || velocity.norm() < LEAST_SPEED_MPS {
        return vec![DepartureManoeuvre::none(problem)];
    }
    let line = problem.target - problem.start;
    let ahead = velocity.normalize();
    let turn_rad = libm::acos((ahead.dot(&line) / line.norm()).clamp(-1.0, 1.0));
    // An arc is shorter than its two tangents by this.
    let saved_m = |angle: f64| radius_m * (2.0 * libm::tan(0.5 * angle) - angle);
    let through = |steps: &[Vector3<f64>], saved_m: f64| {
        let length_m = steps.iter().fold(-saved_m, |sum, step| sum + step.norm());
        DepartureManoeuvre::along(problem, steps.iter().copied(), length_m)
    };
    let mut turns = Vec::new();
    for more_rad in MORE_TURN_RAD {
        let angle = turn_rad + more_rad;
        if angle < SHARPEST_RAD {
            let reach_m = radius_m * (libm::tan(0.5 * angle) + SPARE_TANGENT);
            let saved_m = saved_m(turn_rad.min(SHARPEST_SAVED_RAD));
            turns.push(through(&[ahead * reach_m], saved_m));
        }
    }
    let level = Vector3::new(-ahead.y, ahead.x, 0.0);
    if level.norm() > VERTICAL {
        let side = level.normalize() * (ASIDE * radius_m);
        for side in [side, -side] {
            let quarter_m = saved_m(std::f64::consts::FRAC_PI_2);
            let out = ahead * (OUT * radius_m);
            turns.push(through(&[out, side], quarter_m));
            // And back against the direction flown, for a target close by on this side.
            let back = -ahead * (BACK * radius_m);
            turns.push(through(&[out, side, back], 2.0 * quarter_m));
        }
    }
    turns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vehicle;
    use auv_types::Point3;

    #[test]
    fn a_vehicle_that_turns_on_the_spot_leaves_straight_away() {
        let vehicle = Vehicle::paper();
        let problem = PathProblem {
            start_velocity: Some(Vector3::new(-3.0, 0.0, 0.0)),
            ..PathProblem::new(Point3::origin(), Point3::new(900.0, 0.0, 0.0), &vehicle)
        };
        let turns = turns(&problem);
        assert_eq!(turns.len(), 1);
        assert_eq!((turns[0].end, turns[0].end_s), (problem.start, 0.0));
    }

    #[test]
    fn turns_continue_in_the_direction_flown() {
        let vehicle = Vehicle::default();
        for heading in [0.0, 1.0, 2.0, 3.0] {
            let ahead = Vector3::new(libm::cos(heading), libm::sin(heading), 0.0);
            let problem = PathProblem {
                start_velocity: Some(ahead * 1.5),
                departure_s: 60.0,
                ..PathProblem::new(Point3::origin(), Point3::new(900.0, 0.0, 0.0), &vehicle)
            };
            let turns = turns(&problem);
            // Both sides, each with and without a step back, and the corners ahead that are not too
            // sharp.
            let corners = [0.1, 0.5, 1.0].iter().filter(|&&more| heading + more < 2.3);
            assert_eq!(turns.len(), 4 + corners.count());
            for turn in &turns {
                let second = turn.corners.get(1).unwrap_or(&turn.end);
                assert!((second.coords.normalize() - ahead).norm() < 1e-9);
                assert!(turn.end_s > 60.0);
            }
        }
    }
}
