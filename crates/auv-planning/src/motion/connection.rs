//! The shortest flyable connections between two places: turns, straights and circles with a steady change
//! of depth along them.

use super::connection_task::{Connection, RADII, Task};
use super::curve::{KINDS, curves, heading_of};
use super::pose::{ConnectionEnd, ConnectionStart, Pose};
use crate::Vehicle;
use auv_types::Point3;

/// Polylines from one pose to another that the vehicle can fly in still water, shortest first: the points
/// of [`connections_between`].
#[must_use]
pub fn connections(vehicle: &Vehicle, from: Pose, to: Pose) -> Vec<Vec<Point3<f64>>> {
    let found = connections_between(
        vehicle,
        ConnectionStart::Pose(from),
        ConnectionEnd::Pose(to),
    );
    found.into_iter().map(|found| found.points).collect()
}

/// Polylines that the vehicle can fly in still water, shortest first.
///
/// Seen from above each is a Dubins curve (Dubins 1957): a turn, a straight or an opposite turn, and a turn
/// where a direction is asked for at the end. The depth changes along it as steadily as the start and the
/// end allow; turning and pitching together keep the turn radius in space. Where the curve is too short
/// for the change of depth, a straight and full circles come first. Box, bed and regions are not
/// considered.
///
/// Both ends may be pitched. A vehicle that turns on the spot goes straight, and circles with a radius of
/// 5 m where that is too steep.
#[must_use]
pub fn connections_between(
    vehicle: &Vehicle,
    from: ConnectionStart,
    to: ConnectionEnd,
) -> Vec<Connection> {
    let task = Task::new(vehicle, from, to);
    if let Some(straight) = task.straight() {
        return vec![straight];
    }
    let kinds = (0..KINDS).flat_map(|kind| task.of_kind(kind));
    let mut found: Vec<Connection> = kinds.collect();
    found.sort_by(|a, b| a.length_m.total_cmp(&b.length_m));
    found
}

/// A connection as seen from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LevelWay {
    pub(crate) length_m: f64,
    /// The heading at its end, radians.
    pub(crate) heading: f64,
}

/// The shortest connection to a place as seen from above, whatever the depths.
pub(crate) fn shortest_level(
    vehicle: &Vehicle,
    from: ConnectionStart,
    to: Point3<f64>,
) -> LevelWay {
    let task = Task::new(vehicle, from, ConnectionEnd::Place(to));
    let line = to - task.from;
    let straight = LevelWay {
        length_m: line.xy().norm(),
        heading: heading_of(&line),
    };
    if task.direction.is_none() {
        return straight;
    }
    let found = curves(
        task.from,
        task.heading,
        &task.goal,
        RADII[0] * task.radius_m,
    );
    let lengths = found.iter().flatten().map(|curve| LevelWay {
        length_m: curve.length_m(),
        heading: curve.end_heading(),
    });
    lengths
        .min_by(|a, b| a.length_m.total_cmp(&b.length_m))
        .unwrap_or(straight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::curve::LevelCurve;
    use crate::polyline::turn_radius_m;
    use auv_types::{Seed, Vector3, libm, rand::RngExt};
    use std::f64::consts::TAU;

    fn pose(north_m: f64, east_m: f64, depth_m: f64, heading: f64, pitch: f64) -> Pose {
        let level = libm::cos(pitch);
        Pose {
            place: Point3::new(north_m, east_m, depth_m),
            direction: Vector3::new(
                level * libm::cos(heading),
                level * libm::sin(heading),
                libm::sin(pitch),
            ),
        }
    }

    /// The least turn radius of a polyline that is flown on from a direction, and its steepest pitch.
    fn flown(points: &[Point3<f64>], direction: Vector3<f64>) -> (f64, f64) {
        let first_m = (points[1] - points[0]).norm();
        let mut all = vec![points[0] - direction.normalize() * first_m];
        all.extend(points);
        let radii = all.windows(3).map(|p| turn_radius_m(&p[0], &p[1], &p[2]));
        let pitches = points.windows(2).map(|p| {
            let step = p[1] - p[0];
            libm::atan2(step.z.abs(), step.xy().norm())
        });
        (
            radii.fold(f64::INFINITY, f64::min),
            pitches.fold(0.0, f64::max),
        )
    }

    #[test]
    fn connections_can_be_flown_between_any_two_poses() {
        let vehicle = Vehicle::default();
        let mut random = Seed(3).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        for _ in 0..150 {
            let from = pose(0.0, 0.0, 50.0, draw(-3.0, 3.0), draw(-0.2, 0.2));
            let end = (draw(-150.0, 150.0), draw(-150.0, 150.0), draw(10.0, 90.0));
            let to = pose(end.0, end.1, end.2, draw(-3.0, 3.0), draw(-0.2, 0.2));
            let ways = connections(&vehicle, from, to);
            assert!(!ways.is_empty());
            for way in &ways {
                let last = way.len() - 1;
                assert_eq!((way[0], way[last]), (from.place, to.place));
                let arrival = (way[last] - way[last - 1]).normalize();
                assert!(arrival.dot(&to.direction) > 0.99);
                let (radius_m, pitch) = flown(way, from.direction);
                assert!(radius_m > 19.8 && pitch < vehicle.max_pitch_rad + 1e-6);
            }
        }
    }

    #[test]
    fn places_are_reached_as_soon_as_turn_and_pitch_allow() {
        let vehicle = Vehicle::default();
        let mut random = Seed(7).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let (mut level, mut steep) = (Vec::new(), Vec::new());
        for round in 0..300 {
            let from = pose(0.0, 0.0, 50.0, draw(-3.2, 3.2), 0.0);
            let (across_m, bearing) = (draw(2.0, 450.0), draw(-3.2, 3.2));
            let dive_m = draw(-0.6, 0.6) * across_m * f64::from(round % 2);
            let (sin, cos) = libm::sincos(bearing);
            let to = Point3::new(across_m * cos, across_m * sin, 50.0 + dive_m);
            let start = ConnectionStart::Pose(from);
            let ways = connections_between(&vehicle, start, ConnectionEnd::Place(to));
            for way in &ways {
                let (radius_m, pitch) = flown(&way.points, from.direction);
                assert!(radius_m > 19.8 && pitch < vehicle.max_pitch_rad + 1e-6);
                assert_eq!(way.points[way.points.len() - 1], to);
            }
            let level_m = shortest_level(&vehicle, start, to).length_m;
            let steep_m = dive_m.abs() / libm::sin(vehicle.max_pitch_rad);
            let gap = ways[0].length_m / libm::hypot(level_m, dive_m).max(steep_m) - 1.0;
            if round % 2 == 0 {
                &mut level
            } else {
                &mut steep
            }
            .push(gap);
        }
        level.sort_by(f64::total_cmp);
        steep.sort_by(f64::total_cmp);
        assert!(level[149] < 2e-3, "{}", level[149]);
        // A few dives are too steep for a straight way and too flat for a turn.
        let (middle, most) = (steep[75], steep[145]);
        assert!(middle < 0.02 && most < 0.2, "{middle} {most}");
    }

    /// The least length of many turns and straights that end within a metre of a place, metres.
    fn searched_m(from: Pose, to: Point3<f64>, radius_m: f64) -> f64 {
        let mut best_m = f64::INFINITY;
        let sides = [(1.0, 0.0), (-1.0, 0.0), (1.0, -1.0), (-1.0, 1.0)];
        for (first, last) in sides {
            for i in 0..600 {
                for j in 0..600 {
                    let first_m = TAU * radius_m * f64::from(i) / 600.0;
                    let last_m = 0.4 * f64::from(j);
                    let curve = LevelCurve {
                        from: from.place,
                        heading: heading_of(&from.direction),
                        radius_m,
                        parts: [
                            (first, first_m),
                            (last, last_m),
                            (0.0, 0.0),
                            (0.0, 0.0),
                            (0.0, 0.0),
                        ],
                    };
                    let length_m = first_m + last_m;
                    if length_m < best_m && (curve.at(length_m) - to).norm() < 1.0 {
                        best_m = length_m;
                    }
                }
            }
        }
        best_m
    }

    #[test]
    fn no_trial_of_turns_is_shorter() {
        let vehicle = Vehicle::default();
        let mut random = Seed(4).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        for _ in 0..8 {
            let from = pose(0.0, 0.0, 5.0, draw(-3.0, 3.0), 0.0);
            let to = Point3::new(draw(-90.0, 90.0), draw(-90.0, 90.0), 5.0);
            // Trials end within a metre of the place, and the length jumps where a turn vanishes.
            let around = [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
            let found_m = around.map(|(x, y)| {
                let place = to + Vector3::new(x, y, 0.0);
                shortest_level(&vehicle, ConnectionStart::Pose(from), place).length_m
            });
            let found_m = found_m.into_iter().fold(f64::INFINITY, f64::min);
            let searched_m = searched_m(from, to, 20.01);
            assert!(found_m < searched_m + 2.0, "{found_m} {searched_m}");
        }
    }

    #[test]
    fn depth_that_the_way_does_not_allow_is_gained_in_circles() {
        let from = pose(0.0, 0.0, 10.0, 0.0, 0.0);
        for turn_radius_m in [0.0, 20.0] {
            let vehicle = Vehicle {
                turn_radius_m,
                ..Vehicle::default()
            };
            let least_m = 100.0 / libm::sin(vehicle.max_pitch_rad);
            for start in [
                ConnectionStart::Pose(from),
                ConnectionStart::Place(from.place),
            ] {
                for across_m in [0.0, 15.0, 100.0] {
                    let to = ConnectionEnd::Place(Point3::new(across_m, 0.0, 110.0));
                    let ways = connections_between(&vehicle, start, to);
                    let length_m = ways[0].length_m;
                    assert!(
                        length_m >= least_m && length_m < 1.1 * least_m,
                        "{length_m}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_vehicle_that_turns_on_the_spot_goes_straight() {
        let from = pose(0.0, 0.0, 5.0, 0.0, 0.0);
        let to = pose(-50.0, 9.0, 15.0, 1.0, 0.0);
        assert_eq!(
            connections(&Vehicle::paper(), from, to),
            [[from.place, to.place]]
        );
    }
}
