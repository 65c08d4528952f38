//! The shortest flyable connections between two places: turns, straights and circles with a steady change
//! of depth along them.

use super::curve::{Goal, KINDS, Lengthening, LevelCurve, curves, heading_of, lengthened};
use super::descent::{Descent, EndSlopes};
use crate::{Trajectory, Vehicle};
use auv_types::{Point3, Vector3, libm};
use std::f64::consts::TAU;

/// Circles of a vehicle that turns on the spot have this radius, metres.
const LEAST_RADIUS_M: f64 = 5.0;
/// Radii that are tried, in turn radii. A vehicle that turns as tightly as it can has little left to pitch.
const RADII: [f64; 3] = [1.0005, 1.03, 1.08];
/// Longest step of a turn, radians.
const LONGEST_STEP_RAD: f64 = 0.15;
/// The share of the steepest slope that is used: rounding must not exceed it.
const SLOPE_SHARE: f64 = 1.0 - 1e-6;
/// A pitch limit above this is none, radians. No slope that is used is steeper.
pub(crate) const STEEPEST_RAD: f64 = 1.5;
/// Tries to make a curve long enough for its change of depth, and the most circles it may get.
const TRIES: usize = 6;
const MOST_CIRCLES: f64 = 200.0;
/// A vertex that turns by less is none, radians.
const STRAIGHT_RAD: f64 = 1e-7;
/// Chords are shorter than their arcs by at most this share.
const CHORD_LOSS: f64 = 1.2e-3;
/// A direction shorter than this is none.
const LEAST_DIRECTION: f64 = 1e-6;
/// Two places closer than this are one, metres.
const SAME_PLACE_M: f64 = 1e-6;

/// A place and the direction of travel there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The place, metres.
    pub place: Point3<f64>,
    /// The direction of travel; its length does not count. A vertical one heads north.
    pub direction: Vector3<f64>,
}

/// Where a connection ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConnectionEnd {
    /// At a place, in a direction.
    Pose(Pose),
    /// At a place, in whatever direction is reached soonest.
    Place(Point3<f64>),
}

/// How a connection begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConnectionStart {
    /// At a place, in the direction flown.
    Pose(Pose),
    /// At a place, in any direction.
    Place(Point3<f64>),
}

/// A polyline that the vehicle can fly in still water.
#[derive(Clone, Debug, PartialEq)]
pub struct Connection {
    /// Which turns it makes; connections to other places have the same turns by the same number.
    pub kind: usize,
    /// Its points, at most a chord error of [`Trajectory::CHORD_ERROR_M`] off the curve.
    pub points: Vec<Point3<f64>>,
    /// The first point on the straight that it ends with, if it does.
    pub straight_from: Option<usize>,
    /// Its length, metres.
    pub length_m: f64,
}

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

/// What is to be connected.
struct Task<'a> {
    vehicle: &'a Vehicle,
    from: Point3<f64>,
    /// The direction flown at the start, if it binds.
    direction: Option<Vector3<f64>>,
    heading: f64,
    to: Point3<f64>,
    goal: Goal,
    ends: EndSlopes,
    radius_m: f64,
    steepest: f64,
}

impl<'a> Task<'a> {
    fn new(vehicle: &'a Vehicle, from: ConnectionStart, to: ConnectionEnd) -> Self {
        let turns = vehicle.turn_radius_m > 0.0;
        let binds = |direction: &Vector3<f64>| turns && direction.norm() > LEAST_DIRECTION;
        let pose_of = |pose: Pose| (pose.place, Some(pose.direction).filter(binds));
        let (start, direction) = match from {
            ConnectionStart::Pose(pose) => pose_of(pose),
            ConnectionStart::Place(place) => (place, None),
        };
        let (place, arrival) = match to {
            ConnectionEnd::Pose(pose) => pose_of(pose),
            ConnectionEnd::Place(place) => (place, None),
        };
        let steepest = libm::tan(vehicle.max_pitch_rad.min(STEEPEST_RAD)) * SLOPE_SHARE;
        let slope = |direction: Vector3<f64>| slope_of(&direction).clamp(-steepest, steepest);
        Self {
            vehicle,
            from: start,
            direction,
            heading: heading_of(&direction.unwrap_or(place - start)),
            to: place,
            goal: Goal {
                place,
                heading: arrival.map(|arrival| heading_of(&arrival)),
            },
            ends: EndSlopes {
                start: direction.map(slope),
                end: arrival.map(slope),
            },
            radius_m: if turns {
                vehicle.turn_radius_m
            } else {
                LEAST_RADIUS_M
            },
            steepest,
        }
    }

    fn dive_m(&self) -> f64 {
        self.to.z - self.from.z
    }

    /// The straight line, where neither a direction nor the pitch forbids it.
    fn straight(&self) -> Option<Connection> {
        if self.direction.is_some() || self.goal.heading.is_some() {
            return None;
        }
        let line = self.to - self.from;
        let flat_enough = self.vehicle.max_pitch_rad >= STEEPEST_RAD
            || line.z.abs() <= self.steepest * line.xy().norm();
        flat_enough.then(|| Connection {
            kind: KINDS,
            points: vec![self.from, self.to],
            straight_from: Some(0),
            length_m: line.norm(),
        })
    }

    /// The shortest connections of a kind. Where it is too short for the change of depth: for each way to
    /// make it longer, since one may need room that is not there.
    fn of_kind(&self, kind: usize) -> Vec<Connection> {
        let level = self.dive_m() == 0.0 && self.ends.start.is_none_or(|slope| slope == 0.0);
        let radii = if level { &RADII[..1] } else { &RADII[..] };
        let shortest = |lengthening: Option<Lengthening>| {
            let each = radii
                .iter()
                .filter_map(|wider| self.flown(kind, *wider, lengthening));
            each.min_by(|a, b| a.length_m.total_cmp(&b.length_m))
        };
        if let Some(found) = shortest(None) {
            return vec![found];
        }
        let ways = [Lengthening::Ahead, Lengthening::Aside, Lengthening::Circles];
        ways.into_iter()
            .filter_map(|way| shortest(Some(way)))
            .collect()
    }

    /// A connection of a kind and radius, made longer if it needs to be and may.
    fn flown(&self, kind: usize, wider: f64, longer: Option<Lengthening>) -> Option<Connection> {
        let radius_m = wider * self.radius_m;
        let bare = curves(self.from, self.heading, &self.goal, radius_m)[kind]?;
        let side = if self.dive_m() < 0.0 { -1.0 } else { 1.0 };
        let most_m = MOST_CIRCLES * TAU * radius_m + bare.length_m();
        let mut curve = bare;
        for _ in 0..TRIES {
            let mut points = sampled(&curve, self.blend_m());
            let limit_m = self.vehicle.turn_radius_m;
            let descent = Descent::new(&points, self.direction, limit_m, self.steepest);
            let reach_m = descent.most_m(self.ends, side);
            if reach_m.is_some_and(|reach_m| reach_m >= self.dive_m().abs())
                && let Some(slopes) = descent.steady(self.ends, self.dive_m())
            {
                descent.apply(&slopes, &mut points);
                return Some(self.finished(kind, &curve, &points));
            }
            let short_m = reach_m.map_or(radius_m, |reach_m| self.dive_m().abs() - reach_m);
            let longer_m = short_m.max(SAME_PLACE_M) / self.steepest + SAME_PLACE_M;
            let length_m = curve.length_m() + longer_m;
            if length_m > most_m {
                return None;
            }
            let how = (longer?, 0.5 * self.blend_m());
            curve = lengthened(&bare, kind, &self.goal, length_m, how)?;
        }
        None
    }

    /// The distance over which the pitch can change from one limit to the other on a straight, metres.
    fn blend_m(&self) -> f64 {
        2.2 * self.vehicle.turn_radius_m * self.vehicle.max_pitch_rad.min(STEEPEST_RAD)
    }

    fn finished(&self, kind: usize, curve: &LevelCurve, points: &[Point3<f64>]) -> Connection {
        let mut points = without_straight_points(points);
        // Rounding of the turns must not move the end.
        if let Some(last) = points.last_mut() {
            *last = self.to;
        }
        let begins_m = curve.last_straight_m();
        let straight_from = begins_m.and_then(|begins_m| {
            let mut gone_m = 0.0;
            points.windows(2).position(|pair| {
                let before_m = gone_m;
                gone_m += (pair[1] - pair[0]).xy().norm();
                before_m >= begins_m - CHORD_LOSS * before_m
            })
        });
        let length_m = points.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        Connection {
            kind,
            points,
            straight_from,
            length_m,
        }
    }
}

/// The polyline without the points at which it goes straight on.
fn without_straight_points(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
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
fn sampled(curve: &LevelCurve, blend_m: f64) -> Vec<Point3<f64>> {
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

/// Depth gained per horizontal metre along a direction; 0 for a vertical one.
fn slope_of(direction: &Vector3<f64>) -> f64 {
    let across = direction.xy().norm();
    if across > 1e-6 {
        direction.z / across
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polyline::turn_radius_m;
    use auv_types::{Seed, rand::RngExt};

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
