//! Output of the Regional Ocean Modeling System: bathymetry and currents in three dimensions.

use super::bathymetry::charted;
use super::source::Source;
use super::{NetcdfError, time};
use crate::curvilinear::Curvilinear;
use crate::{ChartedDepths, GriddedCurrent, LocalFrame, MapGrid};
use auv_types::{Violations, libm};

/// The contents of a ROMS file at the depth points (rho points): velocities interpolated from the
/// staggered grid and rotated to true north and east, depths of the layers, times in seconds since 1970.
#[derive(Clone, Debug)]
pub struct RomsOutput {
    bathymetry: ChartedDepths,
    latitudes_deg: Vec<f64>,
    longitudes_deg: Vec<f64>,
    times_unix_s: Vec<f64>,
    layers: usize,
    /// Depth of every layer at every point, index `layer * points + point`, deepest layer first.
    layer_depths_m: Vec<f64>,
    /// True north and east components, m/s, NaN on land; index `(time * layers + layer) * points + point`.
    velocities_mps: Vec<[f32; 2]>,
}

/// Sides of the point grid and what lies above it.
struct Extent {
    times: usize,
    layers: usize,
    rows: usize,
    columns: usize,
}

impl RomsOutput {
    /// Reads `h`, `lat_rho`, `lon_rho`, `angle`, `s_rho`, `Cs_r`, `hc`, `Vtransform`, `ocean_time`, `u`, `v` and the masks.
    ///
    /// The velocity at a point is the mean of the wet velocities on its two sides. The depths of layers are
    /// those of a surface at rest (zeta = 0), without the height of the tide.
    ///
    /// # Errors
    /// Damaged files, missing variables, shapes that do not match, sizes beyond 50 million.
    pub fn read(bytes: &[u8]) -> Result<Self, NetcdfError> {
        let source = Source::open(bytes)?;
        let bathymetry = charted(&source)?;
        let (rows, columns) = bathymetry.shape();
        let clock = source.find("time", &["ocean_time", "time"])?;
        let times_unix_s = time::unix_seconds(&clock)?;
        let (layer_depths_m, layers) = layer_depths(&source, &bathymetry)?;
        let extent = Extent {
            times: times_unix_s.len(),
            layers,
            rows,
            columns,
        };
        let along = destaggered(&source, "u", "mask_u", &extent, 1)?;
        let across = destaggered(&source, "v", "mask_v", &extent, 0)?;
        let angle = source.find("angle", &["angle"])?;
        angle.require_shape(&[rows as u64, columns as u64], "the shape of `h`")?;
        let turns: Vec<_> = angle.values()?.into_iter().map(libm::sincos).collect();
        let points = rows * columns;
        let velocities_mps = along
            .iter()
            .zip(&across)
            .enumerate()
            .map(|(i, (&u, &v))| {
                let depth_m = bathymetry.depths_m()[i % points];
                let dry = depth_m.is_nan() || depth_m <= 0.0;
                let masked = |x: f64| if dry { f32::NAN } else { x as f32 };
                north_east([u, v], turns[i % points]).map(masked)
            })
            .collect();
        let soundings = || bathymetry.soundings();
        Ok(Self {
            latitudes_deg: soundings().map(|s| s.latitude_deg).collect(),
            longitudes_deg: soundings().map(|s| s.longitude_deg).collect(),
            bathymetry,
            times_unix_s,
            layers,
            layer_depths_m,
            velocities_mps,
        })
    }

    /// The model's bathymetry.
    #[must_use]
    pub fn bathymetry(&self) -> &ChartedDepths {
        &self.bathymetry
    }

    /// The records' times, seconds since 1970-01-01 00:00 UTC.
    #[must_use]
    pub fn times_unix_s(&self) -> &[f64] {
        &self.times_unix_s
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
        let (rows, columns) = self.bathymetry.shape();
        let inside = layer < self.layers && row < rows && column < columns;
        let index = ((time * self.layers + layer) * rows + row) * columns + column;
        let velocity = *self.velocities_mps.get(index).filter(|_| inside)?;
        velocity.iter().all(|x| x.is_finite()).then_some(velocity)
    }

    /// The current in a local frame, on a grid of `cell_m` and at `levels_m` (increasing depths).
    /// Mission time 0 is `start_unix_s`.
    ///
    /// Linear between layers; beyond the first and the last layer the nearest one is used. A grid node is
    /// water if more than half of its weight in the model's cell is.
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
        let (_, columns) = self.bathymetry.shape();
        let points = self.bathymetry.depths_m().len();
        let model = Curvilinear::new(frame, columns, &self.latitudes_deg, &self.longitudes_deg);
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
        let stencils = model.stencils(&grid);
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
                velocities_mps.extend(stencils.iter().map(|stencil| {
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
                }));
            }
        }
        let times_s = self.times_unix_s.iter().map(|t| t - start_unix_s).collect();
        GriddedCurrent::new(grid, levels_m.to_vec(), times_s, velocities_mps)
    }

    /// Velocity at a point and depth; `None` on land.
    fn at_depth(&self, time: usize, point: usize, depth_m: f64) -> Option<[f64; 2]> {
        let points = self.bathymetry.depths_m().len();
        let depth_of = |layer: usize| self.layer_depths_m[layer * points + point];
        let velocity = |layer: usize| {
            self.velocities_mps[(time * self.layers + layer) * points + point].map(f64::from)
        };
        // Layers are ordered upwards: the first one above the depth.
        let above = (0..self.layers).find(|&layer| depth_of(layer) <= depth_m);
        let [north, east] = match above {
            Some(0) => velocity(0),
            None => velocity(self.layers - 1),
            Some(above) => {
                let (deep_m, shallow_m) = (depth_of(above - 1), depth_of(above));
                let share = (deep_m - depth_m) / (deep_m - shallow_m);
                let (deep, shallow) = (velocity(above - 1), velocity(above));
                [0, 1].map(|k| deep[k] + share * (shallow[k] - deep[k]))
            }
        };
        (north.is_finite() && east.is_finite()).then_some([north, east])
    }
}

/// The depths of the terrain-following layers, and their number.
fn layer_depths(
    source: &Source,
    bathymetry: &ChartedDepths,
) -> Result<(Vec<f64>, usize), NetcdfError> {
    let s_rho = source.find("layers", &["s_rho", "sc_r"])?;
    let stretching = source.find("stretching", &["Cs_r"])?;
    stretching.require_shape(&s_rho.shape, "one value for each layer of `s_rho`")?;
    let critical_m = source.find("critical depth", &["hc"])?.scalar()?;
    let transform = match source.look(&["Vtransform"]) {
        Some(found) => found.scalar()?,
        None => 1.0,
    };
    let (levels, curves) = (s_rho.values()?, stretching.values()?);
    let mut depths_m = Vec::with_capacity(levels.len() * bathymetry.depths_m().len());
    for (s, c) in levels.iter().zip(&curves) {
        depths_m.extend(bathymetry.depths_m().iter().map(|&h| {
            let z = if transform < 1.5 {
                critical_m * s + (h - critical_m) * c
            } else {
                h * (critical_m * s + h * c) / (critical_m + h)
            };
            -z
        }));
    }
    let sound = !levels.is_empty() && levels.windows(2).all(|pair| pair[0] < pair[1]);
    if !sound || !curves.iter().all(|c| c.is_finite()) {
        return Err(
            s_rho.error("or `Cs_r` is not finite and rising; give layers from the bottom up")
        );
    }
    Ok((depths_m, levels.len()))
}

/// A velocity component at the depth points. `axis` is 1 for `u` (between neighbours along a row),
/// 0 for `v` (along a column). Entry `i` lies between points `i` and `i + 1`. Files cut out of larger ones
/// may hold one more entry beyond the last point, which is used there.
fn destaggered(
    source: &Source,
    name: &'static str,
    mask_name: &'static str,
    extent: &Extent,
    axis: usize,
) -> Result<Vec<f64>, NetcdfError> {
    let found = source.find(name, &[name])?;
    let mut sides = [extent.rows, extent.columns];
    if found.shape.last_chunk::<2>().map(|s| s[axis]) != Some(sides[axis] as u64) {
        sides[axis] -= 1;
    }
    let [rows, columns] = sides;
    let shape = [extent.times, extent.layers, rows, columns].map(|n| n as u64);
    found.require_shape(&shape, "times, layers, rows and columns")?;
    let mut values = found.values()?;
    // Packed files store arbitrary numbers on land: the mask decides if there is one.
    if let Some(mask) = source.look(&[mask_name]) {
        mask.require_shape(&shape[2..], "rows and columns of the velocity")?;
        let wet: Vec<bool> = mask.values()?.iter().map(|&m| m >= 0.5).collect();
        for (i, value) in values.iter_mut().enumerate() {
            if !wet[i % wet.len()] {
                *value = f64::NAN;
            }
        }
    }
    let points = [extent.rows, extent.columns];
    let layers = values.chunks_exact(rows * columns);
    Ok(layers
        .flat_map(|layer| means_at_points(layer, sides, points, axis))
        .collect())
}

/// The mean of the wet values on the two sides of every point of a layer; NaN if both are land. `sides` are
/// the rows and columns of the staggered layer, `points` those of the depth points.
fn means_at_points(
    layer: &[f64],
    sides: [usize; 2],
    points: [usize; 2],
    axis: usize,
) -> impl Iterator<Item = f64> {
    (0..points[0] * points[1]).map(move |point| {
        let place = [point / points[1], point % points[1]];
        let (mut sum, mut count) = (0.0, 0.0);
        let both = [place[axis].checked_sub(1), Some(place[axis])];
        for along in both.into_iter().flatten().filter(|&k| k < sides[axis]) {
            let mut side = place;
            side[axis] = along;
            let value = layer[side[0] * sides[1] + side[1]];
            if value.is_finite() {
                sum += value;
                count += 1.0;
            }
        }
        // 0 / 0 is NaN: land.
        sum / count
    })
}

/// True north and east of a velocity along the grid's first and second axis; `angle` is that from
/// east to the first axis, counter-clockwise.
fn north_east([along, across]: [f64; 2], (sin, cos): (f64, f64)) -> [f64; 2] {
    [along * sin + across * cos, along * cos - across * sin]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn staggered_components_are_averaged_at_the_points() {
        let land = f64::NAN;
        // Three points in a row, the sides between them along the row.
        let at = |layer: &[f64], sides, points, axis| -> Vec<f64> {
            means_at_points(layer, sides, points, axis).collect()
        };
        assert_eq!(at(&[1.0, 3.0], [1, 2], [1, 3], 1), [1.0, 2.0, 3.0]);
        // One more side beyond the last point, as in files cut out of larger ones.
        assert_eq!(at(&[1.0, 3.0, 7.0], [1, 3], [1, 3], 1), [1.0, 2.0, 5.0]);
        // Between rows: two columns, three rows.
        let down = [1.0, 10.0, 3.0, 30.0];
        let met = [1.0, 10.0, 2.0, 20.0, 3.0, 30.0];
        assert_eq!(at(&down, [2, 2], [3, 2], 0), met);
        // Land on one side is ignored; with land on both sides the point is land.
        let coast = at(&[1.0, land, land], [1, 3], [1, 4], 1);
        assert_eq!(coast[..2], [1.0, 1.0]);
        assert!(coast[2].is_nan() && coast[3].is_nan());
    }

    #[test]
    fn a_rotated_grid_gives_true_north_and_east() {
        for degrees in [0.0, 30.0, 90.0, -120.0_f64] {
            let turn = libm::sincos(degrees.to_radians());
            // Along the first axis: the angle from east towards north.
            let [north, east] = north_east([2.0, 0.0], turn);
            assert!((libm::atan2(north, east).to_degrees() - degrees).abs() < 1e-9);
            // The second axis is a quarter turn ahead.
            let [north, east] = north_east([0.0, 2.0], turn);
            let further = libm::atan2(north, east).to_degrees() - degrees - 90.0;
            assert!(libm::remainder(further, 360.0).abs() < 1e-9);
            assert!((libm::hypot(north, east) - 2.0).abs() < 1e-12);
        }
    }
}
