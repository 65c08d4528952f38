//! The current of an ocean model.

use crate::curvilinear::{Curvilinear, Stencil};
use crate::{ChartedDepths, GriddedCurrent, LocalFrame, MapGrid};
use auv_types::{Violations, libm};

/// Depths of a model's layers, deepest first.
#[derive(Clone, Debug)]
#[cfg_attr(
    not(feature = "netcdf"),
    allow(dead_code, reason = "only readers make layers")
)]
pub(crate) enum LayerDepths {
    /// One for each layer.
    Level(Vec<f64>),
    /// One for each layer and point, index `layer * points + point`.
    Point(Vec<f64>),
}

/// The current of an ocean model at its points: true north and east velocities, depths of the layers, times
/// in seconds since 1970.
#[derive(Clone, Debug)]
pub struct ModelCurrents {
    pub(crate) bathymetry: Option<ChartedDepths>,
    pub(crate) columns: usize,
    pub(crate) latitudes_deg: Vec<f64>,
    pub(crate) longitudes_deg: Vec<f64>,
    pub(crate) times_unix_s: Vec<f64>,
    pub(crate) layers: usize,
    pub(crate) layer_depths_m: LayerDepths,
    /// True north and east components, m/s, NaN on land; index `(time * layers + layer) * points + point`.
    pub(crate) velocities_mps: Vec<[f32; 2]>,
}

impl ModelCurrents {
    /// The model's bathymetry, where its layers follow it.
    #[must_use]
    pub fn bathymetry(&self) -> Option<&ChartedDepths> {
        self.bathymetry.as_ref()
    }

    /// The records' times, seconds since 1970-01-01 00:00 UTC, increasing.
    #[must_use]
    pub fn times_unix_s(&self) -> &[f64] {
        &self.times_unix_s
    }

    /// Rows and columns.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        (self.latitudes_deg.len() / self.columns, self.columns)
    }

    /// Latitude and longitude of every point, degrees, row-major.
    pub fn places_deg(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let places = self.latitudes_deg.iter().zip(&self.longitudes_deg);
        places.map(|(&latitude, &longitude)| [latitude, longitude])
    }

    /// The number of layers.
    #[must_use]
    pub fn layers(&self) -> usize {
        self.layers
    }

    /// Depth of a layer (0: deepest) at a point, metres; NaN outside.
    #[must_use]
    pub fn depth_m(&self, layer: usize, point: usize) -> f64 {
        let points = self.latitudes_deg.len();
        let found = match &self.layer_depths_m {
            LayerDepths::Level(depths_m) => depths_m.get(layer),
            LayerDepths::Point(depths_m) => depths_m.get(layer * points + point),
        };
        found.copied().unwrap_or(f64::NAN)
    }

    /// Velocity at a point and layer (0: deepest), m/s true north and east; `None` on land and
    /// outside.
    #[must_use]
    pub fn velocity_mps(
        &self,
        time: usize,
        layer: usize,
        row: usize,
        column: usize,
    ) -> Option<[f32; 2]> {
        let (rows, columns) = self.shape();
        let inside = layer < self.layers && row < rows && column < columns;
        let index = ((time * self.layers + layer) * rows + row) * columns + column;
        let velocity = *self.velocities_mps.get(index).filter(|_| inside)?;
        velocity.iter().all(|x| x.is_finite()).then_some(velocity)
    }

    /// The current in a local frame, on a grid of `cell_m` and at `levels_m` (increasing depths).
    /// Mission time 0 is `start_unix_s`.
    ///
    /// Linear between layers; beyond the first and the last layer with water the nearest one is used. A grid
    /// node is water if more than half of its weight in the model's cell is.
    ///
    /// # Errors
    /// A cell size that gives a grid too large or too small, levels that do not increase, more than 50 million
    /// values.
    pub fn to_current(
        &self,
        frame: &LocalFrame,
        cell_m: f64,
        levels_m: &[f64],
        start_unix_s: f64,
    ) -> Result<GriddedCurrent, Violations> {
        let points = self.latitudes_deg.len();
        let model = Curvilinear::new(
            frame,
            self.columns,
            &self.latitudes_deg,
            &self.longitudes_deg,
        );
        let (south_west, north_east) = model.extent();
        let grid = MapGrid::covering(south_west, north_east, cell_m);
        let mut violations = grid.validate();
        let values = [levels_m.len(), self.times_unix_s.len()]
            .iter()
            .fold(grid.rows.saturating_mul(grid.columns), |n, &k| {
                n.saturating_mul(k)
            });
        violations.require(values <= MapGrid::MOST_NODES, "cell_m", || {
            format!("is {cell_m}: the current would have {values} values; give larger cells or fewer levels")
        });
        violations.into_result()?;
        let stencils = model.stencils(&grid).0;
        let turns: Vec<_> = model
            .norths
            .iter()
            .map(|&north| libm::sincos(north))
            .collect();
        let mut velocities_mps = Vec::with_capacity(values);
        for time in 0..self.times_unix_s.len() {
            for &level_m in levels_m {
                let layer: Vec<Option<[f64; 2]>> = (0..points)
                    .map(|point| {
                        let [north, east] = self.at_depth(time, point, level_m)?;
                        let (sin, cos) = turns[point];
                        Some([north * cos - east * sin, north * sin + east * cos])
                    })
                    .collect();
                velocities_mps.extend(stencils.iter().map(|stencil| wet_mean(stencil, &layer)));
            }
        }
        let times_s = self.times_unix_s.iter().map(|t| t - start_unix_s).collect();
        GriddedCurrent::new(grid, levels_m.to_vec(), times_s, velocities_mps)
    }

    /// Velocity at a point and depth; `None` on land. Layers without water (below the bed) do not count.
    fn at_depth(&self, time: usize, point: usize, depth_m: f64) -> Option<[f64; 2]> {
        let points = self.latitudes_deg.len();
        let velocity = |layer: usize| {
            self.velocities_mps[(time * self.layers + layer) * points + point].map(f64::from)
        };
        let mut below: Option<(f64, [f64; 2])> = None;
        for layer in 0..self.layers {
            let here = velocity(layer);
            if !(here[0].is_finite() && here[1].is_finite()) {
                continue;
            }
            let layer_m = self.depth_m(layer, point);
            if layer_m <= depth_m {
                let Some((deep_m, deep)) = below else {
                    return Some(here);
                };
                let share = (deep_m - depth_m) / (deep_m - layer_m);
                return Some([0, 1].map(|k| deep[k] + share * (here[k] - deep[k])));
            }
            below = Some((layer_m, here));
        }
        below.map(|(_, velocity)| velocity)
    }
}

/// The mean of the wet points of a node's cell; not a number where less than half of its weight is wet.
fn wet_mean(stencil: &Option<Stencil>, layer: &[Option<[f64; 2]>]) -> [f32; 2] {
    let (mut sum, mut weight) = ([0.0; 2], 0.0);
    for (point, share) in stencil.iter().flatten() {
        if let Some([north, east]) = layer[*point] {
            sum = [sum[0] + share * north, sum[1] + share * east];
            weight += share;
        }
    }
    if weight > 0.5 {
        sum.map(|x| (x / weight) as f32)
    } else {
        [f32::NAN; 2]
    }
}
