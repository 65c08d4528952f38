//! Components turned to true north and east.

use super::components::{Directions, Pair};
use super::grid::{Horizontal, horizontal};
use super::source::{Found, NetcdfError, Source};
use super::staggered::north_east;
use crate::FileReport;
use crate::units::{self, Quantity};
use auv_types::libm;

/// Sine and cosine of the angle from east to the grid's rows at every point; `None` where the components are
/// eastward and northward.
pub(super) fn turns(
    source: &Source,
    grid: &Horizontal,
    pair: &Pair<'_>,
    staggered: bool,
    report: &mut FileReport,
) -> Result<Option<Vec<(f64, f64)>>, NetcdfError> {
    let names = format!("`{}` and `{}`", pair.first.name(), pair.second.name());
    if pair.directions == Directions::EastNorth {
        return Ok(None);
    }
    if grid.regular && !staggered {
        if pair.directions == Directions::Unsaid {
            report.assumed.push(format!(
                "{names} are eastward and northward: rows go along latitude"
            ));
        }
        return Ok(None);
    }
    if let Some(found) = source.look(&["angle", "angle_rho"]) {
        let own = horizontal(source, &found, &mut FileReport::default())?;
        let mut angles = own.lay_out(&found, &[], report)?;
        if angles.len() != grid.rows * grid.columns {
            return Err(found.footprint("the shape of the grid"));
        }
        in_radians(&found, &mut angles, report)?;
        if pair.directions == Directions::Unsaid {
            report.assumed.push(format!(
                "{names} go along the grid and were turned by `{}`",
                found.name()
            ));
        }
        return Ok(Some(angles.into_iter().map(libm::sincos).collect()));
    }
    let (angles, widest_rad, right_handed) = geometric_angles(grid);
    if pair.directions == Directions::Unsaid && !staggered {
        if widest_rad < 0.01 {
            report.assumed.push(format!(
                "{names} are eastward and northward: rows go along latitude"
            ));
            return Ok(None);
        }
        return Err(pair.first.error(format!(
            "does not say whether it is eastward or along the grid, which is turned by up to {:.1} degrees; give \
             standard_name eastward_sea_water_velocity or sea_water_x_velocity",
            widest_rad.to_degrees()
        )));
    }
    if !right_handed {
        return Err(pair.first.error("goes along a grid whose rows go from north to south, without an `angle`; turn the grid with `ncpdq`"));
    }
    report.assumed.push(format!(
        "{names} were turned by the directions of the grid's rows: the file has no `angle`"
    ));
    Ok(Some(angles.into_iter().map(libm::sincos).collect()))
}

fn in_radians(
    found: &Found<'_>,
    angles: &mut [f64],
    report: &mut FileReport,
) -> Result<(), NetcdfError> {
    const TURN: f64 = 2.0 * std::f64::consts::PI;
    let widest = angles
        .iter()
        .copied()
        .filter(|x| x.is_finite())
        .map(f64::abs)
        .fold(0.0, f64::max);
    let units = found.text("units");
    let in_degrees = match &units {
        Some(units) => {
            let factor = units::factor(units, Quantity::Angle).ok_or_else(|| {
                found.error(format!("has units `{units}`; give radians or degrees"))
            })?;
            units::is_one(factor)
        }
        None => {
            let taken = if widest > TURN { "degrees" } else { "radians" };
            report
                .assumed
                .push(format!("`{}` has no units: taken as {taken}", found.name()));
            widest > TURN
        }
    };
    if !in_degrees && widest > TURN {
        return Err(found.contradiction(
            &format!("units `{}`", units.unwrap_or_default()),
            format!("its values, like {widest}"),
            "correct the units with `ncatted -a units`",
        ));
    }
    if in_degrees {
        for angle in angles.iter_mut() {
            *angle = angle.to_radians();
        }
        report
            .converted
            .push(format!("`{}` from degrees to radians", found.name()));
    }
    report
        .variables
        .push(found.report("angle of the grid").with_values(angles));
    Ok(())
}

/// The angle from east to each point's row by the positions of its neighbours, the widest of them, and
/// whether columns go to the left of rows.
fn geometric_angles(grid: &Horizontal) -> (Vec<f64>, f64, bool) {
    let at = |row: usize, column: usize| {
        let i = row * grid.columns + column;
        [grid.latitudes_deg[i], grid.longitudes_deg[i]]
    };
    let step = |from: [f64; 2], to: [f64; 2]| {
        let north = to[0] - from[0];
        let east = libm::remainder(to[1] - from[1], 360.0)
            * libm::cos((0.5 * (from[0] + to[0])).to_radians());
        [north, east]
    };
    let (mut angles, mut widest, mut left) =
        (Vec::with_capacity(grid.rows * grid.columns), 0.0, 0_i64);
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            let (west, east) = (column.saturating_sub(1), (column + 1).min(grid.columns - 1));
            let (south, north) = (row.saturating_sub(1), (row + 1).min(grid.rows - 1));
            let along = step(at(row, west), at(row, east));
            let across = step(at(south, column), at(north, column));
            let angle = libm::atan2(along[0], along[1]);
            widest = f64::max(widest, angle.abs());
            left += if along[1] * across[0] - along[0] * across[1] > 0.0 {
                1
            } else {
                -1
            };
            angles.push(angle);
        }
    }
    (angles, widest, left > 0)
}

/// True north and east of components along a grid's rows and columns.
pub(super) fn turned(
    along: &[f64],
    across: &[f64],
    turns: Option<&[(f64, f64)]>,
    points: usize,
) -> Vec<[f32; 2]> {
    let pairs = along.iter().zip(across).enumerate();
    pairs
        .map(|(i, (&u, &v))| {
            let north_east = match turns {
                Some(turns) => north_east([u, v], turns[i % points]),
                None => [v, u],
            };
            north_east.map(|x| x as f32)
        })
        .collect()
}
