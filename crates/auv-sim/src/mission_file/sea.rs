//! Sea bed and current of a mission file.

use super::document::{ChartEntry, CurrentEntry, MissionFile, ModelEntry};
use super::places::check_cell;
use super::{DataFile, MissionData, MissionFileError};
use crate::PresetCurrent;
use crate::drawn_current::drawn_current;
use auv_ocean::netcdf::{RomsOutput, read_bathymetry};
use auv_ocean::{CurrentField, FlatBed, ForecastError, LocalFrame, MapGrid, Perturbed, SeaBed};
use auv_types::{Bounds, Point3, Seed, Violations};
use std::sync::Arc;

/// How far the gridded bed extends beyond the box, metres.
const MARGIN_M: f64 = 300.0;
/// Default depth levels of a modelled current, metres.
const LEVELS_M: [f64; 8] = [0.0, 5.0, 10.0, 20.0, 35.0, 50.0, 75.0, 100.0];

/// The sea bed; `None` if the file states none.
pub(super) fn sea_bed(
    file: &MissionFile,
    data: &MissionData<'_>,
    frame: Option<&LocalFrame>,
    bounds: Option<&Bounds>,
    violations: &mut Violations,
) -> Result<Option<Arc<dyn SeaBed>>, MissionFileError> {
    let entry = file.sea_bed.clone().unwrap_or_default();
    if data.bathymetry.is_some() || entry.chart.is_some() {
        let chart = entry.chart.unwrap_or_default();
        return charted(&chart, data, frame, bounds, violations);
    }
    match (entry.flat_m, entry.analytic) {
        (Some(depth_m), None) => {
            violations.require_positive(depth_m, "sea_bed.flat_m");
            Ok(depth_m
                .is_finite()
                .then(|| Arc::new(FlatBed::new(depth_m)) as _))
        }
        (None, Some(bed)) => {
            let wrong = bed.validate();
            if wrong.is_empty() {
                return Ok(Some(Arc::new(bed)));
            }
            violations.absorb("sea_bed.analytic.", wrong);
            Ok(None)
        }
        (None, None) if file.sea_bed.is_none() => Ok(None),
        _ => {
            violations.push(
                "sea_bed",
                "needs exactly one of flat_m, analytic and chart; keep one",
            );
            Ok(None)
        }
    }
}

/// The bed of a NetCDF chart.
fn charted(
    chart: &ChartEntry,
    data: &MissionData<'_>,
    frame: Option<&LocalFrame>,
    bounds: Option<&Bounds>,
    violations: &mut Violations,
) -> Result<Option<Arc<dyn SeaBed>>, MissionFileError> {
    let failed =
        |reason: &dyn std::fmt::Display| MissionFileError::data(DataFile::Bathymetry, reason);
    let bytes = data
        .bathymetry
        .ok_or_else(|| failed(&"the mission needs a NetCDF chart of depths: hand one over"))?;
    violations.absorb("sea_bed.chart.sigma.", chart.sigma.validate());
    check_cell(chart.cell_m, "sea_bed.chart.cell_m", violations);
    let Some(frame) = frame else {
        violations.push(
            "datum",
            "is missing: a chart needs the [datum] of the local frame",
        );
        return Ok(None);
    };
    let depths = read_bathymetry(bytes).map_err(|error| failed(&error))?;
    if !violations.is_empty() {
        return Ok(None);
    }
    let cell_m = chart.cell_m.unwrap_or(50.0);
    let bed = match bounds {
        Some(bounds) => {
            let grid = MapGrid::covering(
                [bounds.low.x - MARGIN_M, bounds.low.y - MARGIN_M],
                [bounds.high.x + MARGIN_M, bounds.high.y + MARGIN_M],
                cell_m,
            );
            depths.to_bed_on(frame, grid)
        }
        None => depths.to_bed(frame, cell_m),
    };
    match bed {
        Ok(bed) => Ok(Some(Arc::new(bed.with_sigma(chart.sigma)))),
        Err(wrong) => {
            violations.absorb("sea_bed.chart.", wrong);
            Ok(None)
        }
    }
}

/// The forecast current and the true one.
#[derive(Clone, Debug)]
pub(super) struct Water {
    pub(super) forecast: Option<Arc<dyn CurrentField>>,
    pub(super) truth: Option<Arc<dyn CurrentField>>,
    pub(super) moves_vehicle: bool,
}

/// The current of a mission file, forecast and true.
pub(super) fn water(
    file: &MissionFile,
    data: &MissionData<'_>,
    frame: Option<&LocalFrame>,
    (waypoints, seed): (&[Point3<f64>], Seed),
    violations: &mut Violations,
) -> Result<Water, MissionFileError> {
    let entry = file.current.clone().unwrap_or_default();
    let preset = file.preset.values().current;
    let tidal = matches!(preset, PresetCurrent::Tidal(_));
    let moves_vehicle = entry.moves_vehicle.unwrap_or(tidal);
    let forecast: Option<Arc<dyn CurrentField>> =
        if data.currents.is_some() || entry.model.is_some() {
            let model = entry.model.clone().unwrap_or_default();
            modelled(&model, data, frame, waypoints, violations)?
        } else if entry.still && entry.analytic.is_none() {
            None
        } else if let Some(analytic) = entry.analytic.clone() {
            let wrong = analytic.validate();
            violations.require(!entry.still, "current", || {
                "is still and analytic; keep one".into()
            });
            let sound = wrong.is_empty();
            violations.absorb("current.analytic.", wrong);
            sound.then(|| Arc::new(analytic) as _)
        } else {
            match preset {
                PresetCurrent::Drawn { speed_sigma_mps } => {
                    Some(drawn_current(speed_sigma_mps, seed.split(0)))
                }
                PresetCurrent::Tidal(tide) => Some(Arc::new(tide)),
            }
        };
    let truth = forecast
        .clone()
        .map(|forecast| true_current(forecast, &entry, tidal, seed.split(1), violations));
    Ok(Water {
        forecast,
        truth,
        moves_vehicle,
    })
}

/// The forecast with the error the file states. Without a statement, a preset with a tide draws an error
/// and the others have none.
fn true_current(
    forecast: Arc<dyn CurrentField>,
    entry: &CurrentEntry,
    tidal: bool,
    seed: Seed,
    violations: &mut Violations,
) -> Arc<dyn CurrentField> {
    let error = match entry.truth {
        Some(truth) => {
            let mut random = seed.stream(0);
            ForecastError {
                gain: truth
                    .gain
                    .draw("current.truth.gain", &mut random, violations),
                delay_s: truth
                    .delay_s
                    .draw("current.truth.delay_s", &mut random, violations),
            }
        }
        None if !tidal => return forecast,
        None => ForecastError::draw(seed),
    };
    violations.absorb("current.truth.", error.validate());
    Arc::new(Perturbed::new(forecast, error))
}

/// The current of a NetCDF model file.
fn modelled(
    model: &ModelEntry,
    data: &MissionData<'_>,
    frame: Option<&LocalFrame>,
    waypoints: &[Point3<f64>],
    violations: &mut Violations,
) -> Result<Option<Arc<dyn CurrentField>>, MissionFileError> {
    let failed =
        |reason: &dyn std::fmt::Display| MissionFileError::data(DataFile::Currents, reason);
    let bytes = data
        .currents
        .ok_or_else(|| failed(&"the mission needs a NetCDF file of a ROMS model: hand one over"))?;
    let Some(frame) = frame else {
        violations.push(
            "datum",
            "is missing: a model's current needs the [datum] of the local frame",
        );
        return Ok(None);
    };
    let after_s = model.start_after_first_record_s;
    violations.require(
        after_s.is_finite(),
        "current.model.start_after_first_record_s",
        || "is not finite; give seconds".into(),
    );
    check_cell(model.cell_m, "current.model.cell_m", violations);
    let output = RomsOutput::read(bytes).map_err(|error| failed(&error))?;
    if !violations.is_empty() {
        return Ok(None);
    }
    let first_s = output.times_unix_s().first().copied().unwrap_or(0.0);
    let levels_m = model.levels_m.clone().unwrap_or_else(|| LEVELS_M.to_vec());
    let cell_m = model.cell_m.unwrap_or(1_000.0);
    match output.to_current(frame, cell_m, &levels_m, first_s + after_s) {
        Ok(current) => {
            // Outside the model the current would be zero, which is not a forecast.
            for (i, place) in waypoints.iter().enumerate() {
                let covered = current.grid().contains([place.x, place.y]);
                violations.require(covered, &format!("waypoints[{i}]"), || {
                    "lies outside the model of the current; move it or give a model of the place".into()
                });
            }
            Ok(Some(Arc::new(current)))
        }
        Err(wrong) => {
            violations.absorb("current.model.", wrong);
            Ok(None)
        }
    }
}
