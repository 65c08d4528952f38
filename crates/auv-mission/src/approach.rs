//! Other starts and ends of a planner's path: a path is cut short and joined to the vehicle's velocity, or
//! to its target in a direction from which a way on leads.

use crate::leads::directions;
use crate::way_on::{permanent, way_on};
use auv_obstacles::TimedPoint;
use auv_planning::motion::{Pose, connections, level_heading};
use auv_planning::{PathProblem, Trajectory};
use auv_types::{Point3, Vector3};

/// The bed's slope at a target is measured over this, metres.
const SLOPE_STEP_M: f64 = 1.0;
/// How much of a path is replaced, in turn radii; last the whole of it.
const CUTS: [f64; 5] = [4.0, 8.0, 16.0, 32.0, f64::INFINITY];
/// A connection leaves a path along a piece that is at least this long, metres.
const LEAST_PIECE_M: f64 = 0.5;

/// The path through places with another start: along shortest curves from the problem's start velocity.
pub(crate) fn other_starts<'p>(
    problem: &'p PathProblem<'_>,
    places: Vec<Point3<f64>>,
) -> impl Iterator<Item = Trajectory> + 'p {
    let velocity = problem.start_velocity.filter(|v| v.norm() > 0.0);
    let cuts = velocity
        .into_iter()
        .flat_map(|velocity| CUTS.map(|cut| (cut, velocity)));
    let whole = cuts.flat_map(move |(cut, velocity)| {
        let from = Pose {
            place: problem.start,
            direction: velocity,
        };
        let joined = join(&places, cut * problem.vehicle.turn_radius_m);
        let ways = joined.map_or(Vec::new(), |(at, direction)| {
            let to = Pose {
                place: places[at],
                direction,
            };
            let rest = &places[at + 1..];
            let ways = connections(problem.vehicle, from, to).into_iter();
            ways.map(|way| [&way, rest].concat()).collect()
        });
        ways.into_iter()
    });
    whole.filter_map(|points| problem.timed(&points).ok())
}

/// The first vertex at least `cut_m` along a path, and the direction of the piece that leads on from it.
fn join(places: &[Point3<f64>], cut_m: f64) -> Option<(usize, Vector3<f64>)> {
    let mut gone_m = 0.0;
    for (k, pair) in places.windows(2).enumerate() {
        let piece = pair[1] - pair[0];
        if gone_m >= cut_m && piece.norm() >= LEAST_PIECE_M {
            return Some((k, piece));
        }
        gone_m += piece.norm();
    }
    // The whole path is replaced: its end is reached in its direction.
    let last = places.len().checked_sub(2)?;
    Some((last + 1, places[last + 1] - places[last]))
}

/// The path with another end: along shortest curves, level, in directions from which the vehicle can stay
/// at the target. Directions near that of the path come first.
pub(crate) fn other_ends<'p>(
    problem: &'p PathProblem<'_>,
    path: &'p Trajectory,
) -> impl Iterator<Item = Trajectory> + 'p {
    let places: Vec<Point3<f64>> = path.points().iter().map(|p| p.position).collect();
    let arrival = level_heading(&path.end_velocity()).unwrap_or_else(Vector3::x);
    let mut headings = headings(problem);
    headings.sort_by(|a, b| b.dot(&arrival).total_cmp(&a.dot(&arrival)));
    let pairs = CUTS.into_iter().flat_map(move |cut| {
        let headings = headings.clone();
        headings.into_iter().map(move |heading| (cut, heading))
    });
    let whole = pairs.flat_map(move |(cut, heading)| {
        let (kept, direction) = leave(problem, &places, cut * problem.vehicle.turn_radius_m);
        let to = Pose {
            place: problem.target,
            direction: heading,
        };
        let from = Pose {
            place: kept.last().copied().unwrap_or(problem.start),
            direction: direction.unwrap_or(heading),
        };
        let before = kept.len().saturating_sub(1);
        let ways = connections(problem.vehicle, from, to).into_iter().take(2);
        let ways: Vec<_> = ways.map(|way| [&kept[..before], &way].concat()).collect();
        ways.into_iter()
    });
    whole.filter_map(|points| problem.timed(&points).ok())
}

/// The path with another end where the bed falls more steeply to the target than the vehicle can pitch: level
/// to the place above the target, and down from there on circles that can be kept at the target too.
pub(crate) fn descents<'p>(
    problem: &'p PathProblem<'_>,
    places: Vec<Point3<f64>>,
) -> impl Iterator<Item = Trajectory> + 'p {
    let pairs = headings(problem)
        .into_iter()
        .flat_map(|heading| CUTS.map(|cut| (cut, heading)));
    let ways = pairs.flat_map(move |(cut, heading)| {
        let (kept, direction) = leave(problem, &places, cut * problem.vehicle.turn_radius_m);
        let from = Pose {
            place: kept[kept.len() - 1],
            direction: direction.unwrap_or(heading),
        };
        let at = |z: f64| Pose {
            place: Point3::new(problem.target.x, problem.target.y, z),
            direction: heading,
        };
        let (above, target) = (at(from.place.z.min(problem.target.z)), at(problem.target.z));
        let level = connections(problem.vehicle, from, above);
        let before = &kept[..kept.len() - 1];
        let circles = connections(problem.vehicle, above, target)
            .into_iter()
            .take(2);
        let level = level.first().map(Vec::as_slice).unwrap_or_default();
        let whole = circles.map(|down| [before, level, down.get(1..).unwrap_or_default()].concat());
        whole.collect::<Vec<_>>()
    });
    ways.filter_map(|points| problem.timed(&points).ok())
}

/// Horizontal directions in which the vehicle can arrive level at the target and go on: of sixteen, and
/// along the slope of the bed.
fn headings(problem: &PathProblem<'_>) -> Vec<Vector3<f64>> {
    let charted = permanent(problem.regions);
    let problem = &PathProblem {
        regions: &charted,
        ..*problem
    };
    let at = problem.target;
    let deepest_m = |north_m: f64, east_m: f64| problem.deepest_at(at.x + north_m, at.y + east_m);
    let across = Vector3::new(
        deepest_m(0.0, SLOPE_STEP_M) - deepest_m(0.0, -SLOPE_STEP_M),
        deepest_m(-SLOPE_STEP_M, 0.0) - deepest_m(SLOPE_STEP_M, 0.0),
        0.0,
    );
    let along = across.try_normalize(1e-9).map(|along| [along, -along]);
    let level = directions().filter(|direction| direction.z == 0.0);
    along
        .into_iter()
        .flatten()
        .chain(level)
        .filter(|direction| {
            let place = TimedPoint::new(problem.target, problem.departure_s);
            let velocity = direction * problem.vehicle.speed_mps;
            way_on(problem, place, velocity, 0.0).is_some()
        })
        .collect()
}

/// The part of a path that is kept when at least `cut_m` of its end is replaced, and the direction of
/// travel there; where the whole path is replaced, its start with the problem's start velocity.
fn leave<'a>(
    problem: &PathProblem<'_>,
    places: &'a [Point3<f64>],
    cut_m: f64,
) -> (&'a [Point3<f64>], Option<Vector3<f64>>) {
    let mut left_m = 0.0;
    for k in (1..places.len()).rev() {
        let piece = places[k] - places[k - 1];
        if left_m >= cut_m && piece.norm() >= LEAST_PIECE_M {
            return (&places[..=k], Some(piece));
        }
        left_m += piece.norm();
    }
    (
        &places[..1],
        problem.start_velocity.filter(|v| v.norm() > 0.0),
    )
}
