//! Short ways from here, without a planner: in all directions, and up.

use crate::climb::ascent;
use crate::station_keeping::{arc, level_heading};
use auv_planning::PathProblem;
use auv_planning::polyline::rounded;
use auv_types::{Point3, Vector3, libm};

/// Lengths that are tried, metres, for a vehicle of at least [`WHOLE_SPEED_MPS`].
const LENGTHS_M: [f64; 6] = [25.0, 50.0, 100.0, 200.0, 400.0, 800.0];
/// A slower vehicle tries lengths that are shorter by as much, m/s.
const WHOLE_SPEED_MPS: f64 = 1.5;
/// How far helices climb, metres.
const CLIMBS_M: [f64; 3] = [10.0, 25.0, 60.0];

/// A short way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Lead {
    /// A turn into a direction, by its index, and straight on.
    Towards { direction: usize, length_m: f64 },
    /// A helix to a depth, to the right (1) or left (-1).
    Climb { to_m: f64, side: f64 },
}

impl Lead {
    /// The index of its direction, if it has one.
    pub(crate) fn direction(self) -> Option<usize> {
        match self {
            Self::Towards { direction, .. } => Some(direction),
            Self::Climb { .. } => None,
        }
    }

    /// The polyline from the problem's start with a velocity.
    pub(crate) fn points(
        self,
        problem: &PathProblem<'_>,
        velocity: Vector3<f64>,
    ) -> Vec<Point3<f64>> {
        match self {
            Self::Towards {
                direction,
                length_m,
            } => way_towards(problem, velocity, &direction_of(direction), length_m),
            Self::Climb { to_m, side } => ascent(problem, velocity, to_m, side),
        }
    }
}

/// Ways from the problem's start: short ones first, to all sides, none longer than `longest_m` beyond its turn;
/// then climbs.
pub(crate) fn leads(
    problem: &PathProblem<'_>,
    longest_m: f64,
) -> impl Iterator<Item = Lead> + use<> {
    let scale = (problem.vehicle.speed_mps / WHOLE_SPEED_MPS).min(1.0);
    let lengths = LENGTHS_M
        .into_iter()
        .filter(move |&length_m| length_m <= longest_m);
    let level = lengths.flat_map(move |length_m| {
        (0..DIRECTIONS).map(move |direction| Lead::Towards {
            direction,
            length_m: scale * length_m,
        })
    });
    let top_m = problem.bounds.map_or(0.0, |bounds| bounds.low.z);
    let (turns, from_m) = (problem.vehicle.turn_radius_m > 0.0, problem.start.z);
    let climbs = CLIMBS_M.into_iter().filter(move |_| turns);
    let climbs = climbs.flat_map(move |climb_m| {
        let to_m = (from_m - climb_m).max(top_m);
        [1.0, -1.0].map(|side| Lead::Climb { to_m, side })
    });
    level.chain(climbs)
}

/// Number of [`directions`].
pub(crate) const DIRECTIONS: usize = LEVEL_DIRECTIONS + 2;
const LEVEL_DIRECTIONS: usize = 16;

/// Sixteen level directions, then steeply up and down.
pub(crate) fn directions() -> impl Iterator<Item = Vector3<f64>> {
    (0..DIRECTIONS).map(direction_of)
}

fn direction_of(index: usize) -> Vector3<f64> {
    if index < LEVEL_DIRECTIONS {
        let heading = std::f64::consts::TAU * index as f64 / LEVEL_DIRECTIONS as f64;
        Vector3::new(libm::cos(heading), libm::sin(heading), 0.0)
    } else if index == LEVEL_DIRECTIONS {
        -Vector3::z()
    } else {
        Vector3::z()
    }
}

/// A turn into the direction, as tight as the vehicle can, and straight on; or a climb or dive. For a
/// vehicle that turns on the spot, a straight line that ends within the box.
fn way_towards(
    problem: &PathProblem<'_>,
    velocity: Vector3<f64>,
    direction: &Vector3<f64>,
    length_m: f64,
) -> Vec<Point3<f64>> {
    let start = problem.start;
    let radius_m = problem.vehicle.turn_radius_m;
    let mut points = vec![start];
    if radius_m > 0.0 && velocity.norm() > 0.0 && direction.z != 0.0 {
        // Straight on, as steeply up or down as the vehicle may.
        let pitch_rad = 0.95 * problem.vehicle.max_pitch_rad.min(1.0);
        let slope =
            level_heading(&velocity) * libm::cos(pitch_rad) + direction * libm::sin(pitch_rad);
        let ahead = velocity.normalize();
        let knee = start + ahead * radius_m;
        points = rounded(
            &[start, knee, knee + slope * length_m.max(radius_m)],
            radius_m,
        );
    } else if radius_m > 0.0 && velocity.norm() > 0.0 {
        let heading = level_heading(&velocity);
        let across = heading.x * direction.y - heading.y * direction.x;
        let side = if across >= 0.0 { 1.0 } else { -1.0 };
        points.extend(turn_towards(start, velocity, direction, side * radius_m));
        points.push(points[points.len() - 1] + direction * length_m);
    } else {
        let end = start + direction * length_m;
        points.push(problem.bounds.map_or(end, |bounds| bounds.clamp(&end)));
    }
    points
}

/// A level turn from a velocity into a direction, to the right (positive radius) or left, the first
/// point excluded.
pub(crate) fn turn_towards(
    start: Point3<f64>,
    velocity: Vector3<f64>,
    direction: &Vector3<f64>,
    radius_m: f64,
) -> impl Iterator<Item = Point3<f64>> {
    let heading = level_heading(&velocity);
    let across = heading.x * direction.y - heading.y * direction.x;
    let to_the_right_rad = libm::atan2(across, heading.dot(direction));
    let angle_rad = (to_the_right_rad * radius_m.signum()).rem_euclid(std::f64::consts::TAU);
    arc(start, heading, 1.01 * radius_m, angle_rad)
}
