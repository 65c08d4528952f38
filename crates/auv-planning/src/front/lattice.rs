//! The places over which a front spreads.

use crate::Deadline;
use crate::motion::Floor;
use auv_types::{Bounds, Point3, Vector3};

/// Metres kept above the floor.
const FLOOR_MARGIN_M: f64 = 0.05;
/// A place may lie outside the box by this rounding, metres.
const ROUNDING_M: f64 = 1e-9;

/// Where the nodes of a lattice lie over ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The place of one node.
    pub anchor: Point3<f64>,
    /// Row and column of that node.
    pub anchor_node: [usize; 2],
    /// The horizontal directions of growing rows and columns.
    pub ahead: Vector3<f64>,
    /// See `ahead`.
    pub side: Vector3<f64>,
    /// Distance between nodes over ground, metres.
    pub cell_m: f64,
    /// Rows and columns.
    pub counts: [usize; 2],
}

impl Frame {
    /// The place of a row and column at the depth of the anchor.
    #[must_use]
    pub fn over_ground(&self, row: f64, column: f64) -> Point3<f64> {
        let ahead_m = (row - self.anchor_node[0] as f64) * self.cell_m;
        let side_m = (column - self.anchor_node[1] as f64) * self.cell_m;
        self.anchor + self.ahead * ahead_m + self.side * side_m
    }

    /// Row and column of a place.
    #[must_use]
    pub fn coordinates(&self, place: &Point3<f64>) -> [f64; 2] {
        let way = place - self.anchor;
        [
            self.anchor_node[0] as f64 + way.dot(&self.ahead) / self.cell_m,
            self.anchor_node[1] as f64 + way.dot(&self.side) / self.cell_m,
        ]
    }
}

/// The depths of a lattice's nodes, metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Depths {
    /// Several levels. A node below the floor is none.
    Levels(Vec<f64>),
    /// One level, with a depth for each row. A node below the floor is raised.
    ByRow(Vec<f64>),
}

impl Depths {
    fn levels(&self) -> usize {
        match self {
            Self::Levels(levels_m) => levels_m.len(),
            Self::ByRow(_) => 1,
        }
    }
}

/// Rows, columns and levels of places in the box and above the floor.
#[derive(Clone, Debug)]
pub struct Lattice {
    counts: [usize; 3],
    places: Vec<Option<Point3<f64>>>,
    /// Deepest allowed at half-cells; empty without a floor.
    deepest_m: Vec<f32>,
    /// The shallowest to which a way may be raised on its way; `None` where nothing is raised.
    raised_to_m: Option<f64>,
}

impl Lattice {
    /// The places of a frame within a box and above a floor. `None` when the deadline passes first.
    #[must_use]
    pub fn new(
        frame: &Frame,
        depths: &Depths,
        bounds: Option<&Bounds>,
        floor: Option<Floor<'_>>,
        deadline: Deadline<'_>,
    ) -> Option<Self> {
        let [rows, columns] = frame.counts;
        let top_m = bounds.map_or(0.0, |bounds| bounds.low.z);
        let mut lattice = Self {
            counts: [rows, columns, depths.levels()],
            places: Vec::new(),
            deepest_m: Vec::new(),
            raised_to_m: matches!(depths, Depths::ByRow(_)).then_some(top_m),
        };
        if let Some(floor) = floor {
            lattice.look_up_floor(frame, &floor, deadline)?;
        }
        lattice.places.reserve(rows * columns * depths.levels());
        for row in 0..rows {
            if deadline.passed() {
                return None;
            }
            for column in 0..columns {
                let place = frame.over_ground(row as f64, column as f64);
                let deepest_m = lattice.deepest_at([2 * row, 2 * column]);
                let levels = 0..depths.levels();
                lattice.places.extend(levels.map(|level| {
                    let z = match depths {
                        Depths::Levels(levels_m) => {
                            Some(levels_m[level]).filter(|&z| z <= deepest_m)
                        }
                        Depths::ByRow(rows_m) => {
                            (deepest_m >= top_m).then(|| rows_m[row].min(deepest_m))
                        }
                    };
                    let place = Point3::new(place.x, place.y, z?);
                    let outside = |b: &Bounds| b.excess_m(&place) > ROUNDING_M;
                    (!bounds.is_some_and(outside)).then_some(place)
                }));
            }
        }
        Some(lattice)
    }

    /// `None` when the deadline passes first.
    fn look_up_floor(
        &mut self,
        frame: &Frame,
        floor: &Floor<'_>,
        deadline: Deadline<'_>,
    ) -> Option<()> {
        let [rows, columns] = frame.counts;
        for row in 0..2 * rows - 1 {
            if deadline.passed() {
                return None;
            }
            for column in 0..2 * columns - 1 {
                let place = frame.over_ground(0.5 * row as f64, 0.5 * column as f64);
                let deepest_m = floor.deepest_at(place.x, place.y) - FLOOR_MARGIN_M;
                self.deepest_m.push(deepest_m as f32);
            }
        }
        Some(())
    }

    /// Moves a node to a place near it, whatever lies there.
    pub fn pin(&mut self, node: usize, place: Point3<f64>) {
        self.places[node] = Some(place);
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.places.len()
    }

    /// Rows, columns and levels.
    #[must_use]
    pub fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// Index of a node.
    #[must_use]
    pub fn index(&self, [row, column, level]: [usize; 3]) -> usize {
        (row * self.counts[1] + column) * self.counts[2] + level
    }

    /// Row, column and level of a node.
    #[must_use]
    pub fn node(&self, index: usize) -> [usize; 3] {
        let [_, columns, levels] = self.counts;
        let over_ground = index / levels;
        [over_ground / columns, over_ground % columns, index % levels]
    }

    /// Where a node lies; `None` outside the box and below the floor.
    #[must_use]
    pub fn place(&self, index: usize) -> Option<Point3<f64>> {
        self.places[index]
    }

    /// Deepest allowed at a half-cell, metres.
    fn deepest_at(&self, [row, column]: [usize; 2]) -> f64 {
        let columns = 2 * self.counts[1] - 1;
        let deepest_m = self.deepest_m.get(row * columns + column);
        deepest_m.map_or(f64::INFINITY, |&m| f64::from(m))
    }

    /// Whether the straight way between two nodes at these depths stays above the floor at every
    /// half-cell.
    #[must_use]
    pub fn is_clear(&self, from: (usize, f64), to: (usize, f64)) -> bool {
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
            let least_m = self.raised_to_m.map_or(depth_m, |top_m| depth_m.min(top_m));
            least_m <= self.deepest_at([between(0), between(1)])
        })
    }
}
