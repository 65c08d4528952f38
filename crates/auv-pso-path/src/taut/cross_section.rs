//! One cross-section of the lattice: a square of cells, and which of them are blocked.

use crate::taut::regions::{GrownRegions, RegionAt};
use auv_planning::PathProblem;
use auv_types::{Point3, Vector3};
use std::ops::Range;

/// Cells to each side of the straight line.
pub(crate) const REACH: usize = 11;
/// Cells across.
pub(crate) const WIDTH: usize = 2 * REACH + 1;
/// What a blocked cell costs, metres: a path through regions is taken only where there is no other.
pub(crate) const BLOCKED: f32 = 1e5;

/// Axes and spacing that the cross-sections of a lattice share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Distance between cross-sections and between cells, metres.
    pub(crate) step_m: f64,
    pub(crate) cell_m: f64,
    pub(crate) ahead: Vector3<f64>,
    /// Along the columns and the rows of a cross-section.
    pub(crate) side: Vector3<f64>,
    pub(crate) down: Vector3<f64>,
}

/// A cross-section.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CrossSection<'a> {
    pub(crate) grid: &'a Grid,
    pub(crate) middle: Point3<f64>,
    /// When the vehicle is taken to be there, seconds.
    pub(crate) time_s: f64,
    /// Cells to each side of the middle that a path can use.
    pub(crate) wide: usize,
}

impl CrossSection<'_> {
    pub(crate) fn place(&self, row: usize, column: usize) -> Point3<f64> {
        let offset = |i: usize| (i as f64 - REACH as f64) * self.grid.cell_m;
        self.middle + self.grid.side * offset(column) + self.grid.down * offset(row)
    }

    /// Rows (and columns) that a path can use.
    pub(crate) fn within(&self) -> Range<usize> {
        REACH - self.wide..REACH + self.wide + 1
    }

    /// Marks the cells that a region covers within half a step, and those outside the box or below
    /// the deepest allowed.
    pub(crate) fn block(
        &self,
        problem: &PathProblem<'_>,
        regions: &GrownRegions,
        blocked: &mut [f32],
    ) {
        blocked.fill(0.0);
        regions.regions_near(&self.middle, |region| {
            if let Some(region) = regions.existing_at(region, self.time_s) {
                self.block_region(&region, blocked);
            }
        });
        let corners_inside = problem.bounds.is_none_or(|bounds| {
            let ends = [0, WIDTH - 1];
            let mut corners = ends
                .iter()
                .flat_map(|&row| ends.map(|column| (row, column)));
            corners.all(|(row, column)| bounds.contains(&self.place(row, column)))
        });
        if !corners_inside || problem.sea_bed.is_some() {
            self.block_outside(problem, blocked);
        }
    }

    /// Marks the cells outside the box or below the deepest allowed.
    fn block_outside(&self, problem: &PathProblem<'_>, blocked: &mut [f32]) {
        for column in self.within() {
            // The cells of a column lie above one another but for the tilt of the cross-section.
            let middle = self.place(REACH, column);
            let deepest_m = problem.deepest_at(middle.x, middle.y);
            for row in self.within() {
                let p = self.place(row, column);
                let outside = problem.bounds.is_some_and(|bounds| !bounds.contains(&p));
                if outside || p.z > deepest_m {
                    blocked[row * WIDTH + column] = BLOCKED;
                }
            }
        }
    }

    /// Marks the cells that one region covers.
    fn block_region(&self, region: &RegionAt, blocked: &mut [f32]) {
        let (grid, radius_m) = (self.grid, region.radius_m);
        let delta = region.centre - self.middle;
        let beyond_m = (delta.dot(&grid.ahead).abs() - 0.5 * grid.step_m).max(0.0);
        let square = radius_m * radius_m - beyond_m * beyond_m;
        if radius_m <= 0.0 || square <= 0.0 {
            return;
        }
        // In cells.
        let (x, y, r) = (
            delta.dot(&grid.side) / grid.cell_m,
            delta.dot(&grid.down) / grid.cell_m,
            square.sqrt() / grid.cell_m,
        );
        let rows = if region.depths_m.is_some() {
            0..WIDTH
        } else {
            cells(y, r)
        };
        for row in rows {
            let v = row as f64 - REACH as f64;
            let half_square = match region.depths_m {
                None => r * r - (v - y) * (v - y),
                Some((top_m, bottom_m)) => {
                    let z = self.middle.z + grid.down.z * v * grid.cell_m;
                    if z > top_m && z < bottom_m {
                        r * r
                    } else {
                        -1.0
                    }
                }
            };
            if half_square >= 0.0 {
                for column in cells(x, half_square.sqrt()) {
                    blocked[row * WIDTH + column] = BLOCKED;
                }
            }
        }
    }
}

/// The cells within `reach` of a place, both in cells from the middle. Rounded by conversion: a
/// call for every row costs more than the row.
fn cells(at: f64, reach: f64) -> Range<usize> {
    let (low, high) = (at - reach + REACH as f64, at + reach + REACH as f64);
    let first = low.clamp(0.0, WIDTH as f64) as i32;
    let first = first + i32::from(f64::from(first) < low);
    let end = (high.clamp(-1.0, WIDTH as f64 - 1.0) + 1.0) as i32;
    first as usize..end as usize
}
