//! Charts of depth.

use super::NetcdfError;
use super::source::{Found, Source};
use crate::ChartedDepths;

const DEPTH: &[&str] = &[
    "Bathymetry",
    "bathymetry",
    "h",
    "deptho",
    "depth",
    "elevation",
    "z",
    "Band1",
];
const LATITUDE: &[&str] = &["nav_lat", "lat_rho", "latitude", "lat", "y"];
const LONGITUDE: &[&str] = &["nav_lon", "lon_rho", "longitude", "lon", "x"];

/// Reads the depths of a NEMO grid (`Bathymetry`, `nav_lat`, `nav_lon`), of a ROMS grid (`h`, `lat_rho`,
/// `lon_rho`, `mask_rho`) or of a chart on a latitude-longitude grid (`deptho`, or `elevation` and similar
/// variables, which are positive up).
///
/// # Errors
/// Damaged files, missing variables, shapes that do not match, sizes beyond 50 million.
pub fn read_bathymetry(bytes: &[u8]) -> Result<ChartedDepths, NetcdfError> {
    charted(&Source::open(bytes)?)
}

pub(super) fn charted(source: &Source) -> Result<ChartedDepths, NetcdfError> {
    let depth = source.find("depth", DEPTH)?;
    let &[rows, columns] = depth.shape.as_slice() else {
        return Err(NetcdfError::Footprint {
            variable: depth.name().into(),
            shape: depth.shape.clone(),
            expected: "two dimensions, north and east".into(),
        });
    };
    // First, because it refuses sizes for which no memory may be allocated.
    let mut depths_m = depth.values()?;
    let latitude = axis(source.find("latitude", LATITUDE)?, rows, columns, 0)?;
    let longitude = axis(source.find("longitude", LONGITUDE)?, rows, columns, 1)?;
    if counts_upwards(&depth) {
        for depth_m in &mut depths_m {
            *depth_m = -*depth_m;
        }
    }
    if let Some(mask) = source.look(&["mask_rho"]) {
        mask.require_shape(&[rows, columns], "the shape of the depths")?;
        for (depth_m, water) in depths_m.iter_mut().zip(mask.values()?) {
            if water.is_nan() || water < 0.5 {
                *depth_m = 0.0;
            }
        }
    }
    Ok(ChartedDepths::new(
        columns as usize,
        latitude,
        longitude,
        depths_m,
    )?)
}

/// Whether the values are positive up.
fn counts_upwards(depth: &Found<'_>) -> bool {
    match depth.text("positive").as_deref() {
        Some("up") => true,
        Some("down") => false,
        _ => {
            let name = depth.text("standard_name").unwrap_or_default();
            name.starts_with("height") || ["elevation", "z", "Band1"].contains(&depth.name())
        }
    }
}

/// Latitudes or longitudes of all nodes; a one-dimensional axis is expanded.
fn axis(found: Found<'_>, rows: u64, columns: u64, along: usize) -> Result<Vec<f64>, NetcdfError> {
    if found.shape.len() == 1 {
        found.require_shape(
            &[[rows, columns][along]],
            "as many values as the depths have",
        )?;
        let values = found.values()?;
        let columns = columns as usize;
        let node = |i: usize| [i / columns, i % columns][along];
        return Ok((0..rows as usize * columns)
            .map(|i| values[node(i)])
            .collect());
    }
    found.require_shape(&[rows, columns], "the shape of the depths")?;
    found.values()
}
