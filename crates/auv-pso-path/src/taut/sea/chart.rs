//! The lattice of places over which a front spreads.

use auv_planning::{Deadline, PathProblem};
use auv_types::{Point3, Vector3};

/// How far a lattice reaches behind the start, beyond the target and to the sides, in lengths of the leg.
const REACH: f64 = 0.5;
/// Metres kept above the floor.
const FLOOR_MARGIN_M: f64 = 0.05;
/// A leg shorter than this over ground has no lattice, metres.
const LEAST_LEG_M: f64 = 1.0;
/// Depth levels of a lattice that has them.
const LEVELS: usize = 11;
/// A box thinner than this has one level, metres.
const LEAST_DEPTHS_M: f64 = 4.0;
/// How far below the deeper end a lattice reaches where nothing else bounds it, in lengths of the leg.
const DEEPER: f64 = 0.1;

/// The directions in which a lattice extends beside the leg's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    /// To the sides; the depth follows the straight line, shallower over banks.
    Level,
    /// In depth, straight ahead.
    Upright,
    /// To the sides and in depth.
    Space,
}

/// A lattice with the start and the target among its nodes.
#[derive(Clone, Debug)]
pub(crate) struct Chart<'a> {
    problem: &'a PathProblem<'a>,
    start: Point3<f64>,
    ahead: Vector3<f64>,
    side: Vector3<f64>,
    /// Distance between nodes over ground, metres.
    pub(crate) cell_m: f64,
    /// Nodes ahead, to the side and in depth.
    pub(crate) counts: [usize; 3],
    /// Nodes behind and beside the start.
    origin: [usize; 2],
    /// Cells from start to target.
    cells: usize,
    /// Depths of the levels; empty where there is one.
    levels_m: Vec<f64>,
    /// Deepest allowed at half-cells; empty without a floor.
    deepest_m: Vec<f32>,
}

impl<'a> Chart<'a> {
    /// A lattice with so many cells from a start to the target. `None` where the leg is vertical or has no
    /// room for the extent, or when the deadline passes first.
    pub(crate) fn new(
        problem: &'a PathProblem<'a>,
        start: Point3<f64>,
        cells: usize,
        extent: Extent,
        deadline: Deadline<'_>,
    ) -> Option<Self> {
        let over_ground = (problem.target - start).xy();
        let leg_m = over_ground.norm();
        if leg_m < LEAST_LEG_M {
            return None;
        }
        let ahead = Vector3::new(over_ground.x / leg_m, over_ground.y / leg_m, 0.0);
        let side = Vector3::new(-ahead.y, ahead.x, 0.0);
        let cell_m = leg_m / cells as f64;
        let reach = |axis: &Vector3<f64>, sign: f64| {
            let free_m = REACH * leg_m;
            let room_m = problem.bounds.map_or(free_m, |bounds| {
                let corner = |k: usize| {
                    let outward = axis[k] * sign > 0.0;
                    let corner = if outward {
                        bounds.high[k]
                    } else {
                        bounds.low[k]
                    };
                    (corner - start[k]) * axis[k] * sign
                };
                corner(0) + corner(1)
            });
            (room_m.clamp(0.0, free_m + leg_m) / cell_m) as usize
        };
        let most = (REACH * cells as f64) as usize;
        let sides = if extent == Extent::Upright { 0 } else { most };
        let (behind, before) = (reach(&ahead, -1.0).min(most), reach(&ahead, 1.0));
        let (left, right) = (reach(&side, -1.0).min(sides), reach(&side, 1.0).min(sides));
        let levels_m = if extent == Extent::Level {
            Vec::new()
        } else {
            levels_m(problem, &start, leg_m)?
        };
        let beyond = before.clamp(cells, cells + most) + 1;
        let mut chart = Self {
            problem,
            start,
            ahead,
            side,
            cell_m,
            counts: [behind + beyond, left + 1 + right, levels_m.len().max(1)],
            origin: [behind, left],
            cells,
            levels_m,
            deepest_m: Vec::new(),
        };
        chart.look_up_floor(deadline)?;
        Some(chart)
    }

    /// `None` when the deadline passes first.
    fn look_up_floor(&mut self, deadline: Deadline<'_>) -> Option<()> {
        let Some(floor) = self.problem.floor() else {
            return Some(());
        };
        let [rows, columns, _] = self.counts;
        for row in 0..2 * rows - 1 {
            if deadline.passed() {
                return None;
            }
            for column in 0..2 * columns - 1 {
                let place = self.over_ground(0.5 * row as f64, 0.5 * column as f64);
                let deepest_m = floor.deepest_at(place.x, place.y) - FLOOR_MARGIN_M;
                self.deepest_m.push(deepest_m as f32);
            }
        }
        Some(())
    }

    pub(crate) fn nodes(&self) -> usize {
        self.counts.iter().product()
    }

    /// Index of a node.
    pub(crate) fn index(&self, [row, column, level]: [usize; 3]) -> usize {
        (row * self.counts[1] + column) * self.counts[2] + level
    }

    /// Row, column and level of a node.
    pub(crate) fn node(&self, index: usize) -> [usize; 3] {
        let [_, columns, levels] = self.counts;
        let over_ground = index / levels;
        [over_ground / columns, over_ground % columns, index % levels]
    }

    pub(crate) fn start_node(&self) -> usize {
        let level = self.level_near(self.start.z);
        self.index([self.origin[0], self.origin[1], level])
    }

    pub(crate) fn target_node(&self) -> usize {
        let level = self.level_near(self.problem.target.z);
        self.index([self.origin[0] + self.cells, self.origin[1], level])
    }

    fn level_near(&self, depth_m: f64) -> usize {
        let far = |level: &usize| (self.levels_m[*level] - depth_m).abs();
        let nearest = (0..self.levels_m.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
        nearest.unwrap_or(0)
    }

    fn over_ground(&self, row: f64, column: f64) -> Point3<f64> {
        let ahead_m = (row - self.origin[0] as f64) * self.cell_m;
        let side_m = (column - self.origin[1] as f64) * self.cell_m;
        self.start + self.ahead * ahead_m + self.side * side_m
    }

    /// Where a node lies; `None` outside the box and below the floor.
    pub(crate) fn place(&self, index: usize) -> Option<Point3<f64>> {
        if index == self.start_node() {
            return Some(self.start);
        }
        if index == self.target_node() {
            return Some(self.problem.target);
        }
        let [row, column, level] = self.node(index);
        let mut place = self.over_ground(row as f64, column as f64);
        place.z = match self.levels_m.get(level) {
            Some(&depth_m) => depth_m,
            None => self.depth_on_line(row),
        };
        let deepest_m = self.deepest_at([2 * row, 2 * column]);
        let top_m = self.problem.bounds.map_or(0.0, |bounds| bounds.low.z);
        if place.z > deepest_m {
            if !self.levels_m.is_empty() || deepest_m < top_m {
                return None;
            }
            place.z = deepest_m;
        }
        let outside = |bounds: auv_types::Bounds| bounds.excess_m(&place) > 1e-9;
        (!self.problem.bounds.is_some_and(outside)).then_some(place)
    }

    /// The depth of the straight line beside a row.
    fn depth_on_line(&self, row: usize) -> f64 {
        let share = (row as f64 - self.origin[0] as f64) / self.cells as f64;
        self.start.z + (self.problem.target.z - self.start.z) * share.clamp(0.0, 1.0)
    }

    /// Deepest allowed at a half-cell, metres.
    fn deepest_at(&self, [row, column]: [usize; 2]) -> f64 {
        let columns = 2 * self.counts[1] - 1;
        let deepest_m = self.deepest_m.get(row * columns + column);
        deepest_m.map_or(f64::INFINITY, |&m| f64::from(m))
    }

    /// Whether the straight way between two nodes stays above the floor at every half-cell.
    pub(crate) fn is_clear(&self, from: (usize, f64), to: (usize, f64)) -> bool {
        if self.deepest_m.is_empty() {
            return true;
        }
        let (a, b) = (self.node(from.0), self.node(to.0));
        let steps = 2 * a[0].abs_diff(b[0]).max(a[1].abs_diff(b[1]));
        (1..steps).all(|k| {
            let (k, steps) = (k as i64, steps as i64);
            // The nearest half-cell, in whole numbers.
            let between = |axis: usize| {
                let (a, b) = (2 * a[axis] as i64, 2 * b[axis] as i64);
                ((2 * (a * steps + (b - a) * k) + steps) / (2 * steps)) as usize
            };
            let depth_m = from.1 + (to.1 - from.1) * (k as f64 / steps as f64);
            // Where the depth follows the floor it may be raised on the way too.
            let raised = self.levels_m.is_empty();
            let top_m = self.problem.bounds.map_or(0.0, |bounds| bounds.low.z);
            let least_m = if raised { depth_m.min(top_m) } else { depth_m };
            least_m <= self.deepest_at([between(0), between(1)])
        })
    }
}

/// Depths of levels from the top to the bottom of the box; `None` where it is thin.
fn levels_m(problem: &PathProblem<'_>, start: &Point3<f64>, leg_m: f64) -> Option<Vec<f64>> {
    let deeper_m = start.z.max(problem.target.z);
    let (low_m, high_m) = problem
        .bounds
        .map_or((0.0, f64::INFINITY), |b| (b.low.z, b.high.z));
    let high_m = high_m.min(deeper_m + DEEPER * leg_m);
    (high_m - low_m >= LEAST_DEPTHS_M).then(|| {
        let step_m = (high_m - low_m) / (LEVELS - 1) as f64;
        (0..LEVELS).map(|k| low_m + step_m * k as f64).collect()
    })
}
