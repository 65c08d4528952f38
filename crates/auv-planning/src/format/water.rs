//! The current and the bed of a scene.

use auv_ocean::{GriddedBed, GriddedCurrent, MapGrid};
use auv_types::Violations;
use serde::Deserialize;

/// A current on a grid, at depth levels and times.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CurrentFile {
    grid: MapGrid,
    #[serde(default = "one_level")]
    levels_m: Vec<f64>,
    times: Vec<f64>,
    velocities: Vec<[f32; 2]>,
}

/// One level holds at all depths.
fn one_level() -> Vec<f64> {
    vec![0.0]
}

impl CurrentFile {
    pub(super) fn field(self) -> Result<GriddedCurrent, Violations> {
        GriddedCurrent::new(self.grid, self.levels_m, self.times, self.velocities)
    }
}

/// Depths on a grid.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BedFile {
    grid: MapGrid,
    depths: Vec<f64>,
}

impl BedFile {
    pub(super) fn bed(self) -> Result<GriddedBed, Violations> {
        GriddedBed::new(self.grid, self.depths)
    }
}
