//! Turn radii and rounded corners of polylines.

use crate::Trajectory;
use auv_types::{Point3, Vector3, libm};

/// The turn radius at vertex `b` of the polyline `a b c`: shorter adjacent segment over
/// `2 tan(angle / 2)`; infinite on a straight line, 0 where it turns back.
#[must_use]
pub fn turn_radius_m(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>) -> f64 {
    let (before, after) = (b - a, c - b);
    let shorter = before.norm().min(after.norm());
    // tan(angle/2) = sin / (1 + cos), with both scaled by the lengths.
    let across = before.cross(&after).norm();
    let along = before.dot(&after);
    let scale = before.norm() * after.norm();
    if across <= 0.0 {
        return if along >= 0.0 { f64::INFINITY } else { 0.0 };
    }
    shorter * (scale + along) / (2.0 * across)
}

/// Replaces each corner by an arc of radius `turn_radius_m`, sampled within
/// [`Trajectory::CHORD_ERROR_M`]. A corner whose adjacent segments are too short for the arc stays.
/// Consecutive points closer than 1e-9 m are merged.
#[must_use]
pub fn rounded(points: &[Point3<f64>], turn_radius_m: f64) -> Vec<Point3<f64>> {
    let mut corners: Vec<Point3<f64>> = Vec::with_capacity(points.len());
    for &point in points {
        if corners
            .last()
            .is_none_or(|last| (point - last).norm() > 1e-9)
        {
            corners.push(point);
        }
    }
    if turn_radius_m <= 0.0 || corners.len() < 3 {
        return corners;
    }
    let mut smooth = vec![corners[0]];
    for i in 1..corners.len() - 1 {
        let (before, after) = (corners[i - 1] - corners[i], corners[i + 1] - corners[i]);
        // An inner segment is shared with the neighbouring corner.
        let share = |is_end: bool| if is_end { 1.0 } else { 0.5 };
        let room =
            (before.norm() * share(i == 1)).min(after.norm() * share(i + 2 == corners.len()));
        fillet(
            &mut smooth,
            corners[i],
            before.normalize(),
            after.normalize(),
            turn_radius_m,
            room,
        );
    }
    smooth.push(corners[corners.len() - 1]);
    smooth
}

/// The length in metres of a polyline with each corner rounded by an arc of radius `turn_radius_m`, as
/// [`rounded`] does; `None` where a corner has no room for its arc.
#[must_use]
pub fn rounded_length_m(points: &[Point3<f64>], turn_radius_m: f64) -> Option<f64> {
    let mut length_m = 0.0;
    for (i, pair) in points.windows(2).enumerate() {
        let step = pair[1] - pair[0];
        length_m += step.norm();
        let Some(next) = points.get(i + 2).filter(|_| turn_radius_m > 0.0) else {
            continue;
        };
        let after = next - pair[1];
        let scale = step.norm() * after.norm();
        if scale <= 0.0 {
            continue;
        }
        let turn_rad = libm::acos((step.dot(&after) / scale).clamp(-1.0, 1.0));
        let tangent_m = turn_radius_m * libm::tan(0.5 * turn_rad);
        let share = |is_end: bool| if is_end { 1.0 } else { 0.5 };
        let room_m = (step.norm() * share(i == 0)).min(after.norm() * share(i + 3 == points.len()));
        if tangent_m > room_m {
            return None;
        }
        length_m -= 2.0 * tangent_m - turn_radius_m * turn_rad;
    }
    Some(length_m)
}

fn fillet(
    smooth: &mut Vec<Point3<f64>>,
    corner: Point3<f64>,
    back: Vector3<f64>,
    ahead: Vector3<f64>,
    radius_m: f64,
    room_m: f64,
) {
    let turn_rad = libm::acos((-back.dot(&ahead)).clamp(-1.0, 1.0));
    let tangent_m = radius_m * libm::tan(0.5 * turn_rad);
    if turn_rad < 1e-6 || tangent_m > room_m {
        smooth.push(corner);
        return;
    }
    let begin = corner + back * tangent_m;
    let inward = (ahead - (-back) * ahead.dot(&-back)).normalize();
    let centre = begin + inward * radius_m;
    let step_rad = 2.0 * libm::sqrt(2.0 * Trajectory::CHORD_ERROR_M / radius_m).min(0.25);
    let count = libm::ceil(turn_rad / step_rad).max(2.0);
    for k in 0..=count as usize {
        let angle = turn_rad * k as f64 / count;
        smooth.push(
            centre - inward * (radius_m * libm::cos(angle)) - back * (radius_m * libm::sin(angle)),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_reaches_the_radius_and_keeps_the_ends() {
        let corner = [
            Point3::new(0.0, 0.0, 5.0),
            Point3::new(100.0, 0.0, 5.0),
            Point3::new(100.0, 100.0, 15.0),
            Point3::new(250.0, 140.0, 15.0),
        ];
        let smooth = rounded(&corner, 20.0);
        assert_eq!(
            (smooth[0], smooth[smooth.len() - 1]),
            (corner[0], corner[3])
        );
        for triple in smooth.windows(3) {
            let radius = turn_radius_m(&triple[0], &triple[1], &triple[2]);
            assert!(radius > 20.0 * 0.99, "{radius}");
        }
        let sampled_m: f64 = smooth
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm())
            .sum();
        let length_m = rounded_length_m(&corner, 20.0).unwrap();
        assert!((length_m - sampled_m).abs() < 0.2, "{length_m} {sampled_m}");
        assert_eq!(rounded_length_m(&corner, 200.0), None);
        let left = rounded(&corner, 200.0);
        assert_eq!(left.len(), 4, "a corner without room stays");
    }

    #[test]
    fn radius_of_sampled_circle_is_its_radius() {
        let on = |angle: f64| Point3::new(50.0 * libm::cos(angle), 50.0 * libm::sin(angle), 0.0);
        assert!((turn_radius_m(&on(0.0), &on(0.05), &on(0.1)) - 50.0).abs() < 0.1);
    }
}
