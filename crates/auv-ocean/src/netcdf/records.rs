//! The records of a current in order of time.

use super::outer::Outer;
use super::roles::{Axis, axis_of};
use super::source::{Found, NetcdfError, Source};
use super::time;
use crate::FileReport;

/// The records in order of time: their times and their stored places.
pub(super) fn records(
    source: &Source,
    found: &Found<'_>,
    outer: &Outer,
    report: &mut FileReport,
) -> Result<(Vec<f64>, Vec<usize>), NetcdfError> {
    let Some(place) = outer.time else {
        report
            .assumed
            .push("the current has no time: it is taken as constant".into());
        return Ok((vec![0.0], vec![0]));
    };
    let dimension = &found.dimensions()[place];
    let clock = clock_of(source, dimension)?;
    let times = time::unix_seconds(&clock)?;
    report.variables.push(clock.report("time"));
    if times.undated {
        report.assumed.push(format!(
            "`{}` names no date: it counts from the model's own start",
            clock.name()
        ));
    }
    let kept = in_order(&clock, &times.unix_s, report)?;
    let times_unix_s: Vec<f64> = kept.iter().map(|&i| times.unix_s[i]).collect();
    if let (Some(&first), Some(&last)) = (times_unix_s.first(), times_unix_s.last()) {
        report.records = Some((first, last, times_unix_s.len()));
    }
    Ok((times_unix_s, kept))
}

/// The variable that holds the times along a dimension.
fn clock_of<'a>(
    source: &'a Source,
    dimension: &netcdf_reader::NcDimension,
) -> Result<Found<'a>, NetcdfError> {
    let mut clocks = Vec::new();
    for clock in source.all() {
        let own = matches!(clock.dimensions(), [own] if own.name == dimension.name);
        if own && axis_of(&clock)? == Some(Axis::Time) {
            clocks.push(clock);
        }
    }
    clocks.sort_by_key(|clock| clock.name() != dimension.name);
    clocks.first().copied().ok_or_else(|| NetcdfError::Missing {
        variable: "time",
        looked_for: format!(
            "a variable over `{}` with units like seconds since 2024-01-01, or ocean_time, time",
            dimension.name
        ),
    })
}

/// The stored places of the records in order of time, each time once.
fn in_order(
    clock: &Found<'_>,
    stored: &[f64],
    report: &mut FileReport,
) -> Result<Vec<usize>, NetcdfError> {
    let mut kept: Vec<usize> = (0..stored.len())
        .filter(|&i| stored[i].is_finite())
        .collect();
    let lost = stored.len() - kept.len();
    if kept
        .windows(2)
        .any(|pair| stored[pair[0]] > stored[pair[1]])
    {
        report.dropped.push(format!(
            "`{}`: records are not in order of time; they were sorted",
            clock.name()
        ));
    }
    kept.sort_by(|&a, &b| stored[a].total_cmp(&stored[b]));
    let before = kept.len();
    kept.dedup_by(|later, first| stored[*later] <= stored[*first]);
    for (count, what) in [
        (lost, "without a time"),
        (before - kept.len(), "of a time that an earlier one has"),
    ] {
        if count > 0 {
            report.dropped.push(format!(
                "`{}`: {count} records {what} are left out",
                clock.name()
            ));
        }
    }
    if kept.is_empty() {
        return Err(clock.error("has no time at all; give the times of the records"));
    }
    Ok(kept)
}

/// The records that hold any value: their times and velocities, layers in order.
pub(super) fn with_values(
    stored: &[[f32; 2]],
    (times_unix_s, kept): (&[f64], &[usize]),
    order: &[usize],
    points: usize,
) -> Result<(Vec<f64>, Vec<[f32; 2]>), NetcdfError> {
    let count = order.len();
    let mut times = Vec::with_capacity(times_unix_s.len());
    let mut velocities_mps = Vec::with_capacity(stored.len());
    for (&time_s, &record) in times_unix_s.iter().zip(kept) {
        let of = |layer: usize| {
            stored.get((record * count + layer) * points..(record * count + layer + 1) * points)
        };
        let whole: Vec<[f32; 2]> = order
            .iter()
            .filter_map(|&layer| of(layer))
            .flatten()
            .copied()
            .collect();
        if whole.len() != count * points {
            return Err(NetcdfError::Data {
                variable: "current".into(),
                reason: "has fewer records or layers than times and depths; give one for each"
                    .into(),
            });
        }
        if whole.iter().any(|v| v[0].is_finite() && v[1].is_finite()) {
            times.push(time_s);
            velocities_mps.extend(whole);
        }
    }
    if times.is_empty() {
        return Err(NetcdfError::Data {
            variable: "current".into(),
            reason: "is missing everywhere; give a file with water in it".into(),
        });
    }
    Ok((times, velocities_mps))
}
