//! The shortest flyable connection between two places with given headings.

use crate::{Trajectory, Vehicle};
use auv_types::{Point3, Vector3, libm};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The share by which connections turn wider than the vehicle must, so that a sampled turn keeps its
/// radius.
const WIDER: f64 = 1.05;
/// Radius of the change of pitch, in turn radii: with it, turning and pitching together keep the turn
/// radius in space.
const PITCHING_RADII: f64 = 3.5;
/// The share of the greatest pitch that connections use.
const PITCH_SHARE: f64 = 0.97;
/// Full circles added at most to gain or lose depth.
const MOST_CIRCLES: u32 = 40;

/// A place and the direction of travel there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The place, metres.
    pub place: Point3<f64>,
    /// The direction of travel; its length does not count. A vertical one heads north.
    pub direction: Vector3<f64>,
}

/// Polylines from one pose to another that the vehicle can fly in still water, shortest first.
///
/// Horizontally each is a Dubins curve (Dubins 1957): a turn, a straight or an opposite turn, and a
/// turn. The depth changes along it with a smooth slope within the pitch limit; where the curve is too
/// short for the change of depth, full circles are added at its start. Box, bed and regions are not
/// considered. Points are at even distances, within [`Trajectory::CHORD_ERROR_M`] of the curve.
///
/// Both ends may be pitched. A vehicle that turns on the spot goes straight.
#[must_use]
pub fn connections(vehicle: &Vehicle, from: Pose, to: Pose) -> Vec<Vec<Point3<f64>>> {
    if vehicle.turn_radius_m <= 0.0 {
        return vec![vec![from.place, to.place]];
    }
    let radius_m = WIDER * vehicle.turn_radius_m;
    let mut words = words(from, to, radius_m);
    words.sort_by(|a, b| a.length_m().total_cmp(&b.length_m()));
    let flown = words
        .into_iter()
        .filter_map(|word| flown(vehicle, from, to, word));
    flown.collect()
}

/// A turn, a middle part and a turn. Sides are 1 to the right and -1 to the left, 0 straight on.
#[derive(Clone, Copy, Debug)]
struct Word {
    radius_m: f64,
    /// Side and length of each part, metres.
    parts: [(f64, f64); 3],
}

impl Word {
    fn length_m(&self) -> f64 {
        self.parts.iter().map(|(_, length_m)| length_m).sum()
    }

    /// Place and heading after a distance from a place with a heading.
    fn at(&self, place: Point3<f64>, heading: f64, distance_m: f64) -> Point3<f64> {
        let (mut at, mut heading, mut left_m) = (place, heading, distance_m);
        for (side, length_m) in self.parts {
            let part_m = length_m.min(left_m);
            (at, heading) = self.moved(at, heading, side, part_m);
            left_m -= part_m;
        }
        at
    }

    fn moved(&self, at: Point3<f64>, heading: f64, side: f64, part_m: f64) -> (Point3<f64>, f64) {
        let (sin, cos) = libm::sincos(heading);
        if side == 0.0 {
            return (at + Vector3::new(cos, sin, 0.0) * part_m, heading);
        }
        let after = heading + side * part_m / self.radius_m;
        let (sin_after, cos_after) = libm::sincos(after);
        let across = Vector3::new(sin_after - sin, cos - cos_after, 0.0);
        (at + across * (side * self.radius_m), after)
    }
}

fn heading_of(direction: &Vector3<f64>) -> f64 {
    libm::atan2(direction.y, direction.x)
}

/// The turn from one heading to another on a side, radians from 0 to a full turn.
fn turn_rad(side: f64, from: f64, to: f64) -> f64 {
    let turn = (side * (to - from)).rem_euclid(TAU);
    // Rounding must not add a full circle.
    if turn > TAU - 1e-9 { 0.0 } else { turn }
}

/// The Dubins curves between two poses: up to six.
fn words(from: Pose, to: Pose, radius_m: f64) -> Vec<Word> {
    let (from_rad, to_rad) = (heading_of(&from.direction), heading_of(&to.direction));
    let centre = |place: Point3<f64>, heading: f64, side: f64| {
        let (sin, cos) = libm::sincos(heading);
        place.xy() + Vector3::new(-sin, cos, 0.0).xy() * (side * radius_m)
    };
    let mut words = Vec::new();
    for first in [1.0, -1.0] {
        for last in [1.0, -1.0] {
            let across = centre(to.place, to_rad, last) - centre(from.place, from_rad, first);
            let apart_m = across.norm();
            let bearing = libm::atan2(across.y, across.x);
            let straight = |heading: f64, straight_m: f64| Word {
                radius_m,
                parts: [
                    (first, radius_m * turn_rad(first, from_rad, heading)),
                    (0.0, straight_m),
                    (last, radius_m * turn_rad(last, heading, to_rad)),
                ],
            };
            let same_side = f64::total_cmp(&first, &last).is_eq();
            if same_side {
                let bearing = if apart_m > 0.0 { bearing } else { from_rad };
                words.push(straight(bearing, apart_m));
            } else if apart_m >= 2.0 * radius_m {
                let straight_m = libm::sqrt(apart_m * apart_m - 4.0 * radius_m * radius_m);
                let lean = libm::atan2(2.0 * radius_m, straight_m);
                words.push(straight(bearing + first * lean, straight_m));
            }
            if same_side && apart_m < 4.0 * radius_m {
                let half_rad = libm::acos(apart_m / (4.0 * radius_m));
                for bend in [half_rad, -half_rad] {
                    // The middle circle touches both; its centre lies off the line between them.
                    let enter = bearing + bend + first * FRAC_PI_2;
                    let leave = bearing + PI - bend + first * FRAC_PI_2;
                    words.push(Word {
                        radius_m,
                        parts: [
                            (first, radius_m * turn_rad(first, from_rad, enter)),
                            (-first, radius_m * turn_rad(-first, enter, leave)),
                            (last, radius_m * turn_rad(last, leave, to_rad)),
                        ],
                    });
                }
            }
        }
    }
    words
}

/// The points of a word with its change of depth; `None` where no number of circles suffices.
fn flown(vehicle: &Vehicle, from: Pose, to: Pose, mut word: Word) -> Option<Vec<Point3<f64>>> {
    let circle_m = TAU * word.radius_m;
    let dive_m = to.place.z - from.place.z;
    // The first turn, or a circle to its side, takes up the circles that the depth needs.
    let side = if word.parts[0].0 == 0.0 {
        1.0
    } else {
        word.parts[0].0
    };
    let steepest = libm::tan(PITCH_SHARE * vehicle.max_pitch_rad.min(1.5));
    let least_m = dive_m.abs() / steepest;
    let missing_m = (least_m - word.length_m()).max(0.0);
    let mut circles = (missing_m / circle_m).ceil();
    let bare = word.parts[0].1;
    for _ in 0..4 {
        if circles > f64::from(MOST_CIRCLES) {
            return None;
        }
        word.parts[0] = (side, bare + circles * circle_m);
        let slopes = [slope_of(&from.direction), slope_of(&to.direction)];
        let profile = DepthProfile::new(
            slopes,
            dive_m,
            word.length_m(),
            steepest,
            PITCHING_RADII * vehicle.turn_radius_m,
        );
        if let Some(profile) = profile {
            return Some(sampled(from, to, &word, &profile));
        }
        circles += 1.0;
    }
    None
}

fn sampled(from: Pose, to: Pose, word: &Word, profile: &DepthProfile) -> Vec<Point3<f64>> {
    let length_m = word.length_m();
    let step_m = 2.0 * libm::sqrt(2.0 * Trajectory::CHORD_ERROR_M * word.radius_m);
    let count = (length_m / step_m).ceil().max(1.0);
    let heading = heading_of(&from.direction);
    let mut points: Vec<_> = (0..=count as usize)
        .map(|k| {
            let distance_m = length_m * k as f64 / count;
            let level = word.at(from.place, heading, distance_m);
            Point3::new(level.x, level.y, from.place.z + profile.dive_m(distance_m))
        })
        .collect();
    // Rounding of the turns must not move the ends.
    points[0] = from.place;
    if let Some(last) = points.last_mut() {
        *last = to.place;
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

/// Depth along a curve: the slope changes evenly from that of the start to a constant one, and from
/// there to that of the end.
#[derive(Clone, Copy, Debug)]
struct DepthProfile {
    slopes: [f64; 3],
    /// Lengths over which the slope changes, metres.
    blends_m: [f64; 2],
    length_m: f64,
}

impl DepthProfile {
    /// The profile that gains `dive_m` on `length_m`; `None` where slope or length do not allow it.
    fn new(
        [start, end]: [f64; 2],
        dive_m: f64,
        length_m: f64,
        steepest: f64,
        radius_m: f64,
    ) -> Option<Self> {
        let with = |middle: f64| Self {
            slopes: [start, middle, end],
            blends_m: [
                radius_m * (middle - start).abs(),
                radius_m * (end - middle).abs(),
            ],
            length_m,
        };
        // The gain grows with the middle slope: bisect.
        let (mut low, mut high) = (-steepest, steepest);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if with(middle).whole_m() < dive_m {
                low = middle;
            } else {
                high = middle;
            }
        }
        let found = with(0.5 * (low + high));
        let fits = found.blends_m[0] + found.blends_m[1] <= length_m + 1e-9;
        let reaches = (found.whole_m() - dive_m).abs() <= 1e-6 * (1.0 + dive_m.abs());
        (fits && reaches).then_some(found)
    }

    fn whole_m(&self) -> f64 {
        let [start, middle, end] = self.slopes;
        let [first_m, last_m] = self.blends_m;
        0.5 * (start + middle) * first_m
            + middle * (self.length_m - first_m - last_m)
            + 0.5 * (middle + end) * last_m
    }

    /// Depth gained after a distance.
    fn dive_m(&self, distance_m: f64) -> f64 {
        let [start, middle, end] = self.slopes;
        let [first_m, last_m] = self.blends_m;
        let blended = |from: f64, to: f64, along_m: f64, whole_m: f64| {
            if whole_m > 0.0 {
                (from + 0.5 * (to - from) * along_m / whole_m) * along_m
            } else {
                0.0
            }
        };
        let into_m = distance_m.min(first_m);
        let steady_m = (distance_m - first_m).clamp(0.0, self.length_m - first_m - last_m);
        let out_m = (distance_m - (self.length_m - last_m)).max(0.0);
        blended(start, middle, into_m, first_m)
            + middle * steady_m
            + blended(middle, end, out_m, last_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polyline::turn_radius_m;
    use auv_types::{Seed, rand::RngExt};

    fn pose(x: f64, y: f64, z: f64, heading: f64, pitch: f64) -> Pose {
        let (sin, cos) = libm::sincos(heading);
        Pose {
            place: Point3::new(x, y, z),
            direction: Vector3::new(cos, sin, libm::tan(pitch)),
        }
    }

    #[test]
    fn connections_start_and_end_as_asked_and_keep_radius_and_pitch() {
        let vehicle = Vehicle::default();
        let mut random = Seed(3).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let mut found = 0;
        for _ in 0..500 {
            let from = pose(0.0, 0.0, 50.0, draw(-3.0, 3.0), draw(-0.2, 0.2));
            let end = (draw(-150.0, 150.0), draw(-150.0, 150.0), draw(10.0, 90.0));
            let to = pose(end.0, end.1, end.2, draw(-3.0, 3.0), draw(-0.2, 0.2));
            let ways = connections(&vehicle, from, to);
            assert!(!ways.is_empty());
            for way in &ways {
                let last = way.len() - 1;
                assert_eq!((way[0], way[last]), (from.place, to.place));
                let along = |a: Vector3<f64>, b: Vector3<f64>| a.normalize().dot(&b.normalize());
                assert!(along(way[1] - way[0], from.direction) > 0.99);
                assert!(along(way[last] - way[last - 1], to.direction) > 0.99);
                for pair in way.windows(2) {
                    let step = pair[1] - pair[0];
                    let pitch = libm::atan2(step.z.abs(), step.xy().norm());
                    assert!(pitch <= vehicle.max_pitch_rad + 1e-6, "{pitch}");
                }
                for triple in way.windows(3) {
                    let radius_m = turn_radius_m(&triple[0], &triple[1], &triple[2]);
                    assert!(radius_m >= 19.8, "{radius_m}");
                }
            }
            found += ways.len();
        }
        assert!(found > 1500, "{found}");
    }

    /// The length over ground of the shortest level Dubins curve between two poses, metres; the straight
    /// line for a vehicle that turns on the spot.
    fn level_connection_m(vehicle: &Vehicle, from: Pose, to: Pose) -> f64 {
        if vehicle.turn_radius_m <= 0.0 {
            return (to.place - from.place).xy().norm();
        }
        let words = words(from, to, WIDER * vehicle.turn_radius_m);
        let lengths = words.iter().map(Word::length_m);
        lengths.fold(f64::INFINITY, f64::min)
    }

    /// The shortest of many turn-straight-turn and turn-turn-turn curves, by trial of the turns.
    fn searched_m(from: Pose, to: Pose, radius_m: f64) -> f64 {
        let mut best_m = f64::INFINITY;
        let n = 240;
        for (first, middle, last) in [
            (1.0, 0.0, 1.0),
            (1.0, 0.0, -1.0),
            (-1.0, 0.0, 1.0),
            (-1.0, 0.0, -1.0),
            (1.0, -1.0, 1.0),
            (-1.0, 1.0, -1.0),
        ] {
            for i in 0..n {
                let first_m = radius_m * TAU * f64::from(i) / f64::from(n);
                let word = |middle_m: f64| Word {
                    radius_m,
                    parts: [(first, first_m), (middle, middle_m), (last, 0.0)],
                };
                for j in 0..200 {
                    let middle_m = if middle == 0.0 {
                        1.2 * f64::from(j)
                    } else {
                        radius_m * TAU * f64::from(j) / 200.0
                    };
                    let word = word(middle_m);
                    let start = heading_of(&from.direction);
                    let at = word.at(from.place, start, word.length_m());
                    let heading = start + (first * first_m + middle * middle_m) / radius_m;
                    // The last turn must end at the target: its circle must be the target's.
                    let centre = |p: Point3<f64>, heading: f64| {
                        let (sin, cos) = libm::sincos(heading);
                        p.xy() + Vector3::new(-sin, cos, 0.0).xy() * (last * radius_m)
                    };
                    let goal = heading_of(&to.direction);
                    if (centre(at, heading) - centre(to.place, goal)).norm() < 1.5 {
                        let turn = turn_rad(last, heading, goal);
                        best_m = best_m.min(word.length_m() + radius_m * turn);
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
        for _ in 0..12 {
            let from = pose(0.0, 0.0, 5.0, draw(-3.0, 3.0), 0.0);
            let to = pose(
                draw(-90.0, 90.0),
                draw(-90.0, 90.0),
                5.0,
                draw(-3.0, 3.0),
                0.0,
            );
            // Trials end within 1.5 m of the target, and the length jumps where a turn vanishes.
            let around = [(0.0, 0.0), (1.5, 0.0), (-1.5, 0.0), (0.0, 1.5), (0.0, -1.5)];
            let found_m = around.map(|(x, y)| {
                let place = to.place + Vector3::new(x, y, 0.0);
                level_connection_m(&vehicle, from, Pose { place, ..to })
            });
            let found_m = found_m.into_iter().fold(f64::INFINITY, f64::min);
            let searched_m = searched_m(from, to, 21.0);
            assert!(found_m < searched_m + 3.0, "{found_m} {searched_m}");
        }
    }

    #[test]
    fn depth_that_the_way_does_not_allow_is_gained_in_circles() {
        let vehicle = Vehicle::default();
        let ways = connections(
            &vehicle,
            pose(0.0, 0.0, 10.0, 0.0, 0.0),
            pose(100.0, 0.0, 110.0, 0.0, 0.0),
        );
        let length_m: f64 = ways[0].windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        let least_m = 100.0 / libm::sin(vehicle.max_pitch_rad);
        assert!(
            length_m > least_m && length_m < least_m + 250.0,
            "{length_m}"
        );
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
