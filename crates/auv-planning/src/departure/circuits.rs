//! Altitude-change circuits: square circuits beside the start that change depth, for targets above
//! or below that no direct path reaches within the pitch limit.

use super::manoeuvre::DepartureManoeuvre;
use crate::PathProblem;
use crate::motion::level_heading;
use auv_types::{Vector3, libm};

/// Share of the steepest slope that a circuit uses. In the middle of a rounded corner the path is
/// steeper than its sides by the square root of two.
const SLOPE_SHARE: f64 = 0.65;
/// Side of the square in turn radii, room for two rounded corners, and the least radius it is laid
/// out for, metres.
const SIDE_RADII: f64 = 4.0;
const LEAST_RADIUS_M: f64 = 5.0;
/// Sides of a circuit.
const SIDES: usize = 4;
/// Most circuits.
const MOST_CIRCUITS: usize = 50;
/// Length of a side with its corners rounded, as a share: an arc of a quarter circle in a square of
/// four radii is shorter than its tangents by (2 - pi / 2) / 4.
const ROUNDED_SHARE: f64 = 0.89;

/// Whether the straight line to the target is steeper than a share of what the pitch allows.
#[must_use]
pub fn is_too_steep(problem: &PathProblem<'_>, share: f64) -> bool {
    let line = problem.target - problem.start;
    let steepest = libm::tan(problem.vehicle.max_pitch_rad);
    problem.vehicle.max_pitch_rad < std::f64::consts::FRAC_PI_2
        && line.z.abs() > share * steepest * line.xy().norm()
}

/// Circuits to either side that leave the rest of the path flat enough. They end at the start, or
/// at the last corner before it, for targets close to the vertical. None where the direct path is
/// flat enough.
#[must_use]
pub fn circuits(problem: &PathProblem<'_>) -> Vec<DepartureManoeuvre> {
    if !is_too_steep(problem, SLOPE_SHARE) {
        return Vec::new();
    }
    let line = problem.target - problem.start;
    let velocity = problem.start_velocity.unwrap_or_else(Vector3::zeros);
    let ahead = level_heading(&velocity)
        .or_else(|| level_heading(&line))
        .unwrap_or_else(Vector3::x);
    let right = Vector3::new(-ahead.y, ahead.x, 0.0);
    [
        (right, SIDES),
        (-right, SIDES),
        (right, SIDES - 1),
        (-right, SIDES - 1),
    ]
    .into_iter()
    .filter_map(|(side, last)| circuit(problem, &ahead, &side, last))
    .collect()
}

/// Circuits round a square, the last one with `last` sides only. As few as change the depth enough.
fn circuit(
    problem: &PathProblem<'_>,
    ahead: &Vector3<f64>,
    side: &Vector3<f64>,
    last: usize,
) -> Option<DepartureManoeuvre> {
    let slope = SLOPE_SHARE * libm::tan(problem.vehicle.max_pitch_rad);
    let side_m = SIDE_RADII * problem.vehicle.turn_radius_m.max(LEAST_RADIUS_M);
    let line = problem.target - problem.start;
    let sides = [*ahead, *side, -ahead, -side].map(|step| step * side_m);
    let beside: Vector3<f64> = sides[..last].iter().sum();
    let rest_m = (line - beside).xy().norm();
    let count = (0..MOST_CIRCUITS)
        .map(|circuit| SIDES * circuit + last)
        .find(|&count| line.z.abs() <= slope * (count as f64 * side_m + rest_m))?;
    let sink_m = (line.z.abs() - slope * rest_m).max(0.0) / count as f64 * line.z.signum();
    let steps = (0..count).map(|k| sides[k % SIDES] + Vector3::z() * sink_m);
    let length_m = count as f64 * libm::hypot(ROUNDED_SHARE * side_m, sink_m);
    Some(DepartureManoeuvre::along(problem, steps, length_m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vehicle;
    use auv_types::Point3;

    fn leg(vehicle: &Vehicle, across_m: f64, depth_m: f64) -> PathProblem<'_> {
        PathProblem::new(
            Point3::new(0.0, 0.0, 10.0),
            Point3::new(across_m, 0.0, depth_m),
            vehicle,
        )
    }

    #[test]
    fn only_a_steep_target_needs_circuits() {
        let vehicle = Vehicle::default();
        let slope = libm::tan(vehicle.max_pitch_rad);
        let flat = leg(&vehicle, 1_000.0, 10.0 + 640.0 * slope);
        assert!(circuits(&flat).is_empty() && !is_too_steep(&flat, 1.0));
        let steep = leg(&vehicle, 1_000.0, 10.0 + 1_010.0 * slope);
        assert!(!circuits(&steep).is_empty() && is_too_steep(&steep, 1.0));
        let free = Vehicle::paper();
        assert!(circuits(&leg(&free, 0.0, 90.0)).is_empty());
    }

    #[test]
    fn circuits_leave_a_rest_that_is_flat_enough() {
        let vehicle = Vehicle::default();
        for (across_m, depth_m) in [(0.0, 90.0), (60.0, 150.0), (300.0, 200.0)] {
            let problem = leg(&vehicle, across_m, depth_m);
            let found = circuits(&problem);
            assert_eq!(found.len(), 4);
            for DepartureManoeuvre { end, end_s, .. } in &found {
                let rest = problem.target - end;
                let slope = SLOPE_SHARE * libm::tan(vehicle.max_pitch_rad);
                assert!(rest.z.abs() <= slope * rest.xy().norm() + 1e-9);
                // No quicker than straight along the steepest slope.
                let sunk_m = (end.z - problem.start.z).abs();
                let least_s = sunk_m / libm::sin(vehicle.max_pitch_rad) / vehicle.speed_mps;
                assert!(*end_s >= least_s);
            }
        }
    }
}
