//! Targets above or below that no direct way reaches within the pitch limit: square laps first.

use crate::flyable::Launch;
use auv_planning::PathProblem;
use auv_planning::motion::level_heading;
use auv_types::{Point3, Vector3, libm};

/// Share of the steepest slope that is used: in the middle of a rounded square corner the way is
/// steeper by the square root of two.
const SLOPE: f64 = 0.65;
/// Side of the square in turn radii, and the least radius it is laid out for, metres.
const SIDE: f64 = 4.0;
const LEAST_RADIUS_M: f64 = 5.0;
/// Most laps.
const LAPS: usize = 50;

/// Whether the straight line to the target is steeper than a share of what the pitch allows.
pub(crate) fn is_too_steep(problem: &PathProblem<'_>, share: f64) -> bool {
    let line = problem.target - problem.start;
    let steepest = libm::tan(problem.vehicle.max_pitch_rad);
    problem.vehicle.max_pitch_rad < std::f64::consts::FRAC_PI_2
        && line.z.abs() > share * steepest * line.xy().norm()
}

/// Laps to either side that leave the rest of the way flat enough: to the start again, or to the
/// last corner before it, for targets close to the vertical. None where the direct way is flat
/// enough.
pub(crate) fn laps(problem: &PathProblem<'_>) -> Vec<Launch> {
    if !is_too_steep(problem, SLOPE) {
        return Vec::new();
    }
    let slope = SLOPE * libm::tan(problem.vehicle.max_pitch_rad);
    let line = problem.target - problem.start;
    let side_m = SIDE * problem.vehicle.turn_radius_m.max(LEAST_RADIUS_M);
    let velocity = problem.start_velocity.unwrap_or_else(Vector3::zeros);
    let ahead = level_heading(&velocity)
        .or_else(|| level_heading(&line))
        .unwrap_or_else(Vector3::x);
    let right = Vector3::new(-ahead.y, ahead.x, 0.0);
    let ways = [(right, 4), (-right, 4), (right, 3), (-right, 3)];
    let laps = ways.map(|(side, last)| {
        let legs = [ahead, side, -ahead, -side].map(|leg| leg * side_m);
        let beside: Vector3<f64> = legs[..last].iter().sum();
        let rest_m = (line - beside).xy().norm();
        let count = (0..LAPS)
            .map(|lap| 4 * lap + last)
            .find(|&count| line.z.abs() <= slope * (count as f64 * side_m + rest_m))?;
        let sink_m = (line.z.abs() - slope * rest_m).max(0.0) / count as f64 * line.z.signum();
        let mut before: Vec<Point3<f64>> = vec![problem.start];
        for k in 0..count {
            before.push(before[k] + legs[k % 4] + Vector3::z() * sink_m);
        }
        // A rounded corner is shorter by about a fifth of its two half sides.
        let length_m = count as f64 * libm::hypot(0.89 * side_m, sink_m);
        let from = before.pop()?;
        Some(Launch::new(problem, before, from, length_m))
    });
    laps.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flyable::Launch;
    use auv_planning::Vehicle;

    fn leg(vehicle: &Vehicle, across_m: f64, depth_m: f64) -> PathProblem<'_> {
        PathProblem::new(
            Point3::new(0.0, 0.0, 10.0),
            Point3::new(across_m, 0.0, depth_m),
            vehicle,
        )
    }

    #[test]
    fn only_a_steep_target_needs_laps() {
        let vehicle = Vehicle::default();
        let slope = libm::tan(vehicle.max_pitch_rad);
        let flat = leg(&vehicle, 1_000.0, 10.0 + 640.0 * slope);
        assert!(laps(&flat).is_empty() && !is_too_steep(&flat, 1.0));
        let steep = leg(&vehicle, 1_000.0, 10.0 + 1_010.0 * slope);
        assert!(!laps(&steep).is_empty() && is_too_steep(&steep, 1.0));
        let free = Vehicle::paper();
        assert!(laps(&leg(&free, 0.0, 90.0)).is_empty());
    }

    #[test]
    fn laps_leave_a_rest_that_is_flat_enough() {
        let vehicle = Vehicle::default();
        for (across_m, depth_m) in [(0.0, 90.0), (60.0, 150.0), (300.0, 200.0)] {
            let problem = leg(&vehicle, across_m, depth_m);
            let ways = laps(&problem);
            assert_eq!(ways.len(), 4);
            for Launch {
                from, departure_s, ..
            } in &ways
            {
                let rest = problem.target - from;
                let slope = SLOPE * libm::tan(vehicle.max_pitch_rad);
                assert!(rest.z.abs() <= slope * rest.xy().norm() + 1e-9);
                // No quicker than straight down along the steepest slope.
                let sunk_m = (from.z - problem.start.z).abs();
                let least_s = sunk_m / libm::sin(vehicle.max_pitch_rad) / vehicle.speed_mps;
                assert!(*departure_s >= least_s);
            }
        }
    }
}
