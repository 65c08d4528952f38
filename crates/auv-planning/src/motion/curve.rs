//! Level curves of turns and straights.

use auv_types::{Point3, Vector3, libm};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Where a curve leads: a place, and the heading there if one is asked for, radians.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    pub(crate) place: Point3<f64>,
    pub(crate) heading: Option<f64>,
}

/// A straight and a turn, and a Dubins curve of up to three parts, the first with full circles. Sides are 1 to the right and -1 to
/// the left, 0 straight on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LevelCurve {
    pub(crate) from: Point3<f64>,
    pub(crate) heading: f64,
    pub(crate) radius_m: f64,
    /// Side and length of each part, metres.
    pub(crate) parts: [(f64, f64); 5],
}

/// Number of the kinds of curves that [`curves`] gives.
pub(crate) const KINDS: usize = 8;

impl LevelCurve {
    pub(crate) fn length_m(&self) -> f64 {
        self.parts.iter().map(|(_, length_m)| length_m).sum()
    }

    /// The place after a distance, at the depth of the start.
    pub(crate) fn at(&self, distance_m: f64) -> Point3<f64> {
        let (mut at, mut heading, mut left_m) = (self.from, self.heading, distance_m);
        // A part of no length leads nowhere.
        for (side, length_m) in self.parts.into_iter().filter(|part| part.1 > 0.0) {
            if left_m <= 0.0 {
                break;
            }
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

    pub(crate) fn end_heading(&self) -> f64 {
        let turned = self.parts.iter().map(|(side, length_m)| side * length_m);
        self.heading + turned.sum::<f64>() / self.radius_m
    }

    /// Where the last part begins if it is a straight, as a distance along the curve, metres.
    pub(crate) fn last_straight_m(&self) -> Option<f64> {
        let last = self.parts.iter().rposition(|part| part.1 > 0.0)?;
        let before = &self.parts[..last];
        (self.parts[last].0 == 0.0).then(|| before.iter().map(|part| part.1).sum())
    }
}

/// The heading of a direction, radians.
pub(crate) fn heading_of(direction: &Vector3<f64>) -> f64 {
    libm::atan2(direction.y, direction.x)
}

/// The turn from one heading to another on a side, radians from 0 to a full turn.
fn turn_rad(side: f64, from: f64, to: f64) -> f64 {
    let turn = (side * (to - from)).rem_euclid(TAU);
    // Rounding must not add a full circle.
    if turn > TAU - 1e-9 { 0.0 } else { turn }
}

/// The centre of the circle on a side, seen from above.
fn centre(place: Point3<f64>, heading: f64, side: f64, radius_m: f64) -> Vector3<f64> {
    let (sin, cos) = libm::sincos(heading);
    Vector3::new(place.x, place.y, 0.0) + Vector3::new(-sin, cos, 0.0) * (side * radius_m)
}

/// The curves from a place with a heading, by kind: all that are candidates for the shortest one (Dubins
/// 1957), with or without a heading at the end. `None` where a kind does not exist.
pub(crate) fn curves(
    from: Point3<f64>,
    heading: f64,
    goal: &Goal,
    radius_m: f64,
) -> [Option<LevelCurve>; KINDS] {
    let mut found = [None; KINDS];
    let parts = match goal.heading {
        Some(end) => to_heading(from, heading, goal.place, end, radius_m),
        None => to_place(from, heading, goal.place, radius_m),
    };
    for (found, parts) in found.iter_mut().zip(parts) {
        *found = parts.map(|[first, middle, last]| LevelCurve {
            from,
            heading,
            radius_m,
            parts: [(0.0, 0.0), (0.0, 0.0), first, middle, last],
        });
    }
    found
}

type Parts = [(f64, f64); 3];

/// A turn and a straight, or two turns.
fn to_place(from: Point3<f64>, heading: f64, to: Point3<f64>, radius_m: f64) -> [Option<Parts>; 8] {
    let mut found = [None; KINDS];
    for (k, side) in [1.0, -1.0].into_iter().enumerate() {
        let across = Vector3::new(to.x, to.y, 0.0) - centre(from, heading, side, radius_m);
        let (apart_m, bearing) = (across.norm(), heading_of(&across));
        let first = |leave: f64| (side, radius_m * turn_rad(side, heading, leave));
        if apart_m >= radius_m {
            let straight_m = libm::sqrt(apart_m * apart_m - radius_m * radius_m);
            let leave = bearing + side * libm::atan2(radius_m, straight_m);
            found[k] = Some([first(leave), (0.0, straight_m), (0.0, 0.0)]);
        }
        // The second circle touches the first, and the place lies on it.
        let cosine = (3.0 * radius_m * radius_m + apart_m * apart_m) / (4.0 * radius_m * apart_m);
        if apart_m > 0.0 && cosine <= 1.0 {
            for (j, bend) in [1.0, -1.0].into_iter().enumerate() {
                let to_second = bearing + bend * libm::acos(cosine);
                let (sin, cos) = libm::sincos(to_second);
                let beyond = across - Vector3::new(cos, sin, 0.0) * (2.0 * radius_m);
                let swap = to_second + side * FRAC_PI_2;
                let end = heading_of(&beyond) - side * FRAC_PI_2;
                let second = (-side, radius_m * turn_rad(-side, swap, end));
                found[2 + 2 * k + j] = Some([first(swap), second, (0.0, 0.0)]);
            }
        }
    }
    found
}

/// A turn, a straight or an opposite turn, and a turn.
fn to_heading(
    from: Point3<f64>,
    heading: f64,
    to: Point3<f64>,
    end: f64,
    radius_m: f64,
) -> [Option<Parts>; 8] {
    let mut found = [None; KINDS];
    for (k, (first, last)) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
        .into_iter()
        .enumerate()
    {
        let across = centre(to, end, last, radius_m) - centre(from, heading, first, radius_m);
        let (apart_m, bearing) = (across.norm(), heading_of(&across));
        let turns = |enter: f64, middle: (f64, f64), leave: f64| {
            [
                (first, radius_m * turn_rad(first, heading, enter)),
                middle,
                (last, radius_m * turn_rad(last, leave, end)),
            ]
        };
        if k == 0 || k == 3 {
            let bearing = if apart_m > 0.0 { bearing } else { heading };
            found[k] = Some(turns(bearing, (0.0, apart_m), bearing));
            if apart_m < 4.0 * radius_m {
                let half_rad = libm::acos(apart_m / (4.0 * radius_m));
                for (j, bend) in [half_rad, -half_rad].into_iter().enumerate() {
                    // The middle circle touches both; its centre lies off the line between them.
                    let enter = bearing + bend + first * FRAC_PI_2;
                    let leave = bearing + PI - bend + first * FRAC_PI_2;
                    let middle = (-first, radius_m * turn_rad(-first, enter, leave));
                    found[4 + 2 * (k / 3) + j] = Some(turns(enter, middle, leave));
                }
            }
        } else if apart_m >= 2.0 * radius_m {
            let straight_m = libm::sqrt(apart_m * apart_m - 4.0 * radius_m * radius_m);
            let course = bearing + first * libm::atan2(2.0 * radius_m, straight_m);
            found[k] = Some(turns(course, (0.0, straight_m), course));
        }
    }
    found
}

/// What comes before the last curve to make a way longer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lengthening {
    /// A straight on ahead, and full circles to the side of the curve's first turn.
    Ahead,
    /// A turn to the other side, and full circles.
    Aside,
    /// Full circles alone: the way is longer than asked by up to one of them.
    Circles,
}

/// The curve of a kind with as many circles as fit into a length, and a straight or a turn that makes it
/// exactly as long. With a turn, it goes on straight over `straight_m` first. `None` where none is as long.
pub(crate) fn lengthened(
    bare: &LevelCurve,
    kind: usize,
    goal: &Goal,
    length_m: f64,
    (lengthening, straight_m): (Lengthening, f64),
) -> Option<LevelCurve> {
    let (radius_m, side) = (bare.radius_m, bare.parts[2].0);
    let circle_m = TAU * bare.radius_m;
    // What is left to the goal after a straight and a turn to a side.
    let after = |straight_m: f64, side: f64, turn_m: f64| {
        let begun = LevelCurve {
            parts: [
                (0.0, straight_m),
                (side, turn_m),
                (0.0, 0.0),
                (0.0, 0.0),
                (0.0, 0.0),
            ],
            ..*bare
        };
        let heading = bare.heading + side * turn_m / radius_m;
        let (place, turned_m) = (begun.at(straight_m + turn_m), (side, turn_m));
        let mut found = curves(place, heading, goal, radius_m)[kind]?;
        (found.from, found.heading) = (bare.from, bare.heading);
        (found.parts[0], found.parts[1]) = ((0.0, straight_m), turned_m);
        Some(found)
    };
    let with = |free_m: f64| match lengthening {
        Lengthening::Ahead => after(free_m, side, 0.0),
        Lengthening::Aside => after(straight_m, -side, free_m),
        Lengthening::Circles => after(0.0, side, 0.0),
    };
    let spare_m = (length_m - with(0.0)?.length_m()).max(0.0);
    let circles = match lengthening {
        Lengthening::Circles => (spare_m / circle_m).ceil(),
        _ => (spare_m / circle_m).floor(),
    };
    let rest_m = length_m - circles * circle_m;
    let (mut low_m, mut high_m) = match lengthening {
        Lengthening::Ahead => (0.0, rest_m),
        Lengthening::Aside => (0.0, circle_m),
        Lengthening::Circles => (0.0, 0.0),
    };
    for _ in 0..BISECTIONS {
        let middle_m = 0.5 * (low_m + high_m);
        if with(middle_m).is_some_and(|found| found.length_m() < rest_m) {
            low_m = middle_m;
        } else {
            high_m = middle_m;
        }
    }
    let mut found = with(high_m)?;
    let exact = lengthening == Lengthening::Circles || found.length_m() - rest_m < EXACT_M;
    found.parts[2].1 += circles * circle_m;
    exact.then_some(found)
}

/// Halvings of the part that makes a curve as long as asked, and how exact it must be, metres.
const BISECTIONS: usize = 40;
const EXACT_M: f64 = 1e-5;
