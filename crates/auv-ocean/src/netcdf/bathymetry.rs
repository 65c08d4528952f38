//! Charts of depth.

use super::grid::{Horizontal, horizontal};
use super::roles::{Basis, Direction, chart_direction, chart_rank};
use super::source::{Found, NetcdfError, Source};
use crate::plausible::{Implausible, mask_depths};
use crate::units::{self, Quantity};
use crate::{ChartedDepths, FileReport, VariableReport};

/// Reads a chart of depths with what was read.
///
/// The chart is the variable whose attributes say so (CF `standard_name`, `positive`), else one of a usual
/// name (`Bathymetry`, `h`, `deptho`, `elevation`, `z`, ...), over the latitudes and longitudes of its own
/// dimensions, in any order. Units are converted; missing and impossible values are land.
///
/// # Errors
/// Damaged files, missing variables, unknown units, attributes that contradict each other or the values,
/// no water at all, sizes beyond 50 million.
pub fn read_bathymetry(bytes: &[u8]) -> Result<(ChartedDepths, FileReport), NetcdfError> {
    let mut report = FileReport {
        format: "NetCDF".into(),
        ..FileReport::default()
    };
    let source = Source::open(bytes)?;
    let chart = charted(&source, &mut report)?.0;
    if !chart.depths_m().iter().any(|&depth_m| depth_m > 0.0) {
        let name = report
            .variables
            .last()
            .map(|v| v.name.clone())
            .unwrap_or_default();
        return Err(NetcdfError::Data {
            reason: format!(
                "has no water in the whole chart: does it count upwards? then say so with \
                 `ncatted -a positive,{name},o,c,up` (or `down`)"
            ),
            variable: name,
        });
    }
    report.dropped.extend(chart.oddities());
    Ok((chart, report))
}

/// The chart and its grid.
pub(super) fn charted(
    source: &Source,
    report: &mut FileReport,
) -> Result<(ChartedDepths, Horizontal), NetcdfError> {
    let depth = chosen(source)?;
    let grid = horizontal(source, &depth, report)?;
    let mut depths_m = grid.lay_out(&depth, &[], report)?;
    in_metres_down(&depth, &mut depths_m, report)?;
    let own = depth.report("depth, metres, positive down");
    report
        .variables
        .push(VariableReport::with_values(own, &depths_m));
    mask_land(source, &grid, &mut depths_m, report)?;
    let (latitudes, longitudes) = (grid.latitudes_deg.clone(), grid.longitudes_deg.clone());
    let chart = ChartedDepths::new(grid.columns, latitudes, longitudes, depths_m)?;
    Ok((chart, grid))
}

/// The variable that is the chart: the best known one of two dimensions.
fn chosen(source: &Source) -> Result<Found<'_>, NetcdfError> {
    let mut best: Option<(usize, Found<'_>)> = None;
    let mut rival = None;
    let mut other_shape = None;
    for found in source.all() {
        let Some(rank) = chart_rank(&found) else {
            continue;
        };
        if found.squeezed().len() != 2 {
            other_shape.get_or_insert(found);
            continue;
        }
        match &best {
            Some((least, _)) if rank > *least => {}
            Some((least, _)) if rank == *least => rival = Some(found),
            _ => (best, rival) = (Some((rank, found)), None),
        }
    }
    match (best, rival, other_shape) {
        (Some((_, found)), None, _) => Ok(found),
        (Some((_, found)), Some(rival), _) => Err(found.contradiction(
            "says that it is the depth",
            format!("variable `{}`, which says so too", rival.name()),
            "take one of them out with `ncks -x -v`, or give only one a standard_name like sea_floor_depth_below_geoid",
        )),
        (None, _, Some(found)) => Err(found.footprint("two dimensions, north and east")),
        (None, _, None) => Err(NetcdfError::Missing {
            variable: "depth",
            looked_for: "standard_name sea_floor_depth_below_geoid or height, or Bathymetry, h, deptho, depth, elevation, z, Band1"
                .into(),
        }),
    }
}

/// Converts values to metres, positive down, with NaN for what no sea has.
fn in_metres_down(
    depth: &Found<'_>,
    values: &mut [f64],
    report: &mut FileReport,
) -> Result<(), NetcdfError> {
    let name = depth.name();
    let units = depth.text("units");
    let factor = match &units {
        None => {
            report
                .assumed
                .push(format!("`{name}` has no units: taken as metres"));
            1.0
        }
        Some(units) => units::factor(units, Quantity::Length).ok_or_else(|| {
            depth.error(format!("has units `{units}`; give metres, feet or fathoms"))
        })?,
    };
    let (direction, basis) = chart_direction(depth)?;
    if basis == Basis::Name {
        accept_by_name(depth, direction, values, report)?;
    }
    let factor = if direction == Direction::Up {
        report
            .converted
            .push(format!("`{name}` from heights to depths"));
        -factor
    } else {
        factor
    };
    if let Some(units) = units.filter(|_| !units::is_one(factor.abs())) {
        report
            .converted
            .push(format!("`{name}` from {units} to metres"));
    }
    if !units::is_one(factor) {
        for value in values.iter_mut() {
            *value *= factor;
        }
    }
    match mask_depths(values, factor.abs()) {
        Implausible::None => Ok(()),
        Implausible::Filled(count, one) => {
            report.dropped.push(format!(
                "`{name}`: {count} values like {one} are no soundings and count as land"
            ));
            Ok(())
        }
        Implausible::AnotherUnit(one) => Err(depth.contradiction(
            &format!(
                "units `{}`",
                depth.text("units").unwrap_or_else(|| "m".into())
            ),
            format!("its values: {one} m deep"),
            "correct the units with `ncatted -a units`",
        )),
    }
}

/// Accepts the direction that a name says, unless the values leave it open.
fn accept_by_name(
    depth: &Found<'_>,
    direction: Direction,
    values: &[f64],
    report: &mut FileReport,
) -> Result<(), NetcdfError> {
    let name = depth.name();
    let share = |test: fn(f64) -> bool| {
        let sound = values.iter().filter(|x| x.is_finite()).count();
        values.iter().filter(|&&x| test(x)).count() as f64 / sound.max(1) as f64
    };
    if direction == Direction::Down && share(|x| x < -1.0).min(share(|x| x > 1.0)) > 0.005 {
        return Err(depth.error(format!(
            "has values above and below 0 and does not say which way it counts; say so with \
             `ncatted -a positive,{name},o,c,down` (or `up`)"
        )));
    }
    let way = if direction == Direction::Up {
        "upwards"
    } else {
        "downwards"
    };
    report
        .assumed
        .push(format!("`{name}` counts {way}, by its name"));
    Ok(())
}

/// Land by a mask: `mask_rho`, or standard_name `sea_binary_mask` or `land_binary_mask`.
fn mask_land(
    source: &Source,
    grid: &Horizontal,
    depths_m: &mut [f64],
    report: &mut FileReport,
) -> Result<(), NetcdfError> {
    let by_standard = |f: &Found<'_>| {
        matches!(
            f.word("standard_name").as_str(),
            "sea_binary_mask" | "land_binary_mask"
        ) && f.squeezed().len() == 2
    };
    let Some(mask) = source
        .look(&["mask_rho"])
        .or_else(|| source.all().find(by_standard))
    else {
        return Ok(());
    };
    if mask.squeezed().len() != 2 {
        return Err(mask.footprint("the shape of the depths"));
    }
    // In a file of one grid the mask lies on the chart's; its own coordinates tell its order.
    let own = horizontal(source, &mask, &mut FileReport::default())?;
    if (own.rows, own.columns) != (grid.rows, grid.columns) {
        return Err(mask.footprint("the shape of the depths"));
    }
    let land_is_one = mask.word("standard_name") == "land_binary_mask";
    for (depth_m, mark) in depths_m.iter_mut().zip(own.lay_out(&mask, &[], report)?) {
        let water = if land_is_one { mark < 0.5 } else { mark >= 0.5 };
        if !water {
            *depth_m = 0.0;
        }
    }
    report.variables.push(mask.report("mask of land"));
    Ok(())
}
