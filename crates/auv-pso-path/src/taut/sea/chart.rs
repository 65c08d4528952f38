//! The lattice of places over which a front spreads.

use auv_planning::front::{Depths, Frame, Lattice};
use auv_planning::{Deadline, PathProblem};
use auv_types::{Point3, Vector3};

/// How far a lattice reaches behind the start, beyond the target and to the sides, in lengths of the leg.
const REACH: f64 = 0.5;
/// A leg shorter than this over ground has no lattice, metres.
const LEAST_LEG_M: f64 = 1.0;
/// Depth levels of a lattice that extends to the sides too.
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
pub(crate) struct Chart {
    pub(crate) lattice: Lattice,
    pub(crate) start_node: usize,
    pub(crate) target_node: usize,
}

impl Chart {
    /// A lattice with so many cells from a start to the target. `None` where the leg is vertical or has no
    /// room for the extent, or when the deadline passes first.
    pub(crate) fn new(
        problem: &PathProblem<'_>,
        start: Point3<f64>,
        cells: usize,
        extent: Extent,
        deadline: Deadline<'_>,
    ) -> Option<Self> {
        let frame = frame(problem, start, cells, extent)?;
        let leg_m = frame.cell_m * cells as f64;
        let depths = if extent == Extent::Level {
            Depths::ByRow(depths_on_line(problem, &frame, cells))
        } else {
            let levels = if extent == Extent::Upright {
                cells / 2 + 1
            } else {
                LEVELS
            };
            Depths::Levels(levels_m(problem, &start, leg_m, levels)?)
        };
        let bounds = problem.bounds.as_ref();
        let mut lattice = Lattice::new(&frame, &depths, bounds, problem.floor(), deadline)?;
        let [row, column] = frame.anchor_node;
        let start_node = lattice.index([row, column, level_near(&depths, start.z)]);
        let level = level_near(&depths, problem.target.z);
        let target_node = lattice.index([row + cells, column, level]);
        lattice.pin(target_node, problem.target);
        lattice.pin(start_node, start);
        Some(Self {
            lattice,
            start_node,
            target_node,
        })
    }
}

/// Where the nodes lie over ground. `None` where the leg is vertical.
fn frame(
    problem: &PathProblem<'_>,
    start: Point3<f64>,
    cells: usize,
    extent: Extent,
) -> Option<Frame> {
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
    let beyond = before.clamp(cells, cells + most) + 1;
    Some(Frame {
        anchor: start,
        anchor_node: [behind, left],
        ahead,
        side,
        cell_m,
        counts: [behind + beyond, left + 1 + right],
    })
}

/// The depths of the straight line beside the rows.
fn depths_on_line(problem: &PathProblem<'_>, frame: &Frame, cells: usize) -> Vec<f64> {
    let depth_m = |row: usize| {
        let share = (row as f64 - frame.anchor_node[0] as f64) / cells as f64;
        let start_m = frame.anchor.z;
        start_m + (problem.target.z - start_m) * share.clamp(0.0, 1.0)
    };
    (0..frame.counts[0]).map(depth_m).collect()
}

/// The level nearest to a depth.
fn level_near(depths: &Depths, depth_m: f64) -> usize {
    let Depths::Levels(levels_m) = depths else {
        return 0;
    };
    let far = |level: &usize| (levels_m[*level] - depth_m).abs();
    let nearest = (0..levels_m.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
    nearest.unwrap_or(0)
}

/// Depths of levels from the top to the bottom of the box; `None` where it is thin.
fn levels_m(
    problem: &PathProblem<'_>,
    start: &Point3<f64>,
    leg_m: f64,
    levels: usize,
) -> Option<Vec<f64>> {
    let deeper_m = start.z.max(problem.target.z);
    let (low_m, high_m) = problem
        .bounds
        .map_or((0.0, f64::INFINITY), |b| (b.low.z, b.high.z));
    let high_m = high_m.min(deeper_m + DEEPER * leg_m);
    (high_m - low_m >= LEAST_DEPTHS_M).then(|| {
        let step_m = (high_m - low_m) / (levels - 1) as f64;
        (0..levels).map(|k| low_m + step_m * k as f64).collect()
    })
}
