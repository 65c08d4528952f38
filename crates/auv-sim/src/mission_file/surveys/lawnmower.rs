//! The lines of a lawnmower survey.

use auv_types::libm;
use auv_types::{Point3, Vector3};
use std::f64::consts::PI;

/// Courses tried where the best is asked for, besides those along the sides.
const COURSES: usize = 36;
/// Rounding must not add a line.
const ROUNDING: f64 = 1e-6;

/// The lines that cover a polygon on a course (radians from north by east), from one side to the other, all from
/// their south end on a course north: each is as long as the polygon is within its strip.
pub(super) fn over_polygon(
    polygon: &[Point3<f64>],
    spacing_m: f64,
    course: f64,
) -> Vec<Vec<Point3<f64>>> {
    let (sin, cos) = libm::sincos(course);
    let (ahead, aside) = (Vector3::new(cos, sin, 0.0), Vector3::new(-sin, cos, 0.0));
    let flat = |p: &Point3<f64>| (p.coords.dot(&ahead), p.coords.dot(&aside));
    let corners: Vec<(f64, f64)> = polygon.iter().map(flat).collect();
    let low = corners.iter().map(|c| c.1).fold(f64::INFINITY, f64::min);
    let high = corners
        .iter()
        .map(|c| c.1)
        .fold(f64::NEG_INFINITY, f64::max);
    let count = lines_across(high - low, spacing_m);
    let width_m = (high - low) / count as f64;
    let strip = |k: usize| {
        let edge_m = low + k as f64 * width_m;
        let (first, last) = extent(&corners, (edge_m, edge_m + width_m))?;
        let middle = aside * (edge_m + 0.5 * width_m);
        let end = |along: f64| Point3::from(ahead * along + middle);
        Some(vec![end(first), end(last)])
    };
    (0..count).filter_map(strip).collect()
}

/// The lines along a corridor, from its left side to its right.
pub(super) fn along_corridor(
    along: &[Point3<f64>],
    width_m: f64,
    spacing_m: f64,
) -> Vec<Vec<Point3<f64>>> {
    let count = lines_across(width_m, spacing_m);
    let lines = (0..count).map(|k| {
        let right_m = ((k as f64 + 0.5) / count as f64 - 0.5) * width_m;
        beside(along, right_m)
    });
    lines.collect()
}

/// How many strips of at most a spacing a width has.
pub(super) fn lines_across(width_m: f64, spacing_m: f64) -> usize {
    libm::ceil(width_m / spacing_m - ROUNDING).max(1.0) as usize
}

/// How far a polygon reaches along its first coordinate within a strip of its second.
fn extent(corners: &[(f64, f64)], (low, high): (f64, f64)) -> Option<(f64, f64)> {
    let mut reached: Vec<f64> = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if (low..=high).contains(&a.1) {
            reached.push(a.0);
        }
        for level in [low, high] {
            let (from, to) = (a.1 - level, b.1 - level);
            if from * to < 0.0 {
                reached.push(a.0 + (b.0 - a.0) * from / (from - to));
            }
        }
    }
    let first = reached.iter().copied().min_by(f64::total_cmp)?;
    let last = reached.iter().copied().max_by(f64::total_cmp)?;
    Some((first, last))
}

/// A polyline parallel to another, so far to its right.
fn beside(along: &[Point3<f64>], right_m: f64) -> Vec<Point3<f64>> {
    let normal = |pair: &[Point3<f64>]| {
        let step = pair[1] - pair[0];
        Vector3::new(-step.y, step.x, 0.0).normalize()
    };
    let sides: Vec<Vector3<f64>> = along.windows(2).map(normal).collect();
    let at = |i: usize| {
        let (before, after) = (sides[i.saturating_sub(1)], sides[i.min(sides.len() - 1)]);
        let middle = before + after;
        // Both sides are right_m away from the corner moved along their middle.
        along[i] + middle * (right_m * 2.0 / middle.norm_squared().max(0.5))
    };
    (0..along.len()).map(at).collect()
}

/// The order in which lines are flown: one after the other, or with so many left out for later that the vehicle
/// turns more easily, whichever takes the shortest turns.
pub(super) fn order(
    lines: &[Vec<Point3<f64>>],
    turn_radius_m: f64,
    in_sequence: bool,
) -> Vec<usize> {
    let count = lines.len();
    let most = if in_sequence {
        1
    } else {
        count.div_ceil(2).max(1)
    };
    let orders = (1..=most).map(|stride| interleaved(count, stride));
    let best = orders.min_by(|a, b| {
        let turns_m = |order| turns_m(lines, order, turn_radius_m);
        turns_m(a).total_cmp(&turns_m(b))
    });
    best.unwrap_or_default()
}

/// Lines 0, s, 1, s + 1, ... of each block of 2 s.
fn interleaved(count: usize, stride: usize) -> Vec<usize> {
    let mut order = Vec::with_capacity(count);
    for block in (0..count).step_by(2 * stride) {
        for k in block..block + stride {
            let pair = if stride == 1 {
                [k, k + 1]
            } else {
                [k, k + stride]
            };
            order.extend(pair.into_iter().filter(|&line| line < count));
        }
    }
    order
}

/// How long the turns between lines are in all, metres.
fn turns_m(lines: &[Vec<Point3<f64>>], order: &[usize], turn_radius_m: f64) -> f64 {
    let turns = order.windows(2).enumerate().map(|(i, pair)| {
        let end = |line: usize| match i % 2 {
            0 => lines[line].last(),
            _ => lines[line].first(),
        };
        let apart = end(pair[0]).zip(end(pair[1]));
        u_turn_m(apart.map_or(0.0, |(a, b)| (b - a).norm()), turn_radius_m)
    });
    turns.fold(0.0, |sum, turn_m| sum + turn_m)
}

/// The length of a turn back on a line so far beside, metres: half a circle and a straight, or a loop.
fn u_turn_m(apart_m: f64, turn_radius_m: f64) -> f64 {
    let across_m = 2.0 * turn_radius_m;
    if apart_m >= across_m {
        return PI * turn_radius_m + apart_m - across_m;
    }
    turn_radius_m * (PI + 4.0 * libm::acos(0.5 * (across_m + apart_m) / across_m))
}

/// The course on which the lines over a polygon take the least way, turns included.
pub(super) fn best_course(polygon: &[Point3<f64>], spacing_m: f64, turn_radius_m: f64) -> f64 {
    let sides = (0..polygon.len()).map(|i| {
        let side = polygon[(i + 1) % polygon.len()] - polygon[i];
        libm::atan2(side.y, side.x)
    });
    let around = (0..COURSES).map(|k| PI * k as f64 / COURSES as f64);
    let way_m = |course: f64| {
        let lines = over_polygon(polygon, spacing_m, course);
        let length_m = lines.iter().map(|line| (line[1] - line[0]).norm());
        let order = order(&lines, turn_radius_m, false);
        length_m.fold(0.0, |sum, m| sum + m) + turns_m(&lines, &order, turn_radius_m)
    };
    let courses = sides.chain(around).map(|course| (way_m(course), course));
    let best = courses.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(0.0, |(_, course)| course)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(corners: &[(f64, f64)]) -> Vec<Point3<f64>> {
        corners
            .iter()
            .map(|&(x, y)| Point3::new(x, y, 0.0))
            .collect()
    }

    #[test]
    fn lines_cover_a_box_at_no_more_than_the_spacing() {
        let polygon = flat(&[(0.0, 0.0), (400.0, 0.0), (400.0, 210.0), (0.0, 210.0)]);
        let lines = over_polygon(&polygon, 50.0, 0.0);
        assert_eq!(lines.len(), 5);
        for (k, line) in lines.iter().enumerate() {
            assert!((line[0].y - (21.0 + 42.0 * k as f64)).abs() < 1e-9);
            assert!((line[0].x, line[1].x) == (0.0, 400.0), "{line:?}");
        }
        assert_eq!(over_polygon(&polygon, 52.5, 0.0).len(), 4);
        assert_eq!(over_polygon(&polygon, 100.0, PI / 2.0).len(), 4);
    }

    #[test]
    fn a_line_is_as_long_as_its_strip() {
        let triangle = flat(&[(0.0, 0.0), (300.0, 0.0), (0.0, 300.0)]);
        let lines = over_polygon(&triangle, 100.0, 0.0);
        let lengths: Vec<f64> = lines.iter().map(|l| (l[1] - l[0]).norm()).collect();
        let close = |(a, b): (&f64, f64)| (a - b).abs() < 1e-9;
        assert!(
            lengths.iter().zip([300.0, 200.0, 100.0]).all(close),
            "{lengths:?}"
        );
    }

    #[test]
    fn lines_too_near_for_the_turn_are_flown_later() {
        let lines: Vec<_> = (0..8)
            .map(|k| flat(&[(0.0, 20.0 * f64::from(k)), (500.0, 20.0 * f64::from(k))]))
            .collect();
        assert_eq!(order(&lines, 25.0, true), [0, 1, 2, 3, 4, 5, 6, 7]);
        let skipping = order(&lines, 25.0, false);
        assert_ne!(skipping, [0, 1, 2, 3, 4, 5, 6, 7]);
        let mut sorted = skipping.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(order(&lines, 5.0, false), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert!((u_turn_m(50.0, 25.0) - PI * 25.0).abs() < 1e-9);
        assert!((u_turn_m(0.0, 25.0) - PI * 25.0 * 7.0 / 3.0).abs() < 1e-9);
    }

    #[test]
    fn the_best_course_is_along_the_long_side() {
        let polygon = flat(&[(0.0, 0.0), (0.0, 900.0), (200.0, 900.0), (200.0, 0.0)]);
        let course = best_course(&polygon, 40.0, 20.0);
        assert!(libm::cos(course).abs() < 1e-9, "{course}");
    }

    #[test]
    fn lines_of_a_corridor_keep_their_distance_round_a_corner() {
        let along = flat(&[(0.0, 0.0), (500.0, 0.0), (900.0, 300.0)]);
        let lines = along_corridor(&along, 60.0, 30.0);
        assert_eq!(lines.len(), 2);
        assert!((lines[0][0].y + 15.0).abs() < 1e-9 && (lines[1][0].y - 15.0).abs() < 1e-9);
        let second = Vector3::new(0.8, 0.6, 0.0);
        for line in &lines {
            let offset = line[1] - along[1];
            assert!(((offset - second * offset.dot(&second)).norm() - 15.0).abs() < 1e-9);
        }
    }
}
