//! The grid of cells around the vehicle, on which the oracle searches.

use super::interval::SeaInterval;
use auv_obstacles::{Region, TimedPoint};
use auv_planning::Trajectory;
use auv_types::{Bounds, Point3, Vector3};
use std::cell::Cell;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Number of cells on each side of the middle cell.
const REACH: i32 = 80;
/// Number of cells along each axis.
const SIDE: usize = 2 * REACH as usize + 1;
/// The middle cell.
const MIDDLE: usize = (SIDE * SIDE + SIDE + 1) * REACH as usize;
/// Distances to a cell's neighbours by the number of axes that differ, thousandths of a cell, rounded up.
const LENGTHS: [usize; 4] = [0, 1000, 1415, 1733];
/// Half the diagonal of a cell over its side.
const HALF_DIAGONAL: f64 = 0.866_025_403_784_438_7;
/// Allowance for rounding, in favour of the vehicle, metres.
const ROUNDING_M: f64 = 1e-6;

/// Cells around the vehicle's position at the start, the centre of the middle cell.
pub(super) struct Grid<'a> {
    intervals: &'a [SeaInterval],
    bounds: Option<Bounds>,
    start: Point3<f64>,
    cell_m: f64,
    /// Obstacles that never change, and each cell's distance from them once computed (NaN before).
    fixed: Vec<Region>,
    fixed_m: Vec<Cell<f64>>,
    /// All other obstacles nearby, by interval.
    others: Vec<Vec<Region>>,
}

/// A cell the vehicle can stay in during an interval, and the stay it comes from.
#[derive(Clone, Copy)]
struct Stay {
    cell: usize,
    interval: usize,
    before: Option<usize>,
}

impl<'a> Grid<'a> {
    pub(super) fn new(
        intervals: &'a [SeaInterval],
        bounds: Option<Bounds>,
        cell_m: f64,
    ) -> Option<Self> {
        let start = intervals.first()?.place;
        let reach_m = f64::from(REACH + 1) * cell_m * 2.0 * HALF_DIAGONAL;
        let near =
            |interval: &SeaInterval, region: &Region| interval.clearance_m(region, start) < reach_m;
        let (first, mut fixed) = (&intervals[0], intervals[0].regions.clone());
        fixed.retain(|region| near(first, region) && is_fixed(region, intervals));
        let is_other = |region: &Region| !fixed.iter().any(|f| f.obstacle == region.obstacle);
        let others = |interval: &SeaInterval| {
            let mut regions = interval.regions.clone();
            regions.retain(|region| is_other(region) && near(interval, region));
            regions
        };
        Some(Self {
            intervals,
            bounds: bounds.map(|bounds| bounds.grown_to(&start)),
            start,
            cell_m,
            others: intervals.iter().map(others).collect(),
            fixed,
            fixed_m: vec![Cell::new(f64::NAN); SIDE * SIDE * SIDE],
        })
    }

    /// Distance from a cell's centre to the obstacles that never change, metres.
    fn fixed_m(&self, cell: usize) -> f64 {
        let known_m = &self.fixed_m[cell];
        if known_m.get().is_nan() {
            let middle = TimedPoint::new(self.middle(cell), self.intervals[0].from_s);
            let distances_m = self.fixed.iter().map(|region| region.distance_m(&middle));
            known_m.set(distances_m.fold(f64::INFINITY, f64::min));
        }
        known_m.get()
    }

    fn middle(&self, cell: usize) -> Point3<f64> {
        let [x, y, z] = coordinates(cell).map(|i| f64::from(i) * self.cell_m);
        self.start + Vector3::new(x, y, z)
    }

    fn half_diagonal_m(&self) -> f64 {
        HALF_DIAGONAL * self.cell_m
    }

    /// When the last cell that the vehicle can possibly be in is covered, mission time in seconds; `None` if
    /// a cell remains or the vehicle can leave the grid.
    pub(super) fn no_escape_by_s(&self) -> Option<f64> {
        let mut seen = vec![0; SIDE * SIDE * SIDE];
        let mut here = vec![MIDDLE];
        let (mut carried, mut gone_m) = (self.start, 0.0);
        for (k, interval) in self.intervals.iter().enumerate() {
            carried += interval.water * interval.duration_s();
            gone_m += (interval.max_speed_mps + interval.water_differs_mps) * interval.duration_s();
            let slack_m = self.half_diagonal_m() + ROUNDING_M;
            let drift_m = interval.water.norm() * interval.duration_s();
            let mut left = Vec::new();
            here.retain(|&cell| !self.is_closed(cell, k)[0]);
            here.iter().for_each(|&cell| seen[cell] = k + 1);
            let mut next = 0;
            while next < here.len() {
                let cell = here[next];
                next += 1;
                let far_m = (self.middle(cell) - carried).norm() - gone_m - slack_m;
                if far_m <= 0.0 && !self.is_closed(cell, k)[1] {
                    left.push(cell);
                }
                if is_at_edge(cell) {
                    return None;
                }
                for (other, _) in neighbours(cell) {
                    let far_m = (self.middle(other) - carried).norm() - gone_m - slack_m;
                    if far_m <= drift_m && std::mem::replace(&mut seen[other], k + 1) <= k {
                        // Only an obstacle that covers the cell during the whole interval blocks it.
                        if !self.is_closed(other, k)[2] {
                            here.push(other);
                        }
                    }
                }
            }
            if left.is_empty() {
                return Some(interval.until_s);
            }
            here = left;
        }
        None
    }

    /// Whether the vehicle cannot be in a cell at the start of an interval, at its end, and during all of it.
    fn is_closed(&self, cell: usize, k: usize) -> [bool; 3] {
        let middle = self.middle(cell);
        let half_m = self.half_diagonal_m() + ROUNDING_M;
        let outside = self.bounds.is_some_and(|bounds| {
            let excess_m = bounds.excess_m(&middle);
            excess_m > 0.5 * self.cell_m + ROUNDING_M
        });
        if outside || self.fixed_m(cell) < -half_m {
            return [true; 3];
        }
        let (from, to) = self.intervals[k].rest(middle);
        let mut closed = [false; 3];
        for region in &self.others[k] {
            // A cell covered at both ends is covered in between: a region is convex in space and time.
            let covered = [&from, &to].map(|moment| region.distance_m(moment) < -half_m);
            closed[0] |= covered[0];
            closed[1] |= covered[1];
            closed[2] |= covered[0] && covered[1];
        }
        closed
    }

    /// A track through clear cells until the end of the period or the edge of the grid.
    pub(super) fn escape_track(&self) -> Option<Trajectory> {
        let mut seen = vec![0; SIDE * SIDE * SIDE];
        let mut stays = vec![Stay {
            cell: MIDDLE,
            interval: 0,
            before: None,
        }];
        let mut here = vec![0];
        for (k, interval) in self.intervals.iter().enumerate() {
            let water_mps = interval.water.norm() + interval.water_differs_mps;
            let reach_m = (interval.max_speed_mps - water_mps) * interval.duration_s();
            if reach_m < 0.0 {
                return None;
            }
            let most = (reach_m / self.cell_m * LENGTHS[1] as f64).floor() as usize;
            here.retain(|&stay: &usize| self.is_open(stays[stay].cell, k));
            here.iter().for_each(|&stay| seen[stays[stay].cell] = k + 1);
            // Shortest distance first; a distance of 0 means that the vehicle stays in its cell.
            let staying = here
                .drain(..)
                .map(|stay| Reverse((0, stays[stay].cell, stay)));
            let mut queue: BinaryHeap<_> = staying.collect();
            while let Some(Reverse((gone, cell, before))) = queue.pop() {
                let mut stay = before;
                if gone > 0 {
                    let fresh = std::mem::replace(&mut seen[cell], k + 1) <= k;
                    if !fresh || !self.is_open(cell, k) {
                        continue;
                    }
                    stay = stays.len();
                    stays.push(Stay {
                        cell,
                        interval: k,
                        before: Some(before),
                    });
                }
                here.push(stay);
                if is_at_edge(cell) {
                    return self.track(&stays, stay, interval.until_s);
                }
                for (other, length) in neighbours(cell) {
                    if gone + length <= most && seen[other] <= k {
                        queue.push(Reverse((gone + length, other, stay)));
                    }
                }
            }
        }
        self.track(&stays, *here.first()?, self.intervals.last()?.until_s)
    }

    /// Whether all of a cell is clear during a whole interval.
    fn is_open(&self, cell: usize, k: usize) -> bool {
        let middle = self.middle(cell);
        let half_m = self.half_diagonal_m();
        let clear = |region: &Region| self.intervals[k].clearance_m(region, middle) > half_m;
        self.bounds.is_none_or(|bounds| bounds.contains(&middle))
            && self.fixed_m(cell) > half_m
            && self.others[k].iter().all(clear)
    }

    /// The track that leads to a stay.
    fn track(&self, stays: &[Stay], last: usize, until_s: f64) -> Option<Trajectory> {
        let chain = std::iter::successors(Some(last), |&stay| stays[stay].before);
        let mut chain: Vec<Stay> = chain.map(|stay| stays[stay]).collect();
        chain.reverse();
        let mut points = vec![TimedPoint::new(self.start, self.intervals[0].from_s)];
        let mut push = |cell: usize, time_s: f64| {
            if points.last().is_none_or(|last| time_s > last.time_s) {
                points.push(TimedPoint::new(self.middle(cell), time_s));
            }
        };
        let mut before = MIDDLE;
        for moves in chain[1..].chunk_by(|a, b| a.interval == b.interval) {
            let interval = &self.intervals[moves[0].interval];
            push(before, interval.from_s);
            let places = moves.iter().map(|stay| self.middle(stay.cell));
            let gone_m = places.scan((self.middle(before), 0.0), |(last, sum_m), place| {
                *sum_m += (place - *last).norm();
                *last = place;
                Some(*sum_m)
            });
            let gone_m: Vec<f64> = gone_m.collect();
            for (stay, so_far_m) in moves.iter().zip(&gone_m) {
                let share = so_far_m / gone_m[gone_m.len() - 1];
                push(stay.cell, interval.from_s + share * interval.duration_s());
                before = stay.cell;
            }
        }
        push(before, until_s);
        Trajectory::new(points).ok()
    }
}

/// Whether a region is the same during all intervals.
fn is_fixed(region: &Region, intervals: &[SeaInterval]) -> bool {
    intervals.iter().all(|interval| {
        let mut same = interval
            .regions
            .iter()
            .filter(|r| r.obstacle == region.obstacle);
        same.all(|r| {
            let rests = r.velocity_mps == Vector3::zeros() && r.growth_mps.abs() <= 0.0;
            let lasts = r.from_s <= interval.from_s && interval.until_s <= r.until_s;
            let alike = r.centre == region.centre && r.shape == region.shape;
            rests && lasts && alike && (r.radius_m - region.radius_m).abs() <= 0.0
        }) && interval
            .regions
            .iter()
            .any(|r| r.obstacle == region.obstacle)
    })
}

/// The offset of a cell from the middle cell, by axis.
fn coordinates(cell: usize) -> [i32; 3] {
    [cell / (SIDE * SIDE), cell / SIDE % SIDE, cell % SIDE].map(|i| i as i32 - REACH)
}

/// The 26 neighbours of a cell, which must not lie at the edge, with their [`LENGTHS`].
fn neighbours(cell: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..27).filter(|&k| k != 13).map(move |k| {
        let step = [k / 9, k / 3 % 3, k % 3];
        let other = cell + (step[0] * SIDE + step[1]) * SIDE + step[2];
        let differing = step.iter().filter(|&&i| i != 1).count();
        (other - (SIDE * SIDE + SIDE + 1), LENGTHS[differing])
    })
}

fn is_at_edge(cell: usize) -> bool {
    coordinates(cell).iter().any(|i| i.abs() == REACH)
}
