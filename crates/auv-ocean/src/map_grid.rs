//! A regular grid on the map.

use auv_types::Violations;

/// A regular grid on the map. Node (`row`, `column`) lies `row` cells north and `column` cells east of the
/// first node; arrays over the grid are row-major.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct MapGrid {
    /// North of the first node, metres.
    pub north_m: f64,
    /// East of the first node, metres.
    pub east_m: f64,
    /// Distance between neighbouring nodes, metres.
    pub cell_m: f64,
    /// Nodes from south to north, two or more.
    pub rows: usize,
    /// Nodes from west to east, two or more.
    pub columns: usize,
}

/// A cell, by `row` and `column` of its south-western node, and coordinates within it from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    pub(crate) row: usize,
    pub(crate) column: usize,
    pub(crate) up: f64,
    pub(crate) right: f64,
}

impl MapGrid {
    /// Greatest number of nodes.
    pub const MOST_NODES: usize = 50_000_000;

    /// The smallest grid that starts at one corner and reaches the other.
    #[must_use]
    pub fn covering(south_west: [f64; 2], north_east: [f64; 2], cell_m: f64) -> Self {
        let count = |k: usize| {
            let cells = ((north_east[k] - south_west[k]) / cell_m).ceil();
            // The cast saturates; `validate` refuses values that are too large or NaN.
            (cells as usize).saturating_add(1)
        };
        Self {
            north_m: south_west[0],
            east_m: south_west[1],
            cell_m,
            rows: count(0),
            columns: count(1),
        }
    }

    /// Everything malformed about the grid.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let finite = self.north_m.abs() <= 1e7 && self.east_m.abs() <= 1e7;
        violations.require(finite, "grid", || {
            "does not start at a finite position within 10,000 km; give metres".into()
        });
        violations.require_positive(self.cell_m, "grid.cell_m");
        let nodes = self.rows.saturating_mul(self.columns);
        let sound = self.rows >= 2 && self.columns >= 2 && nodes <= Self::MOST_NODES;
        violations.require(sound, "grid", || {
            format!(
                "has {} x {} nodes; give 2 x 2 to {} in all: choose another cell size",
                self.rows,
                self.columns,
                Self::MOST_NODES
            )
        });
        violations
    }

    /// The number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.rows * self.columns
    }

    /// Whether a position (north and east in metres) lies between the first and last nodes.
    #[must_use]
    pub fn contains(&self, [north_m, east_m]: [f64; 2]) -> bool {
        self.cell_at(north_m, east_m).is_some()
    }

    /// North and east of a node, metres.
    #[must_use]
    pub fn place(&self, row: usize, column: usize) -> [f64; 2] {
        [
            self.north_m + row as f64 * self.cell_m,
            self.east_m + column as f64 * self.cell_m,
        ]
    }

    /// The cell a position lies in; `None` outside the grid.
    #[inline]
    pub(crate) fn cell_at(&self, north_m: f64, east_m: f64) -> Option<Cell> {
        let up = (north_m - self.north_m) / self.cell_m;
        let right = (east_m - self.east_m) / self.cell_m;
        let (top, far) = ((self.rows - 1) as f64, (self.columns - 1) as f64);
        if !(up >= 0.0 && up <= top && right >= 0.0 && right <= far) {
            return None;
        }
        let row = (up as usize).min(self.rows - 2);
        let column = (right as usize).min(self.columns - 2);
        Some(Cell {
            row,
            column,
            up: up - row as f64,
            right: right - column as f64,
        })
    }
}

impl Cell {
    /// The four nodes' indices and weights.
    #[inline]
    pub(crate) fn weights(&self, columns: usize) -> [(usize, f64); 4] {
        let first = self.row * columns + self.column;
        let (up, right) = (self.up, self.right);
        [
            (first, (1.0 - up) * (1.0 - right)),
            (first + 1, (1.0 - up) * right),
            (first + columns, up * (1.0 - right)),
            (first + columns + 1, up * right),
        ]
    }
}
