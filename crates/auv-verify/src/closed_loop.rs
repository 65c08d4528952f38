//! Whether a trajectory ends on a level closed loop, which can be flown again and again.

use auv_obstacles::TimedPoint;
use auv_planning::{Trajectory, Vehicle};
use auv_types::{Vector3, libm};

/// How near to its end a loop must have been before, metres. Two polylines of one circle differ by twice
/// the error of a chord at most.
pub(crate) const SAME_PLACE_M: f64 = 5.0 * Trajectory::CHORD_ERROR_M;
/// How far a loop must lead away from its end in between, metres.
pub(crate) const LEAST_WIDTH_M: f64 = 1.0;
/// The greatest difference of depth on a level loop, metres.
pub(crate) const LEVEL_M: f64 = 0.1;

/// The last loop of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClosedLoop {
    /// When the vehicle was at the end before, seconds.
    pub(crate) from_s: f64,
    /// How long one loop takes, seconds.
    pub(crate) period_s: f64,
    /// Greatest difference of depth on it, metres.
    pub(crate) height_m: f64,
}

/// The shortest loop at the end of a trajectory, level or not; else the least distance from its end at
/// which the vehicle was before, after it had been elsewhere, in metres (`+inf` if it never was).
pub(crate) fn last_loop(points: &[TimedPoint], vehicle: &Vehicle) -> Result<ClosedLoop, f64> {
    let (Some(end), Some(heading)) = (points.last(), last_direction(points)) else {
        return Err(f64::INFINITY);
    };
    let most_rad = chord_angle_rad(vehicle.turn_radius_m);
    let (mut low_m, mut high_m) = (end.position.z, end.position.z);
    let (mut has_left, mut nearest_m) = (false, f64::INFINITY);
    let mut later_m = 0.0;
    for pair in points.windows(2).rev() {
        let (from, to) = (&pair[0], &pair[1]);
        if has_left {
            let (share, distance_m) = nearest_to(end, from, to);
            let met_m = from.position.z + share * (to.position.z - from.position.z);
            let turned_rad = angle_rad(&heading, &(to.position - from.position));
            if distance_m <= SAME_PLACE_M && turned_rad <= most_rad {
                let from_s = from.time_s + share * (to.time_s - from.time_s);
                return Ok(ClosedLoop {
                    from_s,
                    period_s: end.time_s - from_s,
                    height_m: high_m.max(met_m) - low_m.min(met_m),
                });
            }
            // Where it was nearer a moment later, it was leaving.
            if distance_m < later_m {
                nearest_m = nearest_m.min(distance_m);
            }
            later_m = distance_m;
        }
        low_m = low_m.min(from.position.z);
        high_m = high_m.max(from.position.z);
        has_left |= (from.position - end.position).norm() >= LEAST_WIDTH_M;
    }
    Err(nearest_m)
}

/// Where on a segment it is nearest to a point, as a share of the segment, and how near, metres.
fn nearest_to(point: &TimedPoint, from: &TimedPoint, to: &TimedPoint) -> (f64, f64) {
    let way = to.position - from.position;
    let squared = way.norm_squared();
    let along = (point.position - from.position).dot(&way);
    let share = if squared > 0.0 {
        (along / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let there = from.position + way * share;
    (share, (point.position - there).norm())
}

/// The direction of the last segment that moves.
fn last_direction(points: &[TimedPoint]) -> Option<Vector3<f64>> {
    let mut ways = points
        .windows(2)
        .rev()
        .map(|p| p[1].position - p[0].position);
    ways.find(|way| way.norm() > 0.0)
}

fn angle_rad(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    libm::atan2(a.cross(b).norm(), a.dot(b))
}

/// By how much two polylines of one curve may differ in direction, radians: the angle of a chord of the
/// vehicle's tightest turn. A vehicle that turns on the spot goes on in any direction.
fn chord_angle_rad(turn_radius_m: f64) -> f64 {
    if turn_radius_m <= 0.0 {
        return std::f64::consts::PI;
    }
    let cosine = 1.0 - Trajectory::CHORD_ERROR_M / turn_radius_m;
    // Rounding must not decide.
    1.01 * 2.0 * libm::acos(cosine.max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Point3;
    use std::f64::consts::TAU;

    /// Arcs of a circle that turn by `turns`, in `count` chords, descending by `dive_m`.
    fn circle(radius_m: f64, turns: f64, count: usize, dive_m: f64) -> Vec<TimedPoint> {
        (0..=count)
            .map(|k| {
                let share = k as f64 / count as f64;
                let (sin, cos) = libm::sincos(TAU * turns * share);
                let place = Point3::new(
                    radius_m * sin,
                    radius_m * (1.0 - cos),
                    20.0 + dive_m * share,
                );
                TimedPoint::new(place, TAU * turns * share * radius_m)
            })
            .collect()
    }

    #[test]
    fn whole_circles_are_loops_wherever_their_vertices_lie() {
        let vehicle = Vehicle::default();
        for (turns, count) in [(1.0, 120), (2.0, 241), (3.0, 350), (2.3, 260)] {
            let found = last_loop(&circle(21.0, turns, count, 0.0), &vehicle).unwrap();
            let period_s = TAU * 21.0;
            assert!((found.period_s / period_s - 1.0).abs() < 1e-3, "{found:?}");
            assert_eq!(found.height_m, 0.0);
        }
    }

    #[test]
    fn less_than_a_circle_is_none_and_tells_the_gap() {
        let vehicle = Vehicle::default();
        let gap_m = last_loop(&circle(21.0, 0.9, 110, 0.0), &vehicle).unwrap_err();
        let chord_m = 2.0 * 21.0 * libm::sin(0.05 * TAU);
        assert!((gap_m - chord_m).abs() < 0.01, "{gap_m} {chord_m}");
        let straight = [
            TimedPoint::new(Point3::new(0.0, 0.0, 20.0), 0.0),
            TimedPoint::new(Point3::new(99.0, 0.0, 20.0), 99.0),
        ];
        assert_eq!(last_loop(&straight, &vehicle), Err(f64::INFINITY));
        assert_eq!(last_loop(&straight[..1], &vehicle), Err(f64::INFINITY));
    }

    #[test]
    fn a_place_met_in_another_direction_closes_no_loop() {
        // A loop of 270 degrees crosses the way on which it was reached.
        let mut points = circle(21.0, 0.75, 90, 0.0);
        let start = TimedPoint::new(Point3::new(-60.0, 0.0, 20.0), -60.0);
        points.insert(0, start);
        let crossing = Point3::new(-21.0, 0.0, 20.0);
        points.push(TimedPoint::new(crossing, 200.0));
        let found = last_loop(&points, &Vehicle::default());
        assert!(found.is_err_and(|gap_m| gap_m < 1e-9), "{found:?}");
    }

    #[test]
    fn a_helix_is_not_level() {
        let vehicle = Vehicle::default();
        let slight = last_loop(&circle(21.0, 1.0, 120, 0.04), &vehicle).unwrap();
        assert!((slight.height_m - 0.04).abs() < 1e-3);
        assert!(last_loop(&circle(21.0, 1.0, 120, 0.5), &vehicle).is_err());
    }
}
