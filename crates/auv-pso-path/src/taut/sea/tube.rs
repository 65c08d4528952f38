//! Pulls a polyline tight in the metric of travel time: dynamic programming over small moves of all its
//! vertices at once, in a tube round it that becomes ever thinner.

use crate::taut::sea::water::Water;
use auv_obstacles::TimedPoint;
use auv_planning::Deadline;
use auv_types::{Point3, Vector3};

/// Seconds that a metre of shortfall counts as: more than any detour saves.
const PENALTY_S: f64 = 1_000.0;
/// Places that a vertex may move to in a sweep, and their offsets in widths.
const PLACES: usize = 3;
const OFFSETS: [f64; PLACES] = [0.0, -1.0, 1.0];
/// A sweep that gains less than this share of the flight is followed by one in a thinner tube.
const LEAST_GAIN: f64 = 2e-6;
/// Most sweeps with one width.
const MOST_SWEEPS: usize = 8;
/// The widths of a tube follow each other by this factor.
const THINNER: f64 = 0.5;
/// Vertices between two looks at the deadline.
const BETWEEN_LOOKS: usize = 8;

/// How far and how finely a polyline is pulled tight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull<'a> {
    /// Distance between vertices, metres.
    pub(crate) spacing_m: f64,
    /// First and last moves of a vertex, metres: to the side, and in depth (0: depths stay).
    pub(crate) widths_m: [f64; 2],
    pub(crate) least_m: f64,
    /// Units of work after which it ends.
    pub(crate) work: u64,
    pub(crate) deadline: Deadline<'a>,
}

/// The direction in which vertices move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Moves {
    Side,
    Depth,
}

/// The best way to reach a place of a vertex.
#[derive(Clone, Copy, Debug)]
struct Label {
    cost: f64,
    time_s: f64,
    place: Point3<f64>,
    before: usize,
}

/// A polyline in its tube.
#[derive(Debug)]
pub(crate) struct Tube<'a> {
    water: Water<'a>,
    departure_s: f64,
    points: Vec<Point3<f64>>,
    /// The depths that the vertices would have without a floor, metres.
    depths_m: Vec<f64>,
    labels: Vec<[Label; PLACES]>,
    cost: f64,
    /// Units of work so far.
    pub(crate) work: u64,
}

impl<'a> Tube<'a> {
    /// A polyline that is left at `departure_s`.
    pub(crate) fn new(water: Water<'a>, polyline: &[Point3<f64>], departure_s: f64) -> Self {
        Self {
            water,
            departure_s,
            points: polyline.to_vec(),
            depths_m: Vec::new(),
            labels: Vec::new(),
            cost: f64::INFINITY,
            work: 0,
        }
    }

    pub(crate) fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Pulls the polyline tight. Returns false when the deadline or the work ended it early.
    pub(crate) fn tighten(&mut self, pull: &Pull<'_>) -> bool {
        self.points = resampled(&self.points, pull.spacing_m);
        self.settle(pull)
    }

    /// Adds vertices where the polyline bends, and pulls it tight again. Returns whether it was finished.
    pub(crate) fn refine(&mut self, most_bend: f64, pull: &Pull<'_>) -> bool {
        self.points = split_where_bent(&self.points, most_bend, pull.spacing_m);
        self.settle(pull)
    }

    /// Pulls the polyline tight with the vertices that it has, in ever thinner tubes. Returns whether it was
    /// finished.
    pub(crate) fn settle(&mut self, pull: &Pull<'_>) -> bool {
        self.depths_m = self.points.iter().map(|p| p.z).collect();
        self.cost = f64::INFINITY;
        let mut widths_m = pull.widths_m;
        while widths_m[0] >= pull.least_m || widths_m[1] >= pull.least_m {
            for (moves, width_m) in [(Moves::Side, widths_m[0]), (Moves::Depth, widths_m[1])] {
                if width_m >= pull.least_m && !self.sweeps(moves, width_m, pull) {
                    return false;
                }
            }
            widths_m = widths_m.map(|width_m| width_m * THINNER);
        }
        true
    }

    /// Sweeps with one width until they gain no more.
    fn sweeps(&mut self, moves: Moves, width_m: f64, pull: &Pull<'_>) -> bool {
        for _ in 0..MOST_SWEEPS {
            let before = self.cost;
            if self.work >= pull.work || !self.sweep(moves, width_m, pull.deadline) {
                return false;
            }
            let flight_s = self.cost.min(1e9);
            if before.is_finite() && before - self.cost <= LEAST_GAIN * flight_s {
                break;
            }
        }
        true
    }

    /// Moves all vertices to where they cost least together. Returns false, and moves none, when the
    /// deadline passes first.
    fn sweep(&mut self, moves: Moves, width_m: f64, deadline: Deadline<'_>) -> bool {
        let last = self.points.len() - 1;
        let start = Label {
            cost: 0.0,
            time_s: self.departure_s,
            place: self.points[0],
            before: 0,
        };
        let unreached = Label {
            cost: f64::INFINITY,
            ..start
        };
        self.labels.clear();
        self.labels.push([start, unreached, unreached]);
        for vertex in 1..=last {
            if vertex % BETWEEN_LOOKS == 0 && deadline.passed() {
                return false;
            }
            let mut row = [unreached; PLACES];
            let places = if vertex == last { 1 } else { PLACES };
            for (k, label) in row.iter_mut().enumerate().take(places) {
                let Some(place) = self.place(vertex, moves, OFFSETS[k] * width_m) else {
                    continue;
                };
                *label = self.reach(vertex - 1, place);
            }
            self.labels.push(row);
        }
        self.adopt(moves, width_m);
        true
    }

    /// Where a vertex is when it is moved; `None` where the box ends first.
    fn place(&self, vertex: usize, moves: Moves, offset_m: f64) -> Option<Point3<f64>> {
        let mut place = self.points[vertex];
        if vertex + 1 == self.points.len() {
            return Some(place);
        }
        if offset_m == 0.0 {
            return Some(place);
        }
        match moves {
            Moves::Side => {
                let ahead = self.points[vertex + 1] - self.points[vertex - 1];
                let side = Vector3::new(-ahead.y, ahead.x, 0.0);
                let side = side.try_normalize(1e-6).unwrap_or_else(Vector3::x);
                place += side * offset_m;
                place.z = self.depths_m[vertex];
            }
            Moves::Depth => place.z = self.depths_m[vertex] + offset_m,
        }
        if let Some(bounds) = &self.water.problem.bounds {
            place = bounds.clamp(&place);
        }
        let raised = self.water.raised(place);
        (raised != self.points[vertex]).then_some(raised)
    }

    /// The best way to a place from the places of the vertex before.
    fn reach(&mut self, from: usize, place: Point3<f64>) -> Label {
        let mut best = Label {
            cost: f64::INFINITY,
            time_s: 0.0,
            place,
            before: 0,
        };
        for (k, label) in self.labels[from].iter().enumerate() {
            if label.cost >= best.cost {
                continue;
            }
            let start = TimedPoint::new(label.place, label.time_s);
            let flown = self.water.fly(&start, &place);
            self.work += flown.work;
            let cost = label.cost + flown.seconds + PENALTY_S * flown.short_m;
            if cost < best.cost {
                best = Label {
                    cost,
                    time_s: label.time_s + flown.seconds,
                    place,
                    before: k,
                };
            }
        }
        best
    }

    /// Takes the cheapest way.
    fn adopt(&mut self, moves: Moves, width_m: f64) {
        let last = self.points.len() - 1;
        self.cost = self.labels[last][0].cost;
        let mut k = self.labels[last][0].before;
        for vertex in (1..last).rev() {
            let label = self.labels[vertex][k];
            if moves == Moves::Depth && k > 0 {
                let moved_m = self.depths_m[vertex] + OFFSETS[k] * width_m;
                let bounds = self.water.problem.bounds;
                self.depths_m[vertex] =
                    bounds.map_or(moved_m, |b| moved_m.clamp(b.low.z, b.high.z));
            }
            self.points[vertex] = label.place;
            k = label.before;
        }
    }
}

/// The polyline with vertices at even distances.
fn resampled(points: &[Point3<f64>], spacing_m: f64) -> Vec<Point3<f64>> {
    let length_m: f64 = points.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
    let count = (length_m / spacing_m).ceil().max(2.0);
    let step_m = length_m / count;
    let mut even = vec![points[0]];
    let mut gone_m = 0.0;
    for pair in points.windows(2) {
        let piece_m = (pair[1] - pair[0]).norm();
        while even.len() < count as usize && even.len() as f64 * step_m <= gone_m + piece_m {
            let share = (even.len() as f64 * step_m - gone_m) / piece_m;
            even.push(pair[0] + (pair[1] - pair[0]) * share);
        }
        gone_m += piece_m;
    }
    even.push(points[points.len() - 1]);
    even
}

/// The polyline with the middles of its segments where it bends by more than `most_bend` radians, unless
/// they are shorter than two spacings.
fn split_where_bent(points: &[Point3<f64>], most_bend: f64, spacing_m: f64) -> Vec<Point3<f64>> {
    let bend = |i: usize| {
        if i == 0 || i + 1 >= points.len() {
            return 0.0;
        }
        let (a, b) = (points[i] - points[i - 1], points[i + 1] - points[i]);
        (a.cross(&b).norm() / (a.norm() * b.norm()).max(1e-12)).min(1.0)
    };
    let mut split = vec![points[0]];
    for i in 1..points.len() {
        let bent = bend(i - 1).max(bend(i)) > most_bend;
        if bent && (points[i] - points[i - 1]).norm() > 2.0 * spacing_m {
            split.push(points[i - 1] + (points[i] - points[i - 1]) * 0.5);
        }
        split.push(points[i]);
    }
    split
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::taut::regions::GrownRegions;
    use crate::taut::sea::water::FloorCheck;
    use auv_ocean::{AnalyticBed, BedFeature, Footprint, SeaBed};
    use auv_planning::{Budget, PathProblem, Run, Vehicle};
    use auv_types::Seed;

    /// A zigzag pulled tight in still water, as a polyline.
    fn pulled(problem: &PathProblem<'_>) -> Vec<Point3<f64>> {
        let regions = GrownRegions::new(problem, 0.0, false);
        let run = Run::new(Seed(0), Budget::to_the_cap());
        let water = Water::new(problem, &regions, (0.0, FloorCheck::Sampled), 20.0);
        let aside = Vector3::new(0.0, 120.0, 0.0);
        let corner = problem.start + (problem.target - problem.start) * 0.5 + aside;
        let mut tube = Tube::new(water, &[problem.start, corner, problem.target], 0.0);
        let pull = Pull {
            spacing_m: 25.0,
            widths_m: [20.0, 0.0],
            least_m: 0.05,
            work: u64::MAX,
            deadline: run.deadline(),
        };
        assert!(tube.tighten(&pull));
        tube.points().to_vec()
    }

    fn length_m(points: &[Point3<f64>]) -> f64 {
        points.windows(2).map(|p| (p[1] - p[0]).norm()).sum()
    }

    fn leg(vehicle: &Vehicle) -> PathProblem<'_> {
        let (start, target) = (Point3::new(0.0, 0.0, 20.0), Point3::new(1e3, 0.0, 20.0));
        PathProblem::new(start, target, vehicle)
    }

    #[test]
    fn a_zigzag_becomes_straight_in_open_water() {
        let vehicle = Vehicle::paper();
        let excess_m = length_m(&pulled(&leg(&vehicle))) - 1e3;
        assert!((0.0..0.02).contains(&excess_m), "{excess_m}");
    }

    #[test]
    fn it_lies_along_a_bank_that_is_too_shallow() {
        let vehicle = Vehicle::paper();
        let disc = Footprint::Disc {
            centre: [500.0, 0.0],
            radius_m: 80.0,
        };
        let bed = AnalyticBed::new(60.0).with(BedFeature::new("bank", disc, 0.5, 40.0));
        let problem = PathProblem {
            sea_bed: Some(&bed),
            bounds: Some(auv_types::Bounds::new(
                Point3::new(-100.0, -500.0, 19.0),
                Point3::new(1_100.0, 500.0, 21.0),
            )),
            ..leg(&vehicle)
        };
        let points = pulled(&problem);
        let clear = |p: &Point3<f64>| p.z <= bed.depth_at(p.x, p.y);
        assert!(points.iter().all(clear));
        let farthest_m = points.iter().map(|p| p.y).fold(0.0, f64::max);
        // Somewhere on the slope of the bank.
        assert!((80.0..120.0).contains(&farthest_m), "{farthest_m}");
    }
}
