//! Bathymetry from GeoTIFF files, given as bytes (feature `geotiff`).
//!
//! One band of numbers in degrees (EPSG:4326) or on a Universal Transverse Mercator zone of WGS84
//! (EPSG:326xx, 327xx); other coordinate systems are refused by their code.

mod error;
mod keys;
mod metadata;
#[cfg(test)]
mod tests;
mod utm;

pub use error::GeotiffError;

use crate::axis_order::axis_order;
use crate::plausible::{Implausible, mask_depths};
use crate::{ChartedDepths, FileReport, VariableReport};
use error::MOST_VALUES;
use keys::{Affine, Coordinates, Image, Keys, keys};
use metadata::Metadata;
use std::io::Cursor;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

fn not_tiff(error: impl std::fmt::Display) -> GeotiffError {
    GeotiffError::NotTiff {
        reason: error.to_string(),
    }
}

/// Reads a chart of depths with what was read.
///
/// Values are heights, positive up, unless the vertical system or GDAL's metadata (`positive`) say that they
/// are depths. Positions are those of the cells' centres, or of the points where the file says so.
///
/// # Errors
/// Damaged files, other coordinate systems or units, several bands, no water at all, more than 50 million
/// values.
pub fn read_geotiff(bytes: &[u8]) -> Result<(ChartedDepths, FileReport), GeotiffError> {
    let mut report = FileReport {
        format: "GeoTIFF".into(),
        ..FileReport::default()
    };
    let limits = {
        let mut limits = Limits::default();
        limits.decoding_buffer_size = 8 * MOST_VALUES as usize;
        limits.intermediate_buffer_size = 8 * MOST_VALUES as usize;
        limits
    };
    let mut image = Decoder::new(Cursor::new(bytes))
        .map_err(not_tiff)?
        .with_limits(limits);
    let (columns, rows) = image.dimensions().map_err(not_tiff)?;
    let values = u64::from(columns) * u64::from(rows);
    if values > MOST_VALUES {
        return Err(GeotiffError::TooLarge { values });
    }
    let keys = keys(&mut image)?;
    let affine = Affine::of(&mut image)?;
    let mut depths_m = numbers(&mut image)?;
    if depths_m.len() as u64 != values {
        return Err(GeotiffError::Bands {
            bands: format!("{} values in {columns} x {rows} cells", depths_m.len()),
        });
    }
    in_metres_down(&mut image, &keys, &mut depths_m, &mut report)?;
    let shape = vec![
        ("rows".into(), u64::from(rows)),
        ("columns".into(), u64::from(columns)),
    ];
    let variable = VariableReport {
        name: "band 1".into(),
        role: "depth, metres, positive down".into(),
        shape,
        ..VariableReport::default()
    };
    report.variables.push(variable.with_values(&depths_m));
    let chart = placed(&keys, affine, [rows as usize, columns as usize], &depths_m)?;
    report.extent_deg = chart.extent_deg();
    report.dropped.extend(chart.oddities());
    Ok((chart, report))
}

/// The numbers of the only band, NaN where they are missing.
fn numbers(image: &mut Image<'_>) -> Result<Vec<f64>, GeotiffError> {
    let colours = image.colortype().map_err(not_tiff)?;
    if !matches!(colours, tiff::ColorType::Gray(_)) {
        return Err(GeotiffError::Bands {
            bands: format!("{colours:?}"),
        });
    }
    let missing: Option<f64> = image
        .get_tag_ascii_string(Tag::GdalNodata)
        .ok()
        .and_then(|text| text.trim_matches(['\0', ' ', '\n']).parse().ok());
    macro_rules! wide {
        ($values:expr) => {
            $values.into_iter().map(f64::from).collect()
        };
    }
    let mut values: Vec<f64> = match image.read_image().map_err(not_tiff)? {
        DecodingResult::U8(values) => wide!(values),
        DecodingResult::U16(values) => wide!(values),
        DecodingResult::U32(values) => wide!(values),
        DecodingResult::I8(values) => wide!(values),
        DecodingResult::I16(values) => wide!(values),
        DecodingResult::I32(values) => wide!(values),
        DecodingResult::F32(values) => wide!(values),
        DecodingResult::F64(values) => values,
        _ => return Err(not_tiff("values of 16 bit floats or 64 bit integers")),
    };
    let is_missing = |x: f64| {
        let equal =
            |fill: f64| x.total_cmp(&fill).is_eq() || x.total_cmp(&f64::from(fill as f32)).is_eq();
        !x.is_finite() || x.abs() >= 1e30 || missing.is_some_and(equal)
    };
    for value in &mut values {
        if is_missing(*value) {
            *value = f64::NAN;
        }
    }
    Ok(values)
}

/// Metres of a unit of the values.
fn unit_m(keys: &Keys, metadata: &Metadata, report: &mut FileReport) -> Result<f64, GeotiffError> {
    match (keys.unit_m, metadata.unit_m()?) {
        (Some(by_keys), Some(told)) if by_keys.total_cmp(&told).is_ne() => {
            Err(GeotiffError::Values {
                reason: format!(
                    "are in units of {by_keys} m by their vertical system and of {told} m by their metadata; correct one of them"
                ),
            })
        }
        (by_keys, told) => Ok(by_keys.or(told).unwrap_or_else(|| {
            report
                .assumed
                .push("the values have no unit: taken as metres".into());
            1.0
        })),
    }
}

fn in_metres_down(
    image: &mut Image<'_>,
    keys: &Keys,
    values: &mut [f64],
    report: &mut FileReport,
) -> Result<(), GeotiffError> {
    let metadata = Metadata::of(image);
    if keys.depths && metadata.positive("up") {
        return Err(GeotiffError::Values {
            reason: "are depths by their vertical system and heights by their metadata (positive up); correct one of them".into(),
        });
    }
    let down = keys.depths || metadata.positive("down");
    if !down && !metadata.positive("up") {
        report
            .assumed
            .push("the values are heights, positive up".into());
    }
    if let Some((scale, offset)) = metadata.packing()? {
        for value in values.iter_mut() {
            *value = *value * scale + offset;
        }
        report.converted.push(format!(
            "values times {scale} plus {offset}, by their metadata"
        ));
    }
    let unit_m = unit_m(keys, &metadata, report)?;
    let factor = if down { unit_m } else { -unit_m };
    for value in values.iter_mut() {
        *value *= factor;
    }
    if unit_m.total_cmp(&1.0).is_ne() {
        report
            .converted
            .push(format!("values times {unit_m} to metres"));
    }
    match mask_depths(values, unit_m) {
        Implausible::None => {}
        Implausible::Filled(count, one) => report.dropped.push(format!(
            "{count} values like {one} m deep are no soundings and count as land"
        )),
        Implausible::AnotherUnit(one) => {
            return Err(GeotiffError::Values {
                reason: format!(
                    "are up to {one} m deep, deeper than any sea: another unit; scale them with `gdal_calc.py`"
                ),
            });
        }
    }
    if values.iter().any(|&depth_m| depth_m > 0.0) {
        return Ok(());
    }
    Err(GeotiffError::Values {
        reason: "have no water in the whole chart: do they count the other way? turn them with `gdal_calc.py --calc=-A`".into(),
    })
}

/// The chart with its rows from south to north and its columns from west to east, where it lies along them.
fn placed(
    keys: &Keys,
    affine: Affine,
    [rows, columns]: [usize; 2],
    depths_m: &[f64],
) -> Result<ChartedDepths, GeotiffError> {
    let at = |row: usize, column: usize| {
        let [x, y] = affine.at(column as f64 + keys.offset, row as f64 + keys.offset);
        match keys.coordinates {
            Coordinates::Degrees => [y, x],
            Coordinates::Utm(zone) => zone.degrees(x, y),
        }
    };
    let upright = affine.0[1].abs() + affine.0[3].abs() <= 0.0;
    let (row_order, column_order) = match keys.coordinates {
        Coordinates::Degrees if upright => {
            let latitudes: Vec<f64> = (0..rows).map(|row| at(row, 0)[0]).collect();
            let longitudes: Vec<f64> = (0..columns).map(|column| at(0, column)[1]).collect();
            (
                axis_order(&latitudes, false).0,
                axis_order(&longitudes, true).0,
            )
        }
        _ => ((0..rows).rev().collect(), (0..columns).collect()),
    };
    let capacity = row_order.len() * column_order.len();
    let (mut latitudes, mut longitudes) =
        (Vec::with_capacity(capacity), Vec::with_capacity(capacity));
    let mut ordered = Vec::with_capacity(capacity);
    for &row in &row_order {
        for &column in &column_order {
            let [latitude, longitude] = at(row, column);
            latitudes.push(latitude);
            longitudes.push(longitude);
            ordered.push(depths_m[row * columns + column]);
        }
    }
    let beyond = latitudes
        .iter()
        .zip(&longitudes)
        .any(|(latitude, longitude)| !(latitude.abs() <= 90.0 && longitude.abs() <= 540.0));
    if beyond {
        return Err(GeotiffError::Values {
            reason: "lie beyond the poles or round the Earth by the georeference; correct it with `gdal_translate -a_ullr`".into(),
        });
    }
    Ok(ChartedDepths::new(
        column_order.len(),
        latitudes,
        longitudes,
        ordered,
    )?)
}
