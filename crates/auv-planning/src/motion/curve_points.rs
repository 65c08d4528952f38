//! Polylines of level curves.

use super::curve::LevelCurve;
use crate::Trajectory;
use auv_types::{Point3, libm};

/// Longest step of a turn, radians.
const LONGEST_STEP_RAD: f64 = 0.15;
/// A vertex that turns by less is none, radians.
const STRAIGHT_RAD: f64 = 1e-7;

/// The polyline without the points at which it goes straight on.
pub(super) fn without_straight_points(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let mut kept: Vec<Point3<f64>> = vec![points[0]];
    for (i, &point) in points.iter().enumerate().skip(1) {
        let before = point - kept[kept.len() - 1];
        let turns = points.get(i + 1).is_none_or(|next| {
            let after = next - point;
            let most = STRAIGHT_RAD * before.norm() * after.norm();
            before.dot(&after) <= 0.0 || before.cross(&after).norm() > most
        });
        if turns {
            kept.push(point);
        }
    }
    kept
}

/// Points of a curve at even distances, but for the middles of long straights.
pub(super) fn sampled(curve: &LevelCurve, blend_m: f64) -> Vec<Point3<f64>> {
    let chord_rad = 2.0 * libm::sqrt(2.0 * Trajectory::CHORD_ERROR_M / curve.radius_m);
    let step_m = chord_rad.min(LONGEST_STEP_RAD) * curve.radius_m;
    let mut runs = Vec::new();
    let (mut begin_m, mut gone_m) = (0.0, 0.0);
    for (side, length_m) in curve.parts {
        if side == 0.0 && length_m > 2.0 * blend_m + 4.0 * step_m {
            let middle = [
                gone_m + blend_m + step_m,
                gone_m + length_m - blend_m - step_m,
            ];
            runs.extend([
                (begin_m, middle[0], step_m),
                (middle[0], middle[1], f64::INFINITY),
            ]);
            begin_m = middle[1];
        }
        gone_m += length_m;
    }
    runs.push((begin_m, gone_m, step_m));
    let mut points = vec![curve.from];
    for (begin_m, end_m, step_m) in runs {
        let count = ((end_m - begin_m) / step_m).ceil().max(1.0);
        let distance_m = |k: usize| begin_m + (end_m - begin_m) * k as f64 / count;
        points.extend((1..=count as usize).map(|k| curve.at(distance_m(k))));
    }
    points
}
