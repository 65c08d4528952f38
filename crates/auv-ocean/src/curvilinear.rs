//! Resampling of a curvilinear grid of latitudes and longitudes on a regular local grid.

use crate::oddities::odd_cells;
use crate::{LocalFrame, MapGrid};

/// Cells farther from the datum are not laid: on the far side of the Earth a cell is everywhere.
const FARTHEST_M: f64 = 5e6;

/// The cells of a curvilinear grid, projected to a local frame.
#[derive(Debug)]
pub(crate) struct Curvilinear {
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    /// North and east of every node, row-major; NaN without a valid position.
    pub(crate) places: Vec<[f64; 2]>,
    /// Bearing of true north at every node, radians.
    #[cfg_attr(
        not(feature = "netcdf"),
        allow(dead_code, reason = "only model output has velocities to turn")
    )]
    pub(crate) norths: Vec<f64>,
    /// Whether a cell is a hole, `rows - 1` by `columns - 1`; empty without holes.
    pub(crate) holes: Vec<bool>,
}

/// The position of a regular node in the curvilinear grid: four nodes and their weights.
pub(crate) type Stencil = [(usize, f64); 4];

impl Curvilinear {
    pub(crate) fn new(
        frame: &LocalFrame,
        columns: usize,
        latitudes_deg: &[f64],
        longitudes_deg: &[f64],
    ) -> Self {
        let projected: Vec<_> = latitudes_deg
            .iter()
            .zip(longitudes_deg)
            .map(|(&latitude, &longitude)| {
                if latitude.abs() <= 90.0 && longitude.abs() <= 360.0 {
                    frame.project(latitude, longitude)
                } else {
                    (f64::NAN, f64::NAN, f64::NAN)
                }
            })
            .collect();
        Self {
            rows: projected.len() / columns,
            columns,
            places: projected.iter().map(|p| [p.0, p.1]).collect(),
            norths: projected.iter().map(|p| p.2).collect(),
            holes: odd_cells(columns, latitudes_deg, longitudes_deg).holes,
        }
    }

    /// South-western and north-eastern corner of the box around all nodes.
    pub(crate) fn extent(&self) -> ([f64; 2], [f64; 2]) {
        let fold = |k: usize, start: f64, pick: fn(f64, f64) -> f64| {
            self.places.iter().map(|p| p[k]).fold(start, pick)
        };
        (
            [0, 1].map(|k| fold(k, f64::INFINITY, f64::min)),
            [0, 1].map(|k| fold(k, f64::NEG_INFINITY, f64::max)),
        )
    }

    /// The curvilinear cell that each node of a regular grid lies in, and how many nodes lie in several
    /// cells: the smallest counts. Each cell visits the nodes in its bounding box, so the effort is linear in
    /// the nodes of both grids and no search can fail.
    pub(crate) fn stencils(&self, grid: &MapGrid) -> (Vec<Option<Stencil>>, usize) {
        let mut laid = Laid {
            grid,
            stencils: vec![None; grid.nodes()],
            areas_m2: vec![f64::INFINITY; grid.nodes()],
            overlaps: 0,
        };
        for row in 0..self.rows.saturating_sub(1) {
            for column in 0..self.columns.saturating_sub(1) {
                if self.holes.get(row * (self.columns - 1) + column) == Some(&true) {
                    continue;
                }
                let first = row * self.columns + column;
                let nodes = [
                    first,
                    first + 1,
                    first + self.columns,
                    first + self.columns + 1,
                ];
                let corners = nodes.map(|node| self.places[node]);
                // Not finite is not near.
                if corners.iter().flatten().all(|x| x.abs() <= FARTHEST_M) {
                    laid.lay(nodes, corners);
                }
            }
        }
        (laid.stencils, laid.overlaps)
    }
}

/// Cells laid over a regular grid.
struct Laid<'a> {
    grid: &'a MapGrid,
    stencils: Vec<Option<Stencil>>,
    /// Area of the cell of each stencil.
    areas_m2: Vec<f64>,
    overlaps: usize,
}

impl Laid<'_> {
    fn lay(&mut self, nodes: [usize; 4], corners: [[f64; 2]; 4]) {
        let grid = self.grid;
        let area_m2 = area_m2(corners);
        for row in range(&corners, 0, grid.north_m, grid.cell_m, grid.rows) {
            for column in range(&corners, 1, grid.east_m, grid.cell_m, grid.columns) {
                let node = row * grid.columns + column;
                let taken = self.stencils[node];
                // Neighbours share an edge, where both give the same value. An overlapping cell is another.
                let apart = taken.is_some_and(|cell| !cell.iter().any(|(n, _)| nodes.contains(n)));
                if taken.is_some() && !apart {
                    continue;
                }
                let Some([s, t]) = inverse_bilinear(grid.place(row, column), corners) else {
                    continue;
                };
                self.overlaps += usize::from(apart);
                if taken.is_none() || area_m2 < self.areas_m2[node] {
                    let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t];
                    self.stencils[node] = Some([0, 1, 2, 3].map(|k| (nodes[k], weights[k])));
                    self.areas_m2[node] = area_m2;
                }
            }
        }
    }
}

/// The rows or columns of a regular grid within a cell's box.
fn range(
    corners: &[[f64; 2]; 4],
    k: usize,
    origin_m: f64,
    cell_m: f64,
    count: usize,
) -> std::ops::Range<usize> {
    let low = corners.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min);
    let high = corners
        .iter()
        .map(|c| c[k])
        .fold(f64::NEG_INFINITY, f64::max);
    let index = |x: f64| (x - origin_m) / cell_m;
    // Casts saturate at both ends.
    (index(low).ceil() as usize)..((index(high).floor() + 1.0).max(0.0) as usize).min(count)
}

fn area_m2([a, b, c, d]: [[f64; 2]; 4]) -> f64 {
    // Half the cross product of the diagonals.
    0.5 * ((d[0] - a[0]) * (c[1] - b[1]) - (d[1] - a[1]) * (c[0] - b[0])).abs()
}

/// The coordinates of a point within a cell with `corners` at (0,0), (1,0), (0,1), (1,1), by Newton's
/// method from the centre. `None` outside the cell or in a degenerate one.
fn inverse_bilinear(place: [f64; 2], corners: [[f64; 2]; 4]) -> Option<[f64; 2]> {
    const SLACK: f64 = 1e-9;
    let [a, b, c, d] = corners;
    let (mut s, mut t) = (0.5, 0.5);
    for _ in 0..12 {
        let axis = |k: usize| {
            let twist = a[k] - b[k] - c[k] + d[k];
            let value = a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]) + s * t * twist;
            (
                place[k] - value,
                b[k] - a[k] + t * twist,
                c[k] - a[k] + s * twist,
            )
        };
        let ((miss_n, along_n, across_n), (miss_e, along_e, across_e)) = (axis(0), axis(1));
        let determinant = along_n * across_e - along_e * across_n;
        let step_s = (miss_n * across_e - miss_e * across_n) / determinant;
        let step_t = (along_n * miss_e - along_e * miss_n) / determinant;
        if !(step_s.is_finite() && step_t.is_finite()) {
            return None;
        }
        s += step_s;
        t += step_t;
        if step_s.abs() + step_t.abs() < 1e-12 {
            break;
        }
    }
    let inside = |x: f64| (-SLACK..=1.0 + SLACK).contains(&x);
    (inside(s) && inside(t)).then(|| [s.clamp(0.0, 1.0), t.clamp(0.0, 1.0)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Geodetic;

    #[test]
    fn every_node_within_a_rotated_grid_is_located() {
        // A grid rotated by 40 degrees and sheared.
        let (rows, columns) = (30, 20);
        let places: Vec<[f64; 2]> = (0..rows * columns)
            .map(|i| {
                let (r, c) = ((i / columns) as f64, (i % columns) as f64);
                [
                    100.0 * r * 0.766 - 90.0 * c * 0.643 + 0.05 * r * c,
                    100.0 * r * 0.643 + 90.0 * c * 0.766,
                ]
            })
            .collect();
        let turned = Curvilinear {
            rows,
            columns,
            norths: vec![0.0; places.len()],
            holes: Vec::new(),
            places,
        };
        let (low, high) = turned.extent();
        let grid = MapGrid::covering(low, high, 37.0);
        let stencils = turned.stencils(&grid).0;
        let mut found = 0;
        for (i, stencil) in stencils.iter().enumerate() {
            if let Some(stencil) = stencil {
                found += 1;
                let here = grid.place(i / grid.columns, i % grid.columns);
                for (k, here_m) in here.iter().enumerate() {
                    let value_m: f64 = stencil.iter().map(|(n, w)| turned.places[*n][k] * w).sum();
                    assert!((value_m - here_m).abs() < 1e-6);
                }
            }
        }
        // No node inside may be missed: the count is compared with the area.
        let area = found as f64 * 37.0 * 37.0;
        let expected = 29.0 * 19.0 * 100.0 * 90.0;
        assert!((area / expected - 1.0).abs() < 0.03, "{area} {expected}");
    }

    #[test]
    fn nodes_without_a_position_leave_a_hole() {
        let frame = LocalFrame::new(Geodetic::default()).unwrap();
        let latitudes = [0.0, 0.0, 0.0, 0.01, f64::NAN, 0.01, 0.02, 0.02, 0.02];
        let longitudes = [0.0, 0.01, 0.02, 0.0, 0.01, 0.02, 0.0, 0.01, 0.02];
        let holed = Curvilinear::new(&frame, 3, &latitudes, &longitudes);
        let grid = MapGrid::covering([0.0, 0.0], [2_000.0, 2_000.0], 100.0);
        assert!(holed.stencils(&grid).0.iter().all(Option::is_none));
    }
}
