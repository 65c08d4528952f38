//! From corners to a polyline that the vehicle can fly: corners rounded, depth changed no faster than
//! its pitch allows.

use auv_planning::{PathProblem, polyline::rounded};
use auv_types::{Point3, libm};

/// Points closer than this share of the turn radius are merged: where one arc ends and the next
/// begins, a stub would count as a tighter turn than either.
const STUB_SHARE: f64 = 0.03;

/// Rounds the corners and limits the pitch. The ends stay.
pub(crate) fn flyable(problem: &PathProblem<'_>, corners: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let mut points = rounded(corners, problem.vehicle.turn_radius_m);
    drop_stubs(&mut points, STUB_SHARE * problem.vehicle.turn_radius_m);
    limit_pitch(problem, &mut points);
    points
}

/// Drops inner points closer than `stub_m` to the one before or to the end.
fn drop_stubs(points: &mut Vec<Point3<f64>>, stub_m: f64) {
    let last = points.len() - 1;
    let mut kept = 1;
    for i in 1..last {
        let before_m = (points[i] - points[kept - 1]).norm();
        if before_m > stub_m && (points[last] - points[i]).norm() > stub_m {
            points[kept] = points[i];
            kept += 1;
        }
    }
    points[kept] = points[last];
    points.truncate(kept + 1);
}

/// Changes depth no faster than the pitch allows, as close to the given depths as that permits while
/// the depth of the end stays within reach.
fn limit_pitch(problem: &PathProblem<'_>, points: &mut [Point3<f64>]) {
    if problem.vehicle.max_pitch_rad >= std::f64::consts::FRAC_PI_2 {
        return;
    }
    let slope = libm::tan(problem.vehicle.max_pitch_rad);
    let across = |a: &Point3<f64>, b: &Point3<f64>| (b.xy() - a.xy()).norm();
    let mut left_m: f64 = points
        .windows(2)
        .map(|pair| across(&pair[0], &pair[1]))
        .sum();
    let last = points.len() - 1;
    let end_z = points[last].z;
    for i in 1..last {
        let step_m = across(&points[i - 1], &points[i]);
        left_m -= step_m;
        let (before_z, reach_m) = (points[i - 1].z, slope * step_m);
        // The end must stay within reach, but the limit of this step comes first.
        let z = points[i]
            .z
            .max(end_z - slope * left_m)
            .min(end_z + slope * left_m);
        points[i].z = z.max(before_z - reach_m).min(before_z + reach_m);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_planning::Vehicle;

    #[test]
    fn depth_changes_no_faster_than_the_pitch_allows_and_reaches_the_target() {
        let vehicle = Vehicle::default();
        let slope = libm::tan(vehicle.max_pitch_rad);
        let depths_m = [10.0, 80.0, 80.0, 10.0, 60.0, 60.0];
        let mut points: Vec<_> = (0..6)
            .map(|i| Point3::new(100.0 * i as f64, 0.0, depths_m[i]))
            .collect();
        let problem = PathProblem::new(points[0], points[5], &vehicle);
        limit_pitch(&problem, &mut points);
        assert_eq!((points[0].z, points[5].z), (10.0, 60.0));
        for pair in points.windows(2) {
            let step = pair[1] - pair[0];
            assert!(step.z.abs() <= slope * step.x * (1.0 + 1e-12));
        }
        assert_eq!(
            points[1].z,
            10.0 + 100.0 * slope,
            "as near as the pitch allows"
        );
        assert_eq!(points[4].z, points[5].z.min(points[3].z + 100.0 * slope));
    }

    #[test]
    fn points_close_to_their_neighbours_are_dropped_but_the_ends_stay() {
        let mut points: Vec<_> = [0.0, 0.4, 5.0, 5.3, 9.8, 10.0]
            .map(|x| Point3::new(x, 0.0, 0.0))
            .to_vec();
        drop_stubs(&mut points, 0.5);
        let kept: Vec<f64> = points.iter().map(|p| p.x).collect();
        assert_eq!(kept, [0.0, 5.0, 10.0]);
    }
}
