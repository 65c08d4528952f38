//! Whether there was a way out: what a vehicle could have done that knew everything.
//!
//! A [`Sea`] is the truth over a stretch of time, as a simulation left it. [`Sea::escape`] asks from
//! both sides on a grid of cells round the vehicle:
//!
//! - *nowhere left*: every place the vehicle can possibly be is followed, always in its favour. A cell
//!   is shut only while one obstacle holds the whole of it; within a piece of time the vehicle goes as
//!   far as it likes through cells that are not; only never farther from where it began than its
//!   speed through the water takes it. Turn, pitch, least speed and the bed do not bind it. When no
//!   cell is left, nothing that vehicle could have done would have kept it clear;
//! - *a way out*: cells wholly clear for a whole piece of time, from one to the next at the vehicle's
//!   speed. What is found is a track, checked against the truth exactly, of a vehicle that stops and
//!   turns on the spot.
//!
//! ```
//! use auv_obstacles::{Region, TimedPoint};
//! use auv_sim::oracle::{Piece, Sea, Verdict};
//! use auv_types::{Point3, Vector3};
//!
//! // A ball grows over the vehicle faster than it can leave.
//! let growing = Region { growth_mps: 5.0, ..Region::ball(Point3::new(30.0, 0.0, 50.0), 10.0) };
//! let piece = |k: u32| Piece {
//!     from_s: 10.0 * f64::from(k),
//!     until_s: 10.0 * f64::from(k + 1),
//!     place: Point3::new(0.0, 0.0, 50.0),
//!     regions: vec![growing],
//!     water: Vector3::zeros(),
//!     water_differs_mps: 0.0,
//!     max_speed_mps: 3.0,
//! };
//! let sea = Sea { pieces: (0..5).map(piece).collect(), bounds: None };
//! assert!(matches!(sea.escape(0), Verdict::NoEscape { by_s } if by_s <= 30.0));
//! ```

use auv_obstacles::{Region, TimedPoint};
use auv_planning::Trajectory;
use auv_types::{Bounds, Point3, Vector3};
use std::cell::Cell;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Cells to each side of the vehicle, and their sizes in the order tried, metres: 800 m round it
/// coarsely, 200 m finely.
const REACH: i32 = 80;
const SIDE: usize = 2 * REACH as usize + 1;
const CELLS_M: [f64; 3] = [10.0, 5.0, 2.5];
/// Half the diagonal of a cell over its side.
const HALF_DIAGONAL: f64 = 0.866_025_403_784_438_7;
/// Rounding counts for the vehicle, metres.
const ROUNDING_M: f64 = 1e-6;

/// The truth between two moments.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Its begin, mission time in seconds.
    pub from_s: f64,
    /// Its end, seconds.
    pub until_s: f64,
    /// Where the vehicle truly was at its begin.
    pub place: Point3<f64>,
    /// What the obstacles covered.
    pub regions: Vec<Region>,
    /// The current that carries a vehicle, m/s ...
    pub water: Vector3<f64>,
    /// ... and by how much it may differ from that from place to place.
    pub water_differs_mps: f64,
    /// The vehicle's greatest speed through the water, m/s.
    pub max_speed_mps: f64,
}

impl Piece {
    fn duration_s(&self) -> f64 {
        self.until_s - self.from_s
    }

    /// Least distance from a place to a region over the piece.
    fn clearance_m(&self, region: &Region, place: Point3<f64>) -> f64 {
        let (from, to) = self.rest(place);
        region.clearance(&from, &to).clearance_m
    }

    fn rest(&self, place: Point3<f64>) -> (TimedPoint, TimedPoint) {
        (
            TimedPoint::new(place, self.from_s),
            TimedPoint::new(place, self.until_s),
        )
    }
}

/// The sea as it truly was, piece by piece without gaps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sea {
    /// The pieces, the earliest first.
    pub pieces: Vec<Piece>,
    /// The box the vehicle must stay in.
    pub bounds: Option<Bounds>,
}

/// What the oracle says.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Proven: at this time at the latest anything that could have been done had led into an obstacle.
    NoEscape {
        /// Mission time, seconds.
        by_s: f64,
    },
    /// A track that stays clear to the end, or until it is out of the surroundings looked at.
    Escape(Trajectory),
    /// Neither is found on the finest grid.
    Unknown,
}

impl Sea {
    /// Whether there was a way out for the vehicle from the begin of a piece on; [`Verdict::Unknown`]
    /// where there is no such piece.
    ///
    /// # Determinism
    /// Depends on the arguments alone.
    #[must_use]
    pub fn escape(&self, piece: usize) -> Verdict {
        for cell_m in CELLS_M {
            let Some(grid) = self.grid(piece, cell_m) else {
                break;
            };
            if let Some(way) = grid.way_out().filter(|way| self.is_clear(way)) {
                return Verdict::Escape(way);
            }
            if let Some(by_s) = grid.nowhere_left_s() {
                return Verdict::NoEscape { by_s };
            }
        }
        Verdict::Unknown
    }

    fn grid(&self, piece: usize, cell_m: f64) -> Option<Grid<'_>> {
        Grid::new(self.pieces.get(piece..)?, self.bounds, cell_m)
    }

    /// Whether there is a way out through the coarsest cells.
    fn has_way_out(&self, piece: usize) -> bool {
        let way = self.grid(piece, CELLS_M[0]).and_then(|grid| grid.way_out());
        way.is_some_and(|way| self.is_clear(&way))
    }

    /// The latest begin of a piece from which a way out is found on the coarsest grid, on the vehicle's
    /// own track before `until_s`, seconds.
    #[must_use]
    pub fn last_escape_s(&self, until_s: f64) -> Option<f64> {
        // Where a way out is found, one is there from everything before.
        let (mut low, mut high) = (0, self.pieces.partition_point(|p| p.from_s < until_s));
        while low < high {
            let middle = usize::midpoint(low, high);
            if self.has_way_out(middle) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        Some(self.pieces.get(low.checked_sub(1)?)?.from_s)
    }

    /// Whether a track touches nothing, as far as the pieces go.
    #[must_use]
    pub fn is_clear(&self, way: &Trajectory) -> bool {
        let met = |p: &&Piece| p.from_s < way.end().time_s && p.until_s > way.start().time_s;
        self.pieces.iter().filter(met).all(|piece| {
            let part = way.until(piece.until_s).after(piece.from_s);
            let touches = |region: &Region| {
                let mut legs = part.points().windows(2);
                legs.any(|leg| region.clearance(&leg[0], &leg[1]).clearance_m < 0.0)
            };
            !piece.regions.iter().any(touches)
        })
    }
}

/// Cells round where the vehicle is at the begin, which is the middle of the middle one.
struct Grid<'a> {
    pieces: &'a [Piece],
    bounds: Option<Bounds>,
    start: Point3<f64>,
    cell_m: f64,
    /// What never changes, and how far each cell's middle is from it, once asked for.
    fixed: Vec<Region>,
    fixed_m: Vec<Cell<f64>>,
    /// What else is near, by piece.
    others: Vec<Vec<Region>>,
}

/// A cell the vehicle can stay in from a piece on, reached from another.
#[derive(Clone, Copy)]
struct Stay {
    cell: usize,
    piece: usize,
    before: Option<usize>,
}

impl<'a> Grid<'a> {
    fn new(pieces: &'a [Piece], bounds: Option<Bounds>, cell_m: f64) -> Option<Self> {
        let start = pieces.first()?.place;
        let reach_m = f64::from(REACH + 1) * cell_m * 2.0 * HALF_DIAGONAL;
        let near = |piece: &Piece, region: &Region| piece.clearance_m(region, start) < reach_m;
        let (first, mut fixed) = (&pieces[0], pieces[0].regions.clone());
        fixed.retain(|region| near(first, region) && is_fixed(region, pieces));
        let is_other = |region: &Region| !fixed.iter().any(|f| f.obstacle == region.obstacle);
        let others = |piece: &Piece| {
            let mut regions = piece.regions.clone();
            regions.retain(|region| is_other(region) && near(piece, region));
            regions
        };
        Some(Self {
            pieces,
            bounds: bounds.map(|bounds| bounds.grown_to(&start)),
            start,
            cell_m,
            others: pieces.iter().map(others).collect(),
            fixed,
            fixed_m: vec![Cell::new(f64::NAN); SIDE * SIDE * SIDE],
        })
    }

    /// Distance from a cell's middle to what never changes, metres.
    fn fixed_m(&self, cell: usize) -> f64 {
        let known_m = &self.fixed_m[cell];
        if known_m.get().is_nan() {
            let middle = TimedPoint::new(self.middle(cell), self.pieces[0].from_s);
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
    fn nowhere_left_s(&self) -> Option<f64> {
        let mut seen = vec![0; SIDE * SIDE * SIDE];
        let mut here = vec![MIDDLE];
        let (mut carried, mut gone_m) = (self.start, 0.0);
        for (k, piece) in self.pieces.iter().enumerate() {
            carried += piece.water * piece.duration_s();
            gone_m += (piece.max_speed_mps + piece.water_differs_mps) * piece.duration_s();
            let slack_m = self.half_diagonal_m() + ROUNDING_M;
            let drift_m = piece.water.norm() * piece.duration_s();
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
                        // In the way is what holds the cell from the begin to the end of the piece.
                        if !self.is_shut(other, k)[2] {
                            here.push(other);
                        }
                    }
                }
            }
            if left.is_empty() {
                return Some(piece.until_s);
            }
            here = left;
        }
        None
    }

    /// Whether the vehicle can be nowhere in a cell at the begin of a piece, at its end, and all the time.
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
        let (from, to) = self.pieces[k].rest(middle);
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
    fn way_out(&self) -> Option<Trajectory> {
        let mut seen = vec![0; SIDE * SIDE * SIDE];
        let mut stays = vec![Stay {
            cell: MIDDLE,
            piece: 0,
            before: None,
        }];
        let mut here = vec![0];
        for (k, piece) in self.pieces.iter().enumerate() {
            let water_mps = piece.water.norm() + piece.water_differs_mps;
            let reach_m = (piece.max_speed_mps - water_mps) * piece.duration_s();
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
                        piece: k,
                        before: Some(before),
                    });
                }
                here.push(stay);
                if is_at_edge(cell) {
                    return self.track(&stays, stay, piece.until_s);
                }
                for (other, length) in neighbours(cell) {
                    if gone + length <= most && seen[other] <= k {
                        queue.push(Reverse((gone + length, other, stay)));
                    }
                }
            }
        }
        self.track(&stays, *here.first()?, self.pieces.last()?.until_s)
    }

    /// Whether a cell is wholly clear for a whole piece.
    fn is_open(&self, cell: usize, k: usize) -> bool {
        let middle = self.middle(cell);
        let half_m = self.half_diagonal_m();
        let clear = |region: &Region| self.pieces[k].clearance_m(region, middle) > half_m;
        self.bounds.is_none_or(|bounds| bounds.contains(&middle))
            && self.fixed_m(cell) > half_m
            && self.others[k].iter().all(clear)
    }

    /// The track that ends with a stay.
    fn track(&self, stays: &[Stay], last: usize, until_s: f64) -> Option<Trajectory> {
        let chain = std::iter::successors(Some(last), |&stay| stays[stay].before);
        let mut chain: Vec<Stay> = chain.map(|stay| stays[stay]).collect();
        chain.reverse();
        let mut points = vec![TimedPoint::new(self.start, self.pieces[0].from_s)];
        let mut push = |cell: usize, time_s: f64| {
            if points.last().is_none_or(|last| time_s > last.time_s) {
                points.push(TimedPoint::new(self.middle(cell), time_s));
            }
        };
        let mut before = MIDDLE;
        for moves in chain[1..].chunk_by(|a, b| a.piece == b.piece) {
            let piece = &self.pieces[moves[0].piece];
            push(before, piece.from_s);
            let places = moves.iter().map(|stay| self.middle(stay.cell));
            let gone_m = places.scan((self.middle(before), 0.0), |(last, sum_m), place| {
                *sum_m += (place - *last).norm();
                *last = place;
                Some(*sum_m)
            });
            let gone_m: Vec<f64> = gone_m.collect();
            for (stay, so_far_m) in moves.iter().zip(&gone_m) {
                let share = so_far_m / gone_m[gone_m.len() - 1];
                push(stay.cell, piece.from_s + share * piece.duration_s());
                before = stay.cell;
            }
        }
        push(before, until_s);
        Trajectory::new(points).ok()
    }
}

/// Whether a region is the same all the time.
fn is_fixed(region: &Region, pieces: &[Piece]) -> bool {
    pieces.iter().all(|piece| {
        let mut same = piece
            .regions
            .iter()
            .filter(|r| r.obstacle == region.obstacle);
        same.all(|r| {
            let rests = r.velocity_mps == Vector3::zeros() && r.growth_mps.abs() <= 0.0;
            let lasts = r.from_s <= piece.from_s && piece.until_s <= r.until_s;
            let alike = r.centre == region.centre && r.shape == region.shape;
            rests && lasts && alike && (r.radius_m - region.radius_m).abs() <= 0.0
        }) && piece.regions.iter().any(|r| r.obstacle == region.obstacle)
    })
}

/// The middle cell.
const MIDDLE: usize = (SIDE * SIDE + SIDE + 1) * REACH as usize;

/// Cells from the middle one, by axis.
fn coordinates(cell: usize) -> [i32; 3] {
    [cell / (SIDE * SIDE), cell / SIDE % SIDE, cell % SIDE].map(|i| i as i32 - REACH)
}

/// Lengths of the ways to a cell's neighbours by the axes that differ, thousandths of a cell.
const LENGTHS: [usize; 4] = [0, 1000, 1415, 1733];

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

#[cfg(test)]
mod tests {
    use super::*;
    use auv_obstacles::ObstacleId;

    fn sea(pieces: u32, max_speed_mps: f64, water: Vector3<f64>, regions: &[Region]) -> Sea {
        let piece = |k: u32| Piece {
            from_s: 10.0 * f64::from(k),
            until_s: 10.0 * f64::from(k + 1),
            place: Point3::new(0.0, 0.0, 100.0),
            regions: regions.to_vec(),
            water,
            water_differs_mps: 0.0,
            max_speed_mps,
        };
        Sea {
            pieces: (0..pieces).map(piece).collect(),
            bounds: Some(Bounds::new(
                Point3::new(-5e3, -5e3, 0.0),
                Point3::new(5e3, 5e3, 200.0),
            )),
        }
    }

    /// A closed wall of columns 60 m away.
    fn wall() -> Vec<Region> {
        (0..12)
            .map(|k| {
                let (sin, cos) =
                    auv_types::libm::sincos(std::f64::consts::FRAC_PI_6 * f64::from(k));
                Region {
                    obstacle: ObstacleId(k),
                    ..Region::cylinder(
                        Point3::new(100.0 * cos, 100.0 * sin, 100.0),
                        40.0,
                        -50.0,
                        250.0,
                    )
                }
            })
            .collect()
    }

    #[test]
    fn what_comes_through_the_wall_leaves_no_way_out_and_what_turns_back_does() {
        let still = Vector3::zeros();
        let mut regions = wall();
        let mut comes = Region::ball(Point3::new(-400.0, 0.0, 100.0), 250.0);
        comes.obstacle = ObstacleId(50);
        comes.velocity_mps = Vector3::x();
        regions.push(comes);
        // The nearest surface is 150 m away; the last of the pocket, 120 m further, is lost at some
        // 270 s at 1 m/s.
        let Verdict::NoEscape { by_s } = sea(60, 3.0, still, &regions).escape(0) else {
            panic!("a way out");
        };
        assert!((200.0..=290.0).contains(&by_s), "{by_s}");
        // At 200 s there still is room.
        let before = sea(20, 3.0, still, &regions);
        let Verdict::Escape(way) = before.escape(0) else {
            panic!("no way out");
        };
        assert!(before.is_clear(&way) && way.end().time_s >= 200.0);
        let fastest = way
            .segments()
            .map(|(a, b)| (b.position - a.position).norm() / (b.time_s - a.time_s));
        assert!(fastest.fold(0.0, f64::max) <= 3.0 + 1e-9);
        // A vehicle at rest is hit.
        let rest = Trajectory::hover(way.start(), 200.0);
        assert!(!before.is_clear(&rest));
    }

    #[test]
    fn an_open_wall_is_left_and_a_current_carries_into_a_closed_one() {
        let still = Vector3::zeros();
        let open = &wall()[..11];
        assert!(matches!(
            sea(90, 3.0, still, open).escape(0),
            Verdict::Escape(_)
        ));
        // Faster than the vehicle: 0.5 m/s towards the wall at least.
        let fast = Vector3::new(1.5, 0.0, 0.0);
        let Verdict::NoEscape { by_s } = sea(60, 1.0, fast, &wall()).escape(0) else {
            panic!("a way out");
        };
        assert!((120.0..=220.0).contains(&by_s), "{by_s}");
        assert!(matches!(
            sea(90, 3.0, fast, &wall()).escape(0),
            Verdict::Escape(_)
        ));
    }

    #[test]
    fn the_last_way_out_is_found_by_halving() {
        let mut sea = sea(25, 1.0, Vector3::zeros(), &[]);
        // The vehicle goes into a dead end whose mouth is closed at 200 s and which fills up.
        for (k, piece) in sea.pieces.iter_mut().enumerate() {
            piece.place.x = 5.0 * k as f64;
            let mut lid = Region::ball(Point3::new(100.0, 0.0, 100.0), 0.0);
            lid.at_s = 0.0;
            lid.from_s = 200.0;
            lid.radius_m = 150.0;
            piece.regions.push(lid);
        }
        let last_s = sea.last_escape_s(250.0).unwrap();
        // From x = 5 k the surface at -50 is 50 + 5 k metres away, and the time 200 - 10 k seconds.
        assert!((80.0..=105.0).contains(&last_s), "{last_s}");
    }
}
