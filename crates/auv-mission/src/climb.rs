//! Climbing without a planner.

use crate::station_keeping::level_heading;
use auv_planning::PathProblem;
use auv_types::{Point3, Vector3, libm};

/// Most points of an ascent. A longer one turns more widely.
const MOST_ASCENT_POINTS: f64 = 20_000.0;
/// Distance between two points of an ascent in turn radii.
const ASCENT_STEP: f64 = 0.1;

/// Up to a depth: straight up for a vehicle that can, else on a helix to the right (positive side) or
/// left. The slope of the helix starts and ends at zero.
pub(crate) fn ascent(
    problem: &PathProblem<'_>,
    velocity: Vector3<f64>,
    top_m: f64,
    side: f64,
) -> Vec<Point3<f64>> {
    let start = problem.start;
    let rise_m = (start.z - top_m).max(0.0);
    let vehicle = problem.vehicle;
    if vehicle.turn_radius_m <= 0.0 && vehicle.max_pitch_rad >= std::f64::consts::FRAC_PI_2 {
        return vec![start, start - Vector3::z() * rise_m];
    }
    let radius_m = 1.5 * vehicle.turn_radius_m.max(5.0) * side.abs();
    // The slope is a raised cosine along the helix, so its greatest value is twice the mean.
    let slope = libm::tan(0.9 * vehicle.max_pitch_rad.min(1.0));
    let length_m = (2.0 * rise_m / slope).max(4.0 * radius_m);
    let radius_m = radius_m.max(length_m / (ASCENT_STEP * MOST_ASCENT_POINTS));
    let heading = level_heading(&velocity);
    let right = Vector3::new(-heading.y, heading.x, 0.0) * side.signum();
    let count = (length_m / (ASCENT_STEP * radius_m)).ceil().max(1.0);
    (0..=count as usize)
        .map(|k| {
            let share = k as f64 / count;
            let angle_rad = share * length_m / radius_m;
            let turn = std::f64::consts::TAU * share;
            let risen_m = rise_m * (share - libm::sin(turn) / std::f64::consts::TAU);
            start
                + right * (radius_m * (1.0 - libm::cos(angle_rad)))
                + heading * (radius_m * libm::sin(angle_rad))
                - Vector3::z() * risen_m
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_planning::Vehicle;

    #[test]
    fn an_ascent_from_the_deepest_sea_has_few_points() {
        let vehicle = Vehicle {
            max_pitch_rad: 0.01,
            ..Vehicle::default()
        };
        let start = Point3::new(0.0, 0.0, 1e7);
        let problem = PathProblem::new(start, start, &vehicle);
        for (depth_m, side) in [(20.0, 1.0), (11_000.0, -1.0), (1e7, 2.0)] {
            let problem = PathProblem {
                start: Point3::new(0.0, 0.0, depth_m),
                ..problem
            };
            let points = ascent(&problem, Vector3::x(), 0.0, side);
            assert!(points.len() as f64 <= MOST_ASCENT_POINTS + 2.0);
            assert!(points[points.len() - 1].z.abs() < 1e-6 * depth_m);
        }
    }
}
