//! Sea beds on a regular local grid.

use crate::{DepthSigma, MapGrid, SeaBed};
use auv_types::{Violations, libm};

/// A sea bed given by depths at the nodes of a regular grid, bilinear between them.
///
/// Outside the grid is land (depth 0). The outermost nodes count as land too, whatever their charted depth,
/// so that the bed is continuous there. Nodes without a finite depth are land.
///
/// ```
/// use auv_ocean::{GriddedBed, MapGrid, SeaBed};
///
/// let grid = MapGrid { north_m: 0.0, east_m: 0.0, cell_m: 100.0, rows: 4, columns: 4 };
/// let bed = GriddedBed::new(grid, vec![60.0; 16]).expect("as many depths as nodes");
/// assert_eq!(bed.depth_at(150.0, 150.0), 60.0);
/// assert_eq!(bed.depth_at(50.0, 150.0), 30.0);
/// assert_eq!(bed.depth_at(-1.0, 150.0), 0.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GriddedBed {
    grid: MapGrid,
    depths_m: Vec<f64>,
    /// The steepest slope in each cell, `rows - 1` by `columns - 1`.
    slopes: Vec<f64>,
    /// Standard deviation of the depths.
    pub sigma: DepthSigma,
}

impl GriddedBed {
    /// A bed from the depths at a grid's nodes, metres, row-major. Values that are not positive or not finite
    /// are land.
    ///
    /// # Errors
    /// A malformed grid, or a number of depths that differs from the number of nodes.
    pub fn new(grid: MapGrid, mut depths_m: Vec<f64>) -> Result<Self, Violations> {
        let mut violations = grid.validate();
        violations.require(
            violations.is_empty() && depths_m.len() == grid.nodes(),
            "depths",
            || {
                format!(
                    "are {} on {} x {} nodes; give one for each node",
                    depths_m.len(),
                    grid.rows,
                    grid.columns
                )
            },
        );
        violations.into_result()?;
        let (rows, columns) = (grid.rows, grid.columns);
        for (i, depth_m) in depths_m.iter_mut().enumerate() {
            let (row, column) = (i / columns, i % columns);
            let rim = row == 0 || column == 0 || row == rows - 1 || column == columns - 1;
            if !depth_m.is_finite() || rim {
                *depth_m = 0.0;
            }
        }
        let mut slopes = Vec::with_capacity((rows - 1) * (columns - 1));
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                let i = row * columns + column;
                let [a, b, c, d] = [i, i + 1, i + columns, i + columns + 1].map(|k| depths_m[k]);
                // A bilinear cell is steepest at a corner: both derivatives are linear.
                let north = [c - a, d - b];
                let east = [b - a, d - c];
                let square = north
                    .iter()
                    .flat_map(|n| east.iter().map(move |e| n * n + e * e))
                    .fold(0.0, f64::max);
                slopes.push(libm::sqrt(square) / grid.cell_m);
            }
        }
        Ok(Self {
            grid,
            depths_m,
            slopes,
            sigma: DepthSigma::default(),
        })
    }

    /// A sea bed sampled at a grid's nodes: faster to evaluate, but bilinear within each cell.
    ///
    /// # Errors
    /// A malformed grid.
    pub fn sampled(bed: &dyn SeaBed, grid: MapGrid) -> Result<Self, Violations> {
        grid.validate().into_result()?;
        let depths_m = (0..grid.nodes())
            .map(|i| {
                let [north_m, east_m] = grid.place(i / grid.columns, i % grid.columns);
                bed.depth_at(north_m, east_m)
            })
            .collect();
        Self::new(grid, depths_m)
    }

    /// The same bed with another standard deviation of its depths.
    #[must_use]
    pub fn with_sigma(mut self, sigma: DepthSigma) -> Self {
        self.sigma = sigma;
        self
    }

    /// Its grid.
    #[must_use]
    pub fn grid(&self) -> &MapGrid {
        &self.grid
    }

    /// Depths at the nodes, metres, row-major.
    #[must_use]
    pub fn node_depths_m(&self) -> &[f64] {
        &self.depths_m
    }
}

impl SeaBed for GriddedBed {
    fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
        self.grid.cell_at(north_m, east_m).map_or(0.0, |cell| {
            let [a, b, c, d] = cell.weights(self.grid.columns);
            let term = |(node, weight): (usize, f64)| self.depths_m[node] * weight;
            (term(a) + term(b)) + (term(c) + term(d))
        })
    }

    fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
        let span = |centre_m: f64, origin_m: f64, cells: usize| {
            let low = (centre_m - radius_m - origin_m) / self.grid.cell_m;
            let high = (centre_m + radius_m - origin_m) / self.grid.cell_m;
            // Casts saturate. One more cell on either side covers positions on a border.
            let first = (low.floor() as usize).saturating_sub(1).min(cells);
            let last = (high.max(-1.0).floor() + 2.0) as usize;
            first..last.min(cells)
        };
        let columns = self.grid.columns - 1;
        let across = span(east_m, self.grid.east_m, columns);
        span(north_m, self.grid.north_m, self.grid.rows - 1)
            .flat_map(|row| &self.slopes[row * columns..][across.clone()])
            .copied()
            .fold(0.0, f64::max)
    }

    fn depth_sigma_m(&self, north_m: f64, east_m: f64) -> f64 {
        self.sigma.at_depth(self.depth_at(north_m, east_m))
    }

    fn sounding_m(&self, north_m: f64, east_m: f64) -> (f64, f64) {
        let depth_m = self.depth_at(north_m, east_m);
        (depth_m, self.sigma.at_depth(depth_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Seed;
    use auv_types::rand::RngExt;

    fn rough() -> GriddedBed {
        let grid = MapGrid {
            north_m: -200.0,
            east_m: 300.0,
            cell_m: 50.0,
            rows: 13,
            columns: 17,
        };
        let mut random = Seed(4).stream(0);
        let depths_m = (0..grid.nodes())
            .map(|_| random.random_range(-20.0..100.0))
            .collect();
        GriddedBed::new(grid, depths_m).unwrap()
    }

    #[test]
    fn the_slope_bound_holds_between_samples_even_across_the_rim() {
        let bed = rough();
        let mut random = Seed(5).stream(0);
        let mut tightest: f64 = 0.0;
        for _ in 0..2_000 {
            let (n, e) = (
                random.random_range(-300.0..500.0),
                random.random_range(200.0..1_300.0),
            );
            let radius_m = random.random_range(0.1..80.0);
            let bound = bed.max_slope_near(n, e, radius_m);
            for _ in 0..100 {
                let mut draw = || random.random_range(-0.7..0.7) * radius_m;
                let (a, b) = ([n + draw(), e + draw()], [n + draw(), e + draw()]);
                let distance_m = libm::hypot(a[0] - b[0], a[1] - b[1]);
                let step_m = (bed.depth_at(a[0], a[1]) - bed.depth_at(b[0], b[1])).abs();
                assert!(step_m <= bound * distance_m + 1e-9);
                if bound > 0.1 {
                    tightest = tightest.max(step_m / distance_m / bound);
                }
            }
        }
        assert!(tightest > 0.9, "the bound is loose: {tightest}");
    }

    #[test]
    fn batches_equal_single_evaluations() {
        let bed = rough();
        let north: Vec<f64> = (0..100).map(|i| f64::from(i) * 7.3 - 250.0).collect();
        let east: Vec<f64> = (0..100).map(|i| f64::from(i) * 11.1 + 250.0).collect();
        let mut depths = vec![f64::NAN; 100];
        bed.depths_at(&north, &east, &mut depths);
        for i in 0..100 {
            assert_eq!(depths[i], bed.depth_at(north[i], east[i]));
        }
        assert_eq!(bed.depth_at(f64::NAN, 500.0), 0.0);
        assert_eq!(bed.depth_at(1e300, f64::NEG_INFINITY), 0.0);
    }

    #[test]
    fn a_wrong_number_of_depths_is_refused() {
        let grid = *rough().grid();
        assert!(GriddedBed::new(grid, vec![1.0; 5]).is_err());
        let covering = MapGrid::covering([0.0, 0.0], [1e9, f64::NAN], 1.0);
        assert!(GriddedBed::new(covering, Vec::new()).is_err());
    }
}
