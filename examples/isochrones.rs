//! Lines of equal earliest arrival on the map of a scene.

use auv_planning::Deadline;
use auv_planning::PathProblem;
use auv_planning::front::{Depths, Frame, Front, Lattice, Spread, Stencil, Tide};
use auv_types::{Point3, Vector3, libm};

/// Nodes along the longer side of the map, and cells that a step of the front spans.
const NODES: f64 = 90.0;
const REACH: isize = 4;
/// Times at which the current is tabulated, and the time between them as a share of the flight.
const TIMES: usize = 25;
const STEP: f64 = 0.1;
/// About so many lines to the target.
const LINES: f64 = 10.0;

/// Two ends of a piece of a line, each north and east in metres.
pub(crate) type Piece = [(f64, f64); 2];

/// Pieces of lines of equal arrival within a map, and the time between lines in seconds. Moving obstacles are
/// not considered. Empty where no front spreads.
pub(crate) fn isochrones(
    problem: &PathProblem<'_>,
    duration_s: f64,
    (low, high): (Point3<f64>, Point3<f64>),
) -> (Vec<Piece>, f64) {
    let apart_s = round(duration_s / LINES);
    let pieces = arrivals(problem, duration_s, (low, high))
        .map_or_else(Vec::new, |(frame, times_s)| {
            lines(&frame, &times_s, apart_s)
        });
    (pieces, apart_s)
}

/// The nearest of 1, 2 and 5 times a power of ten that is not greater.
fn round(seconds: f64) -> f64 {
    let power = libm::pow(10.0, libm::log10(seconds.max(1e-3)).floor());
    let steps = [5.0, 2.0, 1.0].map(|step| step * power);
    steps
        .into_iter()
        .find(|&step| step <= seconds)
        .unwrap_or(power)
}

/// Seconds from the departure to each node of a lattice over the map.
fn arrivals(
    problem: &PathProblem<'_>,
    duration_s: f64,
    (low, high): (Point3<f64>, Point3<f64>),
) -> Option<(Frame, Vec<f64>)> {
    let size = high - low;
    let cell_m = size.x.max(size.y) / NODES;
    let counts = [size.x, size.y].map(|m| (m / cell_m) as usize + 1);
    let frame = Frame {
        anchor: Point3::new(low.x, low.y, problem.start.z),
        anchor_node: [0, 0],
        ahead: Vector3::x(),
        side: Vector3::y(),
        cell_m,
        counts,
    };
    let deadline = Deadline::default();
    let depths = Depths::ByRow(vec![problem.start.z; counts[0]]);
    let bounds = problem.bounds.as_ref();
    let mut lattice = Lattice::new(&frame, &depths, bounds, problem.floor(), deadline)?;
    let [row, column] = frame
        .coordinates(&problem.start)
        .map(|at| at.round() as usize);
    let from = lattice.index([row.min(counts[0] - 1), column.min(counts[1] - 1), 0]);
    lattice.pin(from, problem.start);
    let times = (problem.departure_s, STEP * duration_s, TIMES);
    let tide = match problem.current {
        Some(field) => Tide::new(field, &lattice, times, deadline)?,
        None => Tide::still(),
    };
    let stencil = Stencil::new(&lattice, REACH);
    let mut front = Front::new(problem.vehicle, &lattice, &tide);
    let spread = Spread {
        from,
        goals: &[],
        departure_s: problem.departure_s,
        latest_s: f64::INFINITY,
        deadline,
    };
    front.spread(&stencil, &spread, |_, _| true);
    let seconds = (0..lattice.nodes()).map(|node| front.time_s(node) - problem.departure_s);
    Some((frame, seconds.collect()))
}

/// Straight pieces of the lines within the triangles of the cells.
fn lines(frame: &Frame, times_s: &[f64], apart_s: f64) -> Vec<Piece> {
    let [rows, columns] = frame.counts;
    let mut pieces = Vec::new();
    for row in 1..rows {
        for column in 1..columns {
            let at = |r: usize, c: usize| {
                let place = frame.over_ground(r as f64, c as f64);
                ((place.x, place.y), times_s[r * columns + c])
            };
            let corners = [
                at(row - 1, column - 1),
                at(row, column - 1),
                at(row, column),
                at(row - 1, column),
            ];
            for triangle in [[0, 1, 2], [0, 2, 3]] {
                pieces.extend(crossing(triangle.map(|k| corners[k]), apart_s));
            }
        }
    }
    pieces
}

/// Where lines cross a triangle of places and times; nothing where a corner is not reached.
fn crossing(corners: [((f64, f64), f64); 3], apart_s: f64) -> Vec<Piece> {
    let times = corners.map(|(_, time_s)| time_s);
    if times.iter().any(|time_s| !time_s.is_finite()) {
        return Vec::new();
    }
    let least_s = times.iter().copied().fold(f64::INFINITY, f64::min);
    let most_s = times.iter().copied().fold(0.0, f64::max);
    let (first, last) = (
        (least_s / apart_s).ceil() as usize,
        (most_s / apart_s).floor() as usize,
    );
    let level = |line: usize| {
        let line_s = apart_s * line as f64;
        let ends: Vec<_> = [(0, 1), (1, 2), (2, 0)]
            .into_iter()
            .filter_map(|(i, j)| {
                let ((a, a_s), (b, b_s)) = (corners[i], corners[j]);
                let crosses = (a_s < line_s) != (b_s < line_s);
                let share = (line_s - a_s) / (b_s - a_s);
                crosses.then_some((a.0 + (b.0 - a.0) * share, a.1 + (b.1 - a.1) * share))
            })
            .collect();
        <Piece>::try_from(ends).ok()
    };
    (first.max(1)..=last).filter_map(level).collect()
}
