//! Other starts and ends of a planner's path: a path is cut short and joined to the vehicle's velocity, or
//! to its target in a direction from which a way on leads.

use crate::leads::directions;
use crate::way_on::{permanent, way_on};
use auv_obstacles::TimedPoint;
use auv_planning::motion::{
    ConnectionEnd, ConnectionStart, Pose, connections, connections_between, join, level_heading,
};
use auv_planning::{Arrival, PathProblem, Trajectory};
use auv_types::{Point3, Vector3};
use std::cell::OnceCell;

/// The bed's slope at a target is measured over this, metres.
const SLOPE_STEP_M: f64 = 1.0;
/// How much of a path is replaced, in turn radii; last the whole of it.
const CUTS: [f64; 5] = [4.0, 8.0, 16.0, 32.0, f64::INFINITY];
/// Where a line is joined it is straight for at least this to both sides, metres.
const STRAIGHT_M: f64 = 5.0;
/// How far along a line it is joined, in turn radii; last its end.
const JOINS_OF_LINES: [f64; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, f64::INFINITY];
/// Starts of a path that are tried with other descents.
const STARTS_OF_DESCENTS: usize = 2;
/// A piece of a path that lacks no more than this has room, metres: rounding.
const ROUNDING_M: f64 = 1e-6;
/// A level course stays so far below the top of the box, metres.
const BELOW_TOP_M: f64 = 0.5;
/// A vehicle no farther aside than this is on the straight lead to its target, metres.
const ON_LEAD_M: f64 = 2.0;
/// A connection leaves a path along a piece that is at least this long, metres.
const LEAST_PIECE_M: f64 = 0.5;

/// Other ways to the target of a problem.
pub(crate) struct Approaches<'p> {
    problem: &'p PathProblem<'p>,
    /// Directions of arrival, as soon as they are asked for: they take time.
    headings: OnceCell<Vec<Vector3<f64>>>,
}

impl<'p> Approaches<'p> {
    pub(crate) fn to(problem: &'p PathProblem<'p>) -> Self {
        Self {
            problem,
            headings: OnceCell::new(),
        }
    }

    /// Other paths along courses to the target, in order of preference: with another start; with another, level
    /// end too; with another descent at the end; along the courses at a level above the bed.
    pub(crate) fn mended(
        &self,
        courses: Vec<Vec<Point3<f64>>>,
    ) -> impl Iterator<Item = Trajectory> {
        let problem = self.problem;
        let deeper = problem.target.z > problem.start.z;
        let along = courses.clone().into_iter().filter(move |_| deeper);
        let above = above(problem, courses.last().map_or(&[], Vec::as_slice));
        let deep = along.chain(above).flat_map(move |course| {
            let started = other_starts(problem, course).take(STARTS_OF_DESCENTS);
            started.flat_map(move |path| self.descents(places_of(&path)))
        });
        let starts = move |course| other_starts(problem, course);
        let level = courses.clone().into_iter().flat_map(move |course| {
            let started = other_starts(problem, course).take(1);
            started.flat_map(move |path| self.other_ends(&path))
        });
        courses
            .into_iter()
            .flat_map(starts)
            .chain(level)
            .chain(deep)
    }

    /// See [`headings`].
    fn headings(&self) -> &[Vector3<f64>] {
        self.headings.get_or_init(|| headings(self.problem))
    }

    /// The path with another end: along shortest curves, level, in directions from which the vehicle can stay
    /// at the target. Directions near that of the path come first.
    pub(crate) fn other_ends<'a>(
        &'a self,
        path: &Trajectory,
    ) -> impl Iterator<Item = Trajectory> + use<'a, 'p> {
        let problem = self.problem;
        let places = places_of(path);
        let arrival = level_heading(&path.end_velocity()).unwrap_or_else(Vector3::x);
        let mut headings = self.headings().to_vec();
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
            let ways = ways.filter(|way| has_room(problem, way));
            let ways: Vec<_> = ways.map(|way| [&kept[..before], &way].concat()).collect();
            ways.into_iter()
        });
        whole.filter_map(|points| problem.timed(&points).ok())
    }

    /// The path with another end where the bed falls more steeply to the target than the vehicle can pitch: level
    /// to the place above the target, and down from there on circles that can be kept at the target too.
    fn descents(&self, places: Vec<Point3<f64>>) -> impl Iterator<Item = Trajectory> {
        let problem = self.problem;
        let headings = self.headings().iter().copied();
        let ways = headings.flat_map(move |heading| {
            let at = |z: f64| Pose {
                place: Point3::new(problem.target.x, problem.target.y, z),
                direction: heading,
            };
            // Of descents from one depth only those that have room are joined to a path.
            let mut known: (f64, Vec<Vec<Point3<f64>>>) = (f64::NAN, Vec::new());
            let mut whole = Vec::new();
            for cut in CUTS {
                let (kept, direction) =
                    leave(problem, &places, cut * problem.vehicle.turn_radius_m);
                let from = Pose {
                    place: kept[kept.len() - 1],
                    direction: direction.unwrap_or(heading),
                };
                let above = at(from.place.z.min(problem.target.z));
                if known.0.to_bits() != above.place.z.to_bits() {
                    let downs = connections(problem.vehicle, above, at(problem.target.z));
                    let has_room = |down: &Vec<_>| has_room(problem, down);
                    known = (
                        above.place.z,
                        downs.into_iter().take(2).filter(has_room).collect(),
                    );
                }
                if known.1.is_empty() {
                    continue;
                }
                let level = connections(problem.vehicle, from, above);
                let level = level.first().map(Vec::as_slice).unwrap_or_default();
                let before = &kept[..kept.len() - 1];
                let downs = known.1.iter();
                whole.extend(
                    downs.map(|down| [before, level, down.get(1..).unwrap_or_default()].concat()),
                );
            }
            whole
        });
        ways.filter_map(|points| problem.timed(&points).ok())
    }
}

/// A course as seen from above, at its least depth, and just below the top of the box.
fn above(problem: &PathProblem<'_>, course: &[Point3<f64>]) -> Vec<Vec<Point3<f64>>> {
    let top_m = problem.bounds.map_or(0.0, |bounds| bounds.low.z) + BELOW_TOP_M;
    let least_m = course.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let levels = [least_m, top_m].into_iter().filter(|&level_m| {
        level_m >= top_m && level_m <= problem.target.z && problem.sea_bed.is_some()
    });
    let level = |level_m: f64| {
        let points = course.iter().map(move |p| Point3::new(p.x, p.y, level_m));
        points.collect()
    };
    levels.map(level).collect()
}

/// Paths along a line to the target, joined farther and farther along it; last those that are longer by a turn.
pub(crate) fn along(problem: &PathProblem<'_>, line: Vec<Point3<f64>>) -> Vec<Trajectory> {
    if problem.start_velocity.is_none() {
        let whole = [vec![problem.start], line].concat();
        return problem.timed(&whole).into_iter().collect();
    }
    let radius_m = problem.vehicle.turn_radius_m;
    let most_m = length_m(&line) + (line[0] - problem.start).norm() + radius_m;
    let places = with_places_at(&line, JOINS_OF_LINES.map(|join| join * radius_m));
    let joined = joined_at(problem, places, &JOINS_OF_LINES);
    let (mut ways, turning): (Vec<Trajectory>, Vec<Trajectory>) =
        joined.partition(|way| length_m(&places_of(way)) <= most_m);
    ways.extend(turning);
    ways
}

fn length_m(places: &[Point3<f64>]) -> f64 {
    places
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm())
        .sum()
}

/// A line with a place at each of these distances along it, in ascending order, where it is straight: a piece of a
/// curve must not be divided, because what is left of it would turn too tightly.
fn with_places_at(
    line: &[Point3<f64>],
    distances_m: impl IntoIterator<Item = f64>,
) -> Vec<Point3<f64>> {
    let mut open = distances_m.into_iter().peekable();
    let (mut places, mut gone_m) = (Vec::from_iter(line.first().copied()), 0.0);
    for pair in line.windows(2) {
        let piece = pair[1] - pair[0];
        let end_m = gone_m + piece.norm();
        while let Some(at_m) = open.next_if(|&at_m| at_m < end_m) {
            if (gone_m + STRAIGHT_M..=end_m - STRAIGHT_M).contains(&at_m) {
                places.push(pair[0] + piece * ((at_m - gone_m) / (end_m - gone_m)));
            }
        }
        places.push(pair[1]);
        gone_m = end_m;
    }
    places
}

/// Paths that arrive at the target as told, the quickest first: all of a path or its end is replaced by shortest
/// curves to where the straight lead begins. A vehicle that is on the lead already goes straight on.
pub(crate) fn arriving(
    problem: &PathProblem<'_>,
    places: &[Point3<f64>],
    arrival: &Arrival,
) -> Vec<Trajectory> {
    let to = |lead_m: f64| Pose {
        place: problem.target - arrival.direction * lead_m,
        direction: arrival.direction,
    };
    let offset = problem.target - problem.start;
    let ahead_m = offset.dot(&arrival.direction);
    let aside_m = (offset - arrival.direction * ahead_m).norm();
    let is_on_lead = ahead_m > 0.0 && aside_m <= ON_LEAD_M && ahead_m <= 2.0 * arrival.lead_m;
    let leads = [arrival.lead_m, 0.0]
        .into_iter()
        .filter(|&lead_m| lead_m > 0.0 || is_on_lead || arrival.lead_m <= 0.0);
    let mut ways: Vec<Trajectory> = Vec::new();
    for lead_m in leads {
        for cut in CUTS {
            let (kept, direction) = leave(problem, places, cut * problem.vehicle.turn_radius_m);
            let place = kept.last().copied().unwrap_or(problem.start);
            let from = direction.map_or(ConnectionStart::Place(place), |direction| {
                ConnectionStart::Pose(Pose { place, direction })
            });
            let end = ConnectionEnd::Pose(to(lead_m));
            let found = connections_between(problem.vehicle, from, end).into_iter();
            ways.extend(found.take(2).filter_map(|found| {
                let before = kept.len().saturating_sub(1);
                let mut points = [&kept[..before], &found.points].concat();
                points.extend((lead_m > 0.0).then_some(problem.target));
                problem.timed(&points).ok()
            }));
        }
    }
    ways.sort_by(|a, b| a.duration_s().total_cmp(&b.duration_s()));
    ways.dedup();
    ways
}

/// The places of a path.
pub(crate) fn places_of(path: &Trajectory) -> Vec<Point3<f64>> {
    path.points().iter().map(|p| p.position).collect()
}

/// The path through places with another start: along shortest curves from the problem's start velocity.
fn other_starts<'p>(
    problem: &'p PathProblem<'_>,
    places: Vec<Point3<f64>>,
) -> impl Iterator<Item = Trajectory> + 'p {
    joined_at(problem, places, &CUTS)
}

/// The same, joined so many turn radii along it.
fn joined_at<'p>(
    problem: &'p PathProblem<'_>,
    places: Vec<Point3<f64>>,
    cuts: &'static [f64],
) -> impl Iterator<Item = Trajectory> + 'p {
    let velocity = problem.start_velocity.filter(|v| v.norm() > 0.0);
    let cuts = velocity
        .into_iter()
        .flat_map(move |velocity| cuts.iter().map(move |&cut| (cut, velocity)));
    let whole = cuts.flat_map(move |(cut, velocity)| {
        let from = Pose {
            place: problem.start,
            direction: velocity,
        };
        let joined = join_or_end(&places, cut * problem.vehicle.turn_radius_m);
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

/// Where a path is joined at least `cut_m` along it. Where it ends before, the whole path is replaced: its end is
/// reached level in its direction, because a guide may end too steeply.
fn join_or_end(places: &[Point3<f64>], cut_m: f64) -> Option<(usize, Vector3<f64>)> {
    let end = || {
        let last = places.len().checked_sub(1)?;
        let piece = places[last] - places[last.checked_sub(1)?];
        Some((last, level_heading(&piece).unwrap_or(piece)))
    };
    join(places, cut_m).or_else(end)
}

/// Whether a piece of a path stays within box and bed.
fn has_room(problem: &PathProblem<'_>, piece: &[Point3<f64>]) -> bool {
    let within = |p: &Point3<f64>| problem.bounds.is_none_or(|bounds| bounds.contains(p));
    let above_bed = |pair: &[Point3<f64>]| {
        let floor = problem.floor();
        floor.is_none_or(|floor| floor.grounding_m(&pair[0], &pair[1]) <= ROUNDING_M)
    };
    piece.iter().all(within) && piece.windows(2).all(above_bed)
}

/// Horizontal directions in which the vehicle can arrive level at the target and go on: of sixteen, and
/// along the slope of the bed.
pub(crate) fn headings(problem: &PathProblem<'_>) -> Vec<Vector3<f64>> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_gets_places_where_it_may_be_joined() {
        let line = [0.0, 30.0, 100.0].map(|x| Point3::new(x, 0.0, 0.0));
        let places = with_places_at(&line, [20.0, 27.0, 30.0, 40.0, 160.0, f64::INFINITY]);
        let along: Vec<f64> = places.iter().map(|p| p.x).collect();
        assert_eq!(along, [0.0, 20.0, 30.0, 40.0, 100.0]);
    }
}
