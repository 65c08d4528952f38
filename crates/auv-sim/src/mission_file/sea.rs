//! Sea bed and current of a mission file.

use super::document::{ChartEntry, CurrentEntry, MissionFile, ModelEntry};
use super::places::check_cell;
use super::{DataFile, DataReport, MissionData, MissionFileError};
use crate::PresetCurrent;
use crate::drawn_current::drawn_current;
use auv_ocean::{
    CurrentField, FileReport, FlatBed, ForecastError, LocalFrame, MapGrid, Perturbed, SeaBed,
    read_chart, read_model,
};
use auv_types::{Bounds, Point3, Seed, Violations};
use std::sync::Arc;

/// How far the gridded bed extends beyond the box, metres.
const MARGIN_M: f64 = 300.0;
/// Default depth levels of a modelled current, metres.
const LEVELS_M: [f64; 8] = [0.0, 5.0, 10.0, 20.0, 35.0, 50.0, 75.0, 100.0];
const UNSAID: &str = "is false, and nothing says how the water moves; give analytic or model, still = true, or leave it out for the preset's current";

/// The files beside a mission, and the report on them.
pub(super) struct Beside<'a> {
    pub(super) data: &'a MissionData<'a>,
    pub(super) frame: Option<&'a LocalFrame>,
    pub(super) report: &'a mut DataReport,
}

/// Where and how long the mission sails.
pub(super) struct Voyage<'a> {
    pub(super) points: &'a [Point3<f64>],
    /// Indices of start and destination.
    pub(super) ends: [usize; 2],
    pub(super) speed_mps: f64,
    pub(super) budget_s: f64,
}

impl Voyage<'_> {
    /// Time of the straight way from start to destination, seconds.
    fn least_s(&self) -> f64 {
        let [start, destination] = self.ends.map(|i| self.points.get(i));
        let way_m = start.zip(destination).map_or(0.0, |(a, b)| (b - a).norm());
        way_m / self.speed_mps
    }
}

/// The sea bed; `None` if the file states none.
pub(super) fn sea_bed(
    file: &MissionFile,
    beside: &mut Beside<'_>,
    bounds: Option<&Bounds>,
    violations: &mut Violations,
) -> Result<Option<Arc<dyn SeaBed>>, MissionFileError> {
    let entry = file.sea_bed.clone().unwrap_or_default();
    if beside.data.bathymetry.is_some() || entry.chart.is_some() {
        let chart = entry.chart.unwrap_or_default();
        return charted(&chart, beside, bounds, violations);
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

/// The bed of a chart.
fn charted(
    chart: &ChartEntry,
    beside: &mut Beside<'_>,
    bounds: Option<&Bounds>,
    violations: &mut Violations,
) -> Result<Option<Arc<dyn SeaBed>>, MissionFileError> {
    let failed =
        |reason: &dyn std::fmt::Display| MissionFileError::data(DataFile::Bathymetry, reason);
    let bytes = beside
        .data
        .bathymetry
        .ok_or_else(|| failed(&"the mission needs a chart of depths: hand one over"))?;
    violations.absorb("sea_bed.chart.sigma.", chart.sigma.validate());
    check_cell(chart.cell_m, "sea_bed.chart.cell_m", violations);
    let Some(frame) = beside.frame else {
        violations.push(
            "datum",
            "is missing: a chart needs the [datum] of the local frame",
        );
        return Ok(None);
    };
    let (depths, mut read) = read_chart(bytes).map_err(|error| failed(&error))?;
    read.vertical = Some(vertical(chart));
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
            if let Ok(nodes @ 1..) = depths.overlaps(frame, &grid) {
                read.dropped.push(format!(
                    "{nodes} places lie in several cells of the chart: the smallest counts"
                ));
            }
            depths.to_bed_on(frame, grid)
        }
        None => depths.to_bed(frame, cell_m),
    };
    beside.report.add(DataFile::Bathymetry, read);
    match bed {
        Ok(bed) => Ok(Some(Arc::new(bed.with_sigma(chart.sigma)))),
        Err(wrong) => {
            violations.absorb("sea_bed.chart.", wrong);
            Ok(None)
        }
    }
}

/// What the depths are measured from, as the mission says.
fn vertical(chart: &ChartEntry) -> String {
    let from = match chart.datum.as_deref() {
        None | Some("chart") => "chart datum",
        Some("lat") => "lowest astronomical tide (lat)",
        Some("msl") => "mean sea level (msl)",
        Some(other) => other,
    };
    format!("depths are taken as measured from {from}; nothing is converted")
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
    beside: &mut Beside<'_>,
    (voyage, seed): (&Voyage<'_>, Seed),
    violations: &mut Violations,
) -> Result<Water, MissionFileError> {
    let entry = file.current.clone().unwrap_or_default();
    let preset = file.preset.values().current;
    let tidal = matches!(preset, PresetCurrent::Tidal(_));
    let moves_vehicle = entry.moves_vehicle.unwrap_or(tidal);
    let forecast: Option<Arc<dyn CurrentField>> =
        if beside.data.currents.is_some() || entry.model.is_some() {
            let model = entry.model.clone().unwrap_or_default();
            modelled(&model, beside, (voyage, file.launch_unix_s), violations)?
        } else if entry.still == Some(true) && entry.analytic.is_none() {
            None
        } else if let Some(analytic) = entry.analytic.clone() {
            let wrong = analytic.validate();
            violations.require(entry.still != Some(true), "current", || {
                "is still and analytic; keep one".into()
            });
            let sound = wrong.is_empty();
            violations.absorb("current.analytic.", wrong);
            sound.then(|| Arc::new(analytic) as _)
        } else {
            violations.require(entry.still.is_none(), "current.still", || UNSAID.into());
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

/// The current of a model's file.
fn modelled(
    model: &ModelEntry,
    beside: &mut Beside<'_>,
    (voyage, launch_unix_s): (&Voyage<'_>, Option<f64>),
    violations: &mut Violations,
) -> Result<Option<Arc<dyn CurrentField>>, MissionFileError> {
    let failed =
        |reason: &dyn std::fmt::Display| MissionFileError::data(DataFile::Currents, reason);
    let bytes = beside.data.currents.ok_or_else(|| {
        failed(&"the mission needs the NetCDF file of an ocean model: hand one over")
    })?;
    let Some(frame) = beside.frame else {
        violations.push(
            "datum",
            "is missing: a model's current needs the [datum] of the local frame",
        );
        return Ok(None);
    };
    let given_s = model.start_after_first_record_s;
    violations.require(
        given_s.is_none_or(f64::is_finite),
        "current.model.start_after_first_record_s",
        || "is not finite; give seconds".into(),
    );
    violations.require(
        given_s.is_none() || launch_unix_s.is_none(),
        "current.model.start_after_first_record_s",
        || "and launch both say when the mission begins; keep one".into(),
    );
    check_cell(model.cell_m, "current.model.cell_m", violations);
    let (output, mut read) = read_model(bytes).map_err(|error| failed(&error))?;
    if !violations.is_empty() {
        return Ok(None);
    }
    let first_s = output.times_unix_s().first().copied().unwrap_or(0.0);
    let last_s = output.times_unix_s().last().copied().unwrap_or(0.0);
    let after_s = given_s.or_else(|| Some(launch_unix_s? - first_s));
    let after_s = after_s.unwrap_or(0.0);
    let records = (last_s - first_s, after_s);
    check_records(model, records, voyage, &mut read, violations);
    beside.report.add(DataFile::Currents, read);
    let levels_m = model.levels_m.clone().unwrap_or_else(|| LEVELS_M.to_vec());
    let cell_m = model.cell_m.unwrap_or(1_000.0);
    match output.to_current(frame, cell_m, &levels_m, first_s + after_s) {
        Ok(current) => {
            // Outside the model the current would be zero, which is not a forecast.
            for (i, place) in voyage.points.iter().enumerate() {
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

/// Checks that the mission begins within the records and that they last for the straight way to the
/// destination at least; says what is constant beyond them. One record is constant by nature.
fn check_records(
    model: &ModelEntry,
    (length_s, start_s): (f64, f64),
    voyage: &Voyage<'_>,
    read: &mut FileReport,
    violations: &mut Violations,
) {
    if length_s <= 0.0 {
        read.assumed
            .push("the current of the only record holds at all times".into());
        return;
    }
    let remedy = "give a file with records of that time, or set version = 2 and current.model.extrapolate = true to \
                  hold the nearest record";
    let place = "current.model";
    let left_s = length_s - start_s;
    if !model.extrapolate {
        violations.require(start_s >= 0.0, place, || {
            format!(
                "has its first record {:.0} s after the mission starts; {remedy}",
                -start_s
            )
        });
        violations.require(left_s >= 0.0, place, || {
            format!(
                "has its last record {:.0} s before the mission starts; {remedy}",
                -left_s
            )
        });
        let least_s = voyage.least_s();
        violations.require(left_s < 0.0 || left_s >= least_s, place, || {
            format!(
                "has its last record {left_s:.0} s after the mission starts, and the straight way to the destination \
                 takes {least_s:.0} s; {remedy}"
            )
        });
    }
    if start_s < 0.0 {
        read.assumed.push(format!(
            "the mission starts {:.0} s before the first record, which is held until then",
            -start_s
        ));
    }
    if left_s < voyage.budget_s {
        read.assumed.push(format!(
            "the last record is {left_s:.0} s after the mission's start and is held from then on, up to the budget \
             of {:.0} s",
            voyage.budget_s
        ));
    }
}
