//! Currents of ocean models.

use super::bathymetry::charted;
use super::components::Pair;
use super::grid::{Horizontal, horizontal};
use super::levels::layers;
use super::outer::Outer;
use super::records::{records, with_values};
use super::source::{Found, NetcdfError, Source};
use super::speed::{in_mps, unit_of};
use super::staggered::{Extent, check_side, destaggered};
use super::turns::{turned, turns};
use crate::{ChartedDepths, FileReport, ModelCurrents};

/// Reads the current of an ocean model with what was read.
///
/// Components are found by CF `standard_name`, then by usual names (`uo`, `water_u`, `u_eastward`, `u`, ...).
/// Those along a model's grid are turned to true north and east, those between its points (Arakawa C) are
/// interpolated: the velocity at a point is the mean of the wet velocities on its two sides. Layers are
/// depths, or terrain-following ones for a surface at rest (zeta = 0), without the height of the tide.
/// Records of one time, and records without a time or a value, are dropped.
///
/// # Errors
/// Damaged files, missing variables, unknown or missing units, attributes that contradict each other or the
/// values, sizes beyond 50 million.
pub fn read_currents(bytes: &[u8]) -> Result<(ModelCurrents, FileReport), NetcdfError> {
    let mut report = FileReport {
        format: "NetCDF".into(),
        ..FileReport::default()
    };
    let source = Source::open(bytes)?;
    let pair = Pair::chosen(&source)?;
    let outer = [
        Outer::of(&source, &pair.first)?,
        Outer::of(&source, &pair.second)?,
    ];
    pair.require_same_outer(&source, &outer)?;
    let (times_unix_s, kept) = records(&source, &pair.first, &outer[0], &mut report)?;
    let field = if pair.is_staggered(&outer) {
        Field::staggered(&source, &pair, &outer, &mut report)?
    } else {
        Field::at_points(&source, &pair, &outer, &mut report)?
    };
    finished(field, times_unix_s, &kept, report)
}

/// What both kinds of grid give.
struct Field {
    grid: Horizontal,
    bathymetry: Option<ChartedDepths>,
    layers: super::levels::Layers,
    /// True north and east, index `(time * layers + layer) * points + point` as stored.
    velocities_mps: Vec<[f32; 2]>,
}

impl Field {
    fn staggered(
        source: &Source,
        pair: &Pair<'_>,
        outer: &[Outer; 2],
        report: &mut FileReport,
    ) -> Result<Self, NetcdfError> {
        let (bathymetry, grid) = points_of(source, pair, report)?;
        if grid.regular && !grid.in_stored_order() {
            return Err(pair.first.error(
                "lies between the points of a grid whose latitudes or longitudes do not rise; turn the grid with `ncpdq`",
            ));
        }
        let layers = layers(
            source,
            level_name(&pair.first, &outer[0]),
            Some(&bathymetry),
            report,
        )?;
        let extent = Extent {
            times: Outer::count(&pair.first, outer[0].time),
            layers: Outer::count(&pair.first, outer[0].level),
            rows: grid.rows,
            columns: grid.columns,
        };
        let mut component =
            |found: &Found<'_>, outer: &Outer, axis: usize| -> Result<Vec<f64>, NetcdfError> {
                let unit = unit_of(found)?;
                let same = [
                    Outer::count(found, outer.time),
                    Outer::count(found, outer.level),
                ];
                if same != [extent.times, extent.layers] {
                    return Err(
                        found.footprint(format!("the times and layers of `{}`", pair.first.name()))
                    );
                }
                let (component, places) = ((found, unit), outer.places());
                check_side(source, found, &grid, axis)?;
                destaggered(source, component, &places, &extent, axis, report)
            };
        let along = component(&pair.first, &outer[0], 1)?;
        let across = component(&pair.second, &outer[1], 0)?;
        report
            .converted
            .push("the current from between the model's points to them".into());
        let turns = turns(source, &grid, pair, true, report)?;
        let mut velocities_mps =
            turned(&along, &across, turns.as_deref(), grid.rows * grid.columns);
        mask_dry(&mut velocities_mps, &bathymetry);
        Ok(Self {
            grid,
            bathymetry: Some(bathymetry),
            layers,
            velocities_mps,
        })
    }

    fn at_points(
        source: &Source,
        pair: &Pair<'_>,
        outer: &[Outer; 2],
        report: &mut FileReport,
    ) -> Result<Self, NetcdfError> {
        let grid = horizontal(source, &pair.first, report)?;
        let points = grid.rows * grid.columns;
        let level = level_name(&pair.first, &outer[0]);
        // Layers that follow the bed need it; others do without.
        let bathymetry = match charted(source, &mut FileReport::default()) {
            Ok((chart, _)) if chart.depths_m().len() == points => Some(chart),
            _ => None,
        };
        let layers = layers(source, level, bathymetry.as_ref(), report)?;
        let mut component = |found: &Found<'_>, outer: &Outer| -> Result<Vec<f64>, NetcdfError> {
            let own = horizontal(source, found, &mut FileReport::default())?;
            let unit = unit_of(found)?;
            let mut values = own.lay_out(found, &outer.places(), report)?;
            in_mps(found, unit, &mut values, report)?;
            Ok(values)
        };
        let along = component(&pair.first, &outer[0])?;
        let across = component(&pair.second, &outer[1])?;
        if along.len() != across.len() {
            return Err(pair
                .second
                .footprint(format!("the shape of `{}`", pair.first.name())));
        }
        let turns = turns(source, &grid, pair, false, report)?;
        let mut velocities_mps = turned(&along, &across, turns.as_deref(), points);
        let follows = matches!(
            layers.depths_m,
            crate::model_currents::LayerDepths::Point(_)
        );
        if let Some(chart) = bathymetry.as_ref().filter(|_| follows) {
            mask_dry(&mut velocities_mps, chart);
        }
        Ok(Self {
            grid,
            bathymetry: bathymetry.filter(|_| follows),
            layers,
            velocities_mps,
        })
    }
}

/// The points of a grid between which the components lie: those of the file's depths.
fn points_of(
    source: &Source,
    pair: &Pair<'_>,
    report: &mut FileReport,
) -> Result<(ChartedDepths, Horizontal), NetcdfError> {
    charted(source, report).map_err(|error| match error {
        NetcdfError::Missing { .. } => pair.first.error(format!(
            "lies elsewhere than `{}`, between the points of a grid, and the file has no depths at these; give \
             them, or interpolate both components to the same points",
            pair.second.name()
        )),
        other => other,
    })
}

/// Takes the current off land.
fn mask_dry(velocities_mps: &mut [[f32; 2]], chart: &ChartedDepths) {
    let depths_m = chart.depths_m();
    for (i, velocity) in velocities_mps.iter_mut().enumerate() {
        let depth_m = depths_m[i % depths_m.len()];
        if depth_m.is_nan() || depth_m <= 0.0 {
            *velocity = [f32::NAN; 2];
        }
    }
}

fn level_name<'a>(found: &Found<'a>, outer: &Outer) -> Option<&'a str> {
    outer.level.map(|i| found.dimensions()[i].name.as_str())
}

/// Takes the kept records and the layers in order.
fn finished(
    field: Field,
    times_unix_s: Vec<f64>,
    kept: &[usize],
    mut report: FileReport,
) -> Result<(ModelCurrents, FileReport), NetcdfError> {
    let Field {
        grid,
        bathymetry,
        layers,
        velocities_mps: stored,
    } = field;
    let count = layers.order.len();
    let points = grid.rows * grid.columns;
    let (times, velocities_mps) =
        with_values(&stored, (&times_unix_s, kept), &layers.order, points)?;
    let empty = times_unix_s.len() - times.len();
    if empty > 0 {
        report
            .dropped
            .push(format!("{empty} records without any value are left out"));
    }
    if let (Some(&first), Some(&last), Some(records)) =
        (times.first(), times.last(), report.records.as_mut())
    {
        *records = (first, last, times.len());
    }
    report.dropped.extend(crate::oddities::oddities(
        grid.columns,
        &grid.latitudes_deg,
        &grid.longitudes_deg,
    ));
    let currents = ModelCurrents {
        bathymetry,
        columns: grid.columns,
        latitudes_deg: grid.latitudes_deg,
        longitudes_deg: grid.longitudes_deg,
        times_unix_s: times,
        layers: count,
        layer_depths_m: layers.depths_m,
        velocities_mps,
    };
    Ok((currents, report))
}
