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

    fn at(x: f64, y: f64, z: f64, time_s: f64) -> TimedPoint {
        TimedPoint::new(Point3::new(x, y, z), time_s)
    }

    /// 100 m north at the depths `way_m`, round to the left and back along it to its middle, `aside_m` beside it
    /// and as deep as `end_m`.
    fn round([from_m, to_m]: [f64; 2], end_m: f64, aside_m: f64) -> [TimedPoint; 6] {
        [
            at(-50.0, 0.0, from_m, 7.0),
            at(50.0, 0.0, to_m, 27.0),
            at(50.0, 40.0, end_m, 40.0),
            at(-50.0, 40.0, end_m, 70.0),
            at(-50.0, aside_m, end_m, 80.0),
            at(0.0, aside_m, end_m, 95.0),
        ]
    }

    #[test]
    fn a_loop_starts_where_the_vehicle_was_within_five_centimetres() {
        let vehicle = Vehicle::default();
        for aside_m in [0.0, 0.049, -0.049] {
            let found = last_loop(&round([20.0; 2], 20.0, aside_m), &vehicle);
            let expected = ClosedLoop {
                from_s: 17.0,
                period_s: 78.0,
                height_m: 0.0,
            };
            assert_eq!(found, Ok(expected), "{aside_m}");
        }
        let wide = last_loop(&round([20.0; 2], 20.0, 0.051), &vehicle);
        assert!(wide.is_err_and(|m| (m - 0.051).abs() < 1e-12), "{wide:?}");
    }

    #[test]
    fn its_height_is_that_of_all_of_it_and_of_nothing_before() {
        let vehicle = Vehicle::default();
        let height_m =
            |way_m, end_m| last_loop(&round(way_m, end_m, 0.0), &vehicle).map(|l| l.height_m);
        let near = |found: Result<f64, f64>, wanted_m: f64| {
            assert!(
                found.is_ok_and(|m| (m - wanted_m).abs() < 1e-6),
                "{found:?} {wanted_m}"
            );
        };
        // The way starts 0.1 m above or below the loop, which is as deep as the way's middle.
        near(height_m([20.0, 20.2], 20.1), 0.1);
        near(height_m([20.2, 20.0], 20.1), 0.1);
        // The loop's start differs from its end.
        near(height_m([20.06, 20.0], 20.0), 0.03);
        near(height_m([19.94, 20.0], 20.0), 0.03);
    }

    #[test]
    fn a_loop_leads_a_metre_away() {
        let vehicle = Vehicle::default();
        let around = |half_m: f64| {
            let corners = [
                (-9.0, 0.0),
                (half_m, 0.0),
                (half_m, 0.1),
                (-half_m, 0.1),
                (-half_m, 0.0),
                (0.0, 0.0),
            ];
            let points = corners.map(|(x, y)| at(x, y, 20.0, 0.0));
            last_loop(&points, &vehicle)
        };
        assert_eq!(around(0.9), Err(f64::INFINITY));
        assert!(around(1.0).is_ok());
    }

    #[test]
    fn the_direction_may_differ_by_a_chord_of_the_tightest_turn() {
        let across = |angle: f64, turn_radius_m: f64| {
            let vehicle = Vehicle {
                turn_radius_m,
                ..Vehicle::default()
            };
            let mut points = round([20.0; 2], 20.0, 0.0);
            let (sin, cos) = libm::sincos(angle);
            points[0] = at(-50.0 * cos, 50.0 * sin, 20.0, 7.0);
            points[1] = at(50.0 * cos, -50.0 * sin, 20.0, 27.0);
            last_loop(&points, &vehicle).is_ok()
        };
        // The chord of an arc of 20 m that lies 1 cm from its middle spans 0.0632 rad; of 80 m, 0.0316 rad.
        assert!(across(0.063, 20.0) && across(-0.063, 20.0) && !across(0.065, 20.0));
        assert!(across(0.0315, 80.0) && !across(0.0325, 80.0));
        // On the spot, or on less than the error of a chord, any direction will do.
        for turn_radius_m in [0.0, 0.005] {
            assert!(across(1.5, turn_radius_m) && across(3.1, turn_radius_m));
        }
    }

    #[test]
    fn rests_neither_close_a_loop_nor_hide_what_is_near() {
        let vehicle = Vehicle::default();
        // A rest on a straight way.
        let straight = [0.0, 40.0, 40.0, 99.0].map(|x| at(x, 0.0, 20.0, 0.0));
        assert_eq!(last_loop(&straight, &vehicle), Err(f64::INFINITY));
        // A rest at the end of a loop, and of a way that crosses another.
        let rest = |mut points: Vec<TimedPoint>| {
            points.push(TimedPoint::new(points[points.len() - 1].position, 120.0));
            last_loop(&points, &vehicle)
        };
        let rested = rest(round([20.0; 2], 20.0, 0.0).to_vec());
        assert!(rested.is_ok_and(|found| found.from_s == 17.0 && found.period_s == 103.0));
        let mut crossing = round([20.0; 2], 20.0, 0.0);
        (crossing[0], crossing[1]) = (at(0.0, -50.0, 20.0, 7.0), at(0.0, 50.0, 20.0, 27.0));
        assert_eq!(rest(crossing.to_vec()), Err(0.0));
        // It comes within 1 m of its end, rests 3 m further on and goes round.
        let mut passed = round([20.0; 2], 20.0, 0.0).to_vec();
        passed[0] = at(-50.0, 1.0, 20.0, 7.0);
        passed[1] = at(3.0, 1.0, 20.0, 20.0);
        passed.insert(2, at(3.0, 1.0, 20.0, 27.0));
        assert_eq!(last_loop(&passed, &vehicle), Err(1.0));
    }
}
