//! Ships with a timetable and ships from recorded tracks.

use super::document::{AisEntry, MissionFile, ShipEntry};
use super::sea::Beside;
use super::{DataFile, MissionFileError};
use auv_obstacles::ais::{self, AisOptions, AisTable, AssumedSize};
use auv_obstacles::truth::{ShipFix, TrackedShip};
use auv_ocean::{FileReport, Geodetic};
use auv_types::{Seed, Violations};
use std::borrow::Cow;

/// All ships: first those with a timetable, then the recorded ones.
pub(super) fn ships(
    file: &MissionFile,
    beside: &mut Beside<'_>,
    seed: Seed,
    violations: &mut Violations,
) -> Result<Vec<TrackedShip>, MissionFileError> {
    let mut ships = Vec::new();
    for (i, entry) in file.ships.iter().enumerate() {
        let place = format!("ships[{i}] ({})", entry.name);
        match on_timetable(entry, seed, i as u64, &place, violations) {
            Ok(ship) => ships.push(ship),
            Err(wrong) => violations.absorb(&format!("{place}."), wrong),
        }
    }
    if beside.data.ais.is_some() || file.ais.is_some() {
        let entry = file.ais.clone().unwrap_or_default();
        ships.extend(recorded(&entry, beside, file.launch_unix_s, violations)?);
    }
    Ok(ships)
}

/// The ship of a timetable, with its random delay.
fn on_timetable(
    entry: &ShipEntry,
    seed: Seed,
    index: u64,
    place: &str,
    violations: &mut Violations,
) -> Result<TrackedShip, Violations> {
    let late_s = entry.delay_s.map_or(0.0, |delay| {
        let mut random = seed.stream(index);
        delay.draw(&format!("{place}.delay_s"), &mut random, violations)
    });
    let fixes = entry
        .timetable
        .iter()
        .map(|&[time_s, north_m, east_m]| ShipFix {
            time_s: time_s + late_s,
            north_m,
            east_m,
        });
    TrackedShip::new(
        fixes.collect(),
        entry.length_m,
        entry.draught_m,
        entry.after_last_fix,
    )
}

/// The recorded ships, shifted as the file states.
fn recorded(
    entry: &AisEntry,
    beside: &mut Beside<'_>,
    launch_unix_s: Option<f64>,
    violations: &mut Violations,
) -> Result<Vec<TrackedShip>, MissionFileError> {
    let failed = |reason: &dyn std::fmt::Display| MissionFileError::data(DataFile::Ais, reason);
    let bytes = beside
        .data
        .ais
        .ok_or_else(|| failed(&"the mission needs a table of ship tracks: hand one over"))?;
    let text = text_of(bytes).map_err(|reason| failed(&reason))?;
    let options = AisOptions {
        fastest_mps: entry.fastest_mps.unwrap_or(ais::FASTEST_MPS),
        columns: entry.columns.clone().unwrap_or_default(),
    };
    let table = ais::parse_with(&text, &options).map_err(|error| failed(&error))?;
    let Some(frame) = beside.frame else {
        violations.push(
            "datum",
            "is missing: ship tracks need the [datum] of the local frame",
        );
        return Ok(Vec::new());
    };
    let defaults = AssumedSize::default();
    let assumed = AssumedSize {
        length_m: entry.assumed_length_m.unwrap_or(defaults.length_m),
        draught_m: entry.assumed_draught_m.unwrap_or(defaults.draught_m),
    };
    violations.require_positive(assumed.length_m, "ais.assumed_length_m");
    violations.require_positive(assumed.draught_m, "ais.assumed_draught_m");
    violations.require_positive(options.fastest_mps, "ais.fastest_mps");
    let shift = [entry.shift_north_m, entry.shift_east_m];
    violations.require(shift.iter().all(|x| x.is_finite()), "ais", || {
        format!("shifts by {shift:?}; give finite metres")
    });
    if !violations.is_empty() {
        return Ok(Vec::new());
    }
    let local = |latitude_deg: f64, longitude_deg: f64| {
        let point = frame.to_local(&Geodetic {
            latitude_deg,
            longitude_deg,
            depth_m: 0.0,
        });
        (point.x + shift[0], point.y + shift[1])
    };
    let mut read = told(&table, assumed);
    let late_s = launch_unix_s.map_or(0.0, |launch_s| late_s(&mut read, launch_s));
    beside.report.add(DataFile::Ais, read);
    let mut ships = Vec::with_capacity(table.ships.len());
    for ship in table.ships {
        match ship.tracked(&local, assumed, entry.after_last_fix) {
            Ok(ship) => ships.push(ship.delayed(late_s)),
            Err(wrong) => violations.absorb(&format!("ais vessel {}: ", ship.vessel), wrong),
        }
    }
    Ok(ships)
}

/// By how much later than the launch the tracks begin, seconds. Tracks of another time begin at the launch, and
/// the report says so.
fn late_s(read: &mut FileReport, launch_s: f64) -> f64 {
    match read.records {
        Some((first_s, last_s, _)) if (first_s..=last_s).contains(&launch_s) => first_s - launch_s,
        _ => {
            let assumed =
                "the launch is not within the time of the tracks: they begin at the launch";
            read.assumed.push(assumed.into());
            0.0
        }
    }
}

/// The text of a table. Names of ships in other alphabets' encodings are not used, so these may be lost;
/// UTF-16 would lose the names of the columns too.
fn text_of(bytes: &[u8]) -> Result<Cow<'_, str>, &'static str> {
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err("is UTF-16, which is not read; save it as UTF-8");
    }
    Ok(String::from_utf8_lossy(bytes))
}

/// What was read from a table of ship positions.
fn told(table: &AisTable, assumed: AssumedSize) -> FileReport {
    let fixes = || table.ships.iter().flat_map(|ship| &ship.fixes);
    let mut extent = [90.0, -90.0, 180.0, -180.0_f64];
    let (mut last_s, mut count) = (0.0_f64, 0);
    for fix in fixes() {
        extent = [
            extent[0].min(fix.latitude_deg),
            extent[1].max(fix.latitude_deg),
            extent[2].min(fix.longitude_deg),
            extent[3].max(fix.longitude_deg),
        ];
        last_s = last_s.max(fix.time_s);
        count += 1;
    }
    let mut dropped = Vec::new();
    if let Some(first) = table.skipped.list().first() {
        let rows = table.skipped.total();
        dropped.push(format!(
            "{rows} rows are left out; the first: {} {}",
            first.place, first.message
        ));
    }
    dropped.extend(table.notes.iter().cloned());
    let without = |size: fn(&ais::AisShip) -> Option<f64>| {
        table
            .ships
            .iter()
            .filter(|ship| size(ship).is_none())
            .count()
    };
    let mut presumed = Vec::new();
    for (ships, what, metres) in [
        (without(|ship| ship.length_m), "length", assumed.length_m),
        (without(|ship| ship.draught_m), "draught", assumed.draught_m),
    ] {
        if ships > 0 {
            presumed.push(format!(
                "{ships} ships report no {what}: {metres} m is assumed"
            ));
        }
    }
    FileReport {
        format: format!("comma-separated text, {} ships", table.ships.len()),
        extent_deg: Some(extent),
        records: Some((table.start_unix_s, table.start_unix_s + last_s, count)),
        dropped,
        assumed: presumed,
        ..FileReport::default()
    }
}
