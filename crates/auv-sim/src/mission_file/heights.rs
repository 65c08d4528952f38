//! Lines in space: at a depth, or at an altitude over the bed.

use super::guides::simplified;
use auv_planning::polyline::rounded;
use auv_types::{Point3, libm};

/// Distance between the depths of a line, metres.
const STEP_M: f64 = 10.0;
/// A line that follows the bed may leave it so far for a simpler course, metres.
const SIMPLER_M: f64 = 0.25;
/// Room for the change of slope at an end, metres.
const ROOM_M: f64 = 6.0;
/// Curves are wider than the vehicle must turn by this.
const TURN_SHARE: f64 = 1.05;

/// How high a line is flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Height {
    /// At the depth of its ends.
    Ends,
    /// At a depth, metres.
    Depth(f64),
    /// Over the charted bed, metres.
    Altitude(f64),
}

impl Height {
    /// What a file gives: a depth, an altitude, or neither.
    pub(super) fn given(depth_m: Option<f64>, altitude_m: Option<f64>) -> Self {
        let at_depth = || depth_m.map_or(Self::Ends, Self::Depth);
        altitude_m.map_or_else(at_depth, Self::Altitude)
    }

    /// The depth over a bed of so many metres, where the line does not keep to its ends.
    pub(super) fn over_m(self, bed_m: f64) -> Option<f64> {
        match self {
            Self::Ends => None,
            Self::Depth(depth_m) => Some(depth_m),
            Self::Altitude(altitude_m) => Some(bed_m - altitude_m),
        }
    }

    /// A polyline, given as seen from above, in space between its placed ends, no deeper than allowed at its
    /// places, no steeper than `steepest`, and with turns no tighter than the vehicle's. `bed` tells the charted
    /// depth and the deepest allowed at a place.
    pub(super) fn shaped(
        self,
        points: &[Point3<f64>],
        ends: [Point3<f64>; 2],
        bed: impl Fn(&Point3<f64>) -> (f64, f64),
        (steepest, turn_radius_m): (f64, f64),
    ) -> Vec<Point3<f64>> {
        if self == Self::Ends && points.len() < 3 {
            return ends.to_vec();
        }
        let radius_m = TURN_SHARE * turn_radius_m;
        let (mut dense, corners) = densely(points, radius_m);
        let level_m = ends[0].z.min(ends[1].z);
        for point in &mut dense {
            let (bed_m, deepest_m) = bed(point);
            point.z = self.over_m(bed_m).map_or(level_m, |z| z.min(deepest_m));
        }
        flatten(&mut dense, steepest);
        reach_ends(&mut dense, ends, steepest);
        let mut simple = vec![ends[0]];
        for leg in corners.windows(2) {
            let kept = simplified(&dense[leg[0]..=leg[1]], SIMPLER_M);
            simple.extend(kept.into_iter().skip(1));
        }
        rounded(&simple, radius_m)
    }
}

/// A polyline with a point every few metres, but none where its corners are rounded, and the indices of its corners.
fn densely(points: &[Point3<f64>], radius_m: f64) -> (Vec<Point3<f64>>, Vec<usize>) {
    let (mut dense, mut corners) = (Vec::new(), Vec::new());
    let last = points.len() - 1;
    for (k, pair) in points.windows(2).enumerate() {
        corners.push(dense.len());
        dense.push(pair[0]);
        let step = pair[1] - pair[0];
        let length_m = step.xy().norm();
        let count = libm::ceil(length_m / STEP_M).max(1.0) as usize;
        let (low_m, high_m) = (
            room_m(points, k, radius_m),
            length_m - room_m(points, k + 1, radius_m),
        );
        let shares = (1..count).map(|i| i as f64 / count as f64);
        let free = shares.filter(|share| (low_m..=high_m).contains(&(share * length_m)));
        dense.extend(free.map(|share| pair[0] + step * share));
    }
    corners.push(dense.len());
    dense.push(points[last]);
    (dense, corners)
}

/// How far from a corner of a polyline nothing may be, so that it can be rounded, metres.
fn room_m(points: &[Point3<f64>], corner: usize, radius_m: f64) -> f64 {
    if corner == 0 || corner + 1 >= points.len() {
        return ROOM_M;
    }
    let before = (points[corner] - points[corner - 1]).xy();
    let after = (points[corner + 1] - points[corner]).xy();
    let scale = (before.norm() * after.norm()).max(1e-9);
    let turn_rad = libm::acos((before.dot(&after) / scale).clamp(-1.0, 1.0));
    2.0 * radius_m * libm::tan(0.5 * turn_rad) + ROOM_M
}

/// Raises points until no piece is steeper.
fn flatten(points: &mut [Point3<f64>], steepest: f64) {
    let most_m = |from: Point3<f64>, to: Point3<f64>| from.z + steepest * (to - from).xy().norm();
    for i in 1..points.len() {
        points[i].z = points[i].z.min(most_m(points[i - 1], points[i]));
    }
    for i in (1..points.len()).rev() {
        points[i - 1].z = points[i - 1].z.min(most_m(points[i], points[i - 1]));
    }
}

/// Moves points up or down to what can be reached from both ends.
fn reach_ends(points: &mut [Point3<f64>], [first, last]: [Point3<f64>; 2], steepest: f64) {
    let steps = points
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).xy().norm());
    let mut gone_m = vec![0.0];
    for step_m in steps {
        gone_m.push(gone_m[gone_m.len() - 1] + step_m);
    }
    let whole_m = gone_m[gone_m.len() - 1];
    for (point, gone_m) in points.iter_mut().zip(gone_m) {
        let (from_m, to_m) = (steepest * gone_m, steepest * (whole_m - gone_m));
        let low = (first.z - from_m).max(last.z - to_m);
        let high = (first.z + from_m).min(last.z + to_m);
        if low <= high {
            point.z = point.z.clamp(low, high);
        }
    }
    if let [begin, .., end] = points {
        (*begin, *end) = (first, last);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_follows_the_bed_no_steeper_than_it_may() {
        let points = [0.0, 1_000.0].map(|x| Point3::new(x, 0.0, 0.0));
        let bed = |p: &Point3<f64>| (if p.x < 500.0 { 50.0 } else { 80.0 }, 1e3);
        let ends = [Point3::new(0.0, 0.0, 40.0), Point3::new(1_000.0, 0.0, 70.0)];
        let line = Height::Altitude(10.0).shaped(&points, ends, bed, (0.2, 20.0));
        let depth_m = |x: f64| {
            let pair = line.windows(2).find(|pair| pair[1].x >= x).unwrap();
            let share = (x - pair[0].x) / (pair[1].x - pair[0].x);
            pair[0].z + share * (pair[1].z - pair[0].z)
        };
        assert!((depth_m(300.0) - 40.0).abs() < 0.5 && (depth_m(800.0) - 70.0).abs() < 0.5);
        let steepest = line
            .windows(2)
            .map(|p| (p[1].z - p[0].z) / (p[1].x - p[0].x));
        assert!(steepest.fold(0.0, f64::max) < 0.21);
        assert!((0..100).all(|k| depth_m(10.0 * f64::from(k) + 5.0)
            < bed(&Point3::new(10.0 * f64::from(k) + 5.0, 0.0, 0.0)).0 - 8.5));
    }

    #[test]
    fn a_leg_at_a_depth_leaves_it_for_its_ends() {
        let points = [0.0, 600.0].map(|x| Point3::new(x, 0.0, 0.0));
        let ends = points.map(|p| Point3::new(p.x, 0.0, 10.0));
        let line = Height::Depth(30.0).shaped(&points, ends, |_| (100.0, 90.0), (0.2, 0.0));
        assert_eq!((line[0].z, line[line.len() - 1].z), (10.0, 10.0));
        assert!(
            line.iter().filter(|p| (p.z - 30.0).abs() < 1e-9).count() >= 2,
            "{line:?}"
        );
    }
}
