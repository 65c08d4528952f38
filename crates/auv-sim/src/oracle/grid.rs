//! The cells round a vehicle, in which an oracle looks for the last place left and for a way out.

use super::SeaInterval;
use auv_obstacles::{Region, TimedPoint};
use auv_planning::Trajectory;
use auv_types::{Bounds, Point3, Vector3};
use std::cell::Cell;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Cells to each side of the middle one, and of the whole.
const REACH: i32 = 80;
const SIDE: usize = 2 * REACH as usize + 1;
/// The middle cell.
const MIDDLE: usize = (SIDE * SIDE + SIDE + 1) * REACH as usize;
/// Lengths of the ways to a cell's neighbours by the axes that differ, thousandths of a cell.
const LENGTHS: [usize; 4] = [0, 1000, 1415, 1733];
/// Half the diagonal of a cell over its side.
const HALF_DIAGONAL: f64 = 0.866_025_403_784_438_7;
/// Rounding counts for the vehicle, metres.
const ROUNDING_M: f64 = 1e-6;

/// Cells round where the vehicle is at the begin, which is the middle of the middle one.
pub(super) struct Grid<'a> {
    intervals: &'a [SeaInterval],
    bounds: Option<Bounds>,
    start: Point3<f64>,
    cell_m: f64,
    /// What never changes, and how far each cell's middle is from it, once asked for.
    fixed: Vec<Region>,
    fixed_m: Vec<Cell<f64>>,
    /// What else is near, by interval.
    others: Vec<Vec<Region>>,
}

/// A cell the vehicle can stay in from a interval on, reached from another.
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

    /// Distance from a cell's middle to what never changes, metres.
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

    /// When the last cell is lost in which the vehicle can possibly be; `None`: never, or it can get
    /// beyond the cells.
    pub(super) fn nowhere_left_s(&self) -> Option<f64> {
        let mut seen = vec![0; SIDE * SIDE * SIDE];
        let mut here = vec![MIDDLE];
        let (mut carried, mut gone_m) = (self.start, 0.0);
        for (k, interval) in self.intervals.iter().enumerate() {
            carried += interval.water * interval.duration_s();
            gone_m += (interval.max_speed_mps + interval.water_differs_mps) * interval.duration_s();
            let slack_m = self.half_diagonal_m() + ROUNDING_M;
            let drift_m = interval.water.norm() * interval.duration_s();
            let mut left = Vec::new();
            here.retain(|&cell| !self.is_shut(cell, k)[0]);
            here.iter().for_each(|&cell| seen[cell] = k + 1);
            let mut next = 0;
            while next < here.len() {
                let cell = here[next];
                next += 1;
                let far_m = (self.middle(cell) - carried).norm() - gone_m - slack_m;
                if far_m <= 0.0 && !self.is_shut(cell, k)[1] {
                    left.push(cell);
                }
                if is_at_edge(cell) {
                    return None;
                }
                for (other, _) in neighbours(cell) {
                    let far_m = (self.middle(other) - carried).norm() - gone_m - slack_m;
                    if far_m <= drift_m && std::mem::replace(&mut seen[other], k + 1) <= k {
                        // In the way is what holds the cell from the begin to the end of the interval.
                        if !self.is_shut(other, k)[2] {
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

    /// Whether the vehicle can be nowhere in a cell at the begin of a interval, at its end, and all the time.
    fn is_shut(&self, cell: usize, k: usize) -> [bool; 3] {
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
        let mut shut = [false; 3];
        for region in &self.others[k] {
            // Held at both ends is held in between: what a region covers is convex in space and time.
            let held = [&from, &to].map(|moment| region.distance_m(moment) < -half_m);
            shut[0] |= held[0];
            shut[1] |= held[1];
            shut[2] |= held[0] && held[1];
        }
        shut
    }

    /// A track through clear cells to the end or beyond the cells.
    pub(super) fn way_out(&self) -> Option<Trajectory> {
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
            // The shortest way first; of a length of 0 are the cells stayed in.
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

    /// Whether a cell is wholly clear for a whole interval.
    fn is_open(&self, cell: usize, k: usize) -> bool {
        let middle = self.middle(cell);
        let half_m = self.half_diagonal_m();
        let clear = |region: &Region| self.intervals[k].clearance_m(region, middle) > half_m;
        self.bounds.is_none_or(|bounds| bounds.contains(&middle))
            && self.fixed_m(cell) > half_m
            && self.others[k].iter().all(clear)
    }

    /// The track that ends with a stay.
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

/// Whether a region is the same all the time.
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

/// Cells from the middle one, by axis.
fn coordinates(cell: usize) -> [i32; 3] {
    [cell / (SIDE * SIDE), cell / SIDE % SIDE, cell % SIDE].map(|i| i as i32 - REACH)
}

/// The 26 cells that touch a cell that is not at the edge, with their [`LENGTHS`].
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
