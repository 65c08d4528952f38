//! Components of the current between the points of a grid (Arakawa C).

use super::coordinates::is_x;
use super::grid::{Horizontal, horizontal};
use super::permuted::permuted;
use super::source::{Found, NetcdfError, Source};
use super::speed::{Unit, in_mps};
use crate::FileReport;
use auv_types::libm;

/// Sides of the point grid and what lies above it.
pub(super) struct Extent {
    pub(super) times: usize,
    pub(super) layers: usize,
    pub(super) rows: usize,
    pub(super) columns: usize,
}

/// Checks that entry `i` of a component lies between the points `i` and `i + 1`, where it has positions.
///
/// # Errors
/// A component before its points: the sides of another model.
pub(super) fn check_side(
    source: &Source,
    found: &Found<'_>,
    grid: &Horizontal,
    axis: usize,
) -> Result<(), NetcdfError> {
    let Ok(own) = horizontal(source, found, &mut FileReport::default()) else {
        return Ok(());
    };
    let middle = [
        own.rows.min(grid.rows) / 2,
        own.columns.min(grid.columns) / 2,
    ];
    let at = |grid: &Horizontal, step: i64| {
        let mut place = middle.map(|k| k as i64);
        place[axis] += step;
        let node = place[0] * grid.columns as i64 + place[1];
        let degrees = |of: &[f64]| of.get(node as usize).copied().unwrap_or(f64::NAN);
        [degrees(&grid.latitudes_deg), degrees(&grid.longitudes_deg)]
    };
    let apart = |a: [f64; 2], b: [f64; 2]| {
        let wide = libm::cos(a[0].to_radians());
        libm::hypot(a[0] - b[0], libm::remainder(a[1] - b[1], 360.0) * wide)
    };
    let (here, point) = (at(&own, 0), at(grid, 0));
    let (to_next, to_last) = (apart(here, at(grid, 1)), apart(here, at(grid, -1)));
    // Positions far from the grid, like zeros, tell nothing.
    let near = apart(here, point) < apart(point, at(grid, -1));
    if near && to_last < 0.9 * to_next {
        return Err(found.error(
            "lies before the points of the grid, not between a point and the next; interpolate both components to \
             the points",
        ));
    }
    Ok(())
}

/// A velocity component at the depth points. `axis` is 1 for `u` (between neighbours along a row),
/// 0 for `v` (along a column). Entry `i` lies between points `i` and `i + 1`. Files cut out of larger ones
/// may hold one more entry beyond the last point, which is used there. `outer` are the places of the time
/// and level dimensions, where there are any.
pub(super) fn destaggered(
    source: &Source,
    (found, unit): (&Found<'_>, Unit),
    outer: &[usize],
    extent: &Extent,
    axis: usize,
    report: &mut FileReport,
) -> Result<Vec<f64>, NetcdfError> {
    let dimensions = found.dimensions();
    let mut inner: Vec<usize> = (0..dimensions.len())
        .filter(|i| !outer.contains(i) && dimensions[*i].size != 1)
        .collect();
    if inner.len() == 2 && is_x(&dimensions[inner[0]].name) && !is_x(&dimensions[inner[1]].name) {
        inner.reverse();
    }
    let mut sides = [extent.rows, extent.columns];
    let sizes = |k: usize| inner.get(k).map(|&i| dimensions[i].size);
    if sizes(axis) != Some(sides[axis] as u64) {
        sides[axis] -= 1;
    }
    let [rows, columns] = sides;
    if inner.len() != 2 || [sizes(0), sizes(1)] != [Some(rows as u64), Some(columns as u64)] {
        return Err(found.footprint(format!(
            "times, layers, rows and columns = {:?}",
            [extent.times, extent.layers, rows, columns]
        )));
    }
    let order: Vec<usize> = outer.iter().copied().chain(inner).collect();
    let stored: Vec<usize> = dimensions.iter().map(|d| d.size as usize).collect();
    let mut values = permuted(found.valid_values(report)?, &stored, &order);
    // Packed files store arbitrary numbers on land: the mask decides if there is one.
    if let Some(mask) = source.look(&[["mask_v", "mask_u"][axis]]) {
        mask.require_shape(
            &[rows as u64, columns as u64],
            "rows and columns of the velocity",
        )?;
        let wet: Vec<bool> = mask.values()?.iter().map(|&m| m >= 0.5).collect();
        for (i, value) in values.iter_mut().enumerate() {
            if !wet[i % wet.len()] {
                *value = f64::NAN;
            }
        }
    }
    in_mps(found, unit, &mut values, report)?;
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
pub(super) fn north_east([along, across]: [f64; 2], (sin, cos): (f64, f64)) -> [f64; 2] {
    [along * sin + across * cos, along * cos - across * sin]
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::libm;

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
