//! Ships with a timetable and ships from recorded tracks.

use super::document::{AisEntry, MissionFile, ShipEntry};
use super::{DataFile, MissionData, MissionFileError};
use auv_obstacles::ais::{self, AisFix, AssumedSize};
use auv_obstacles::truth::{ShipFix, TrackedShip};
use auv_ocean::{Geodetic, LocalFrame};
use auv_types::{Point3, Seed, Violations};

/// All ships: first those with a timetable, then the recorded ones.
pub(super) fn ships(
    file: &MissionFile,
    data: &MissionData<'_>,
    frame: Option<&LocalFrame>,
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
    if data.ais.is_some() || file.ais.is_some() {
        let entry = file.ais.clone().unwrap_or_default();
        ships.extend(recorded(&entry, data, frame, violations)?);
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
    data: &MissionData<'_>,
    frame: Option<&LocalFrame>,
    violations: &mut Violations,
) -> Result<Vec<TrackedShip>, MissionFileError> {
    let failed = |reason: &dyn std::fmt::Display| MissionFileError::data(DataFile::Ais, reason);
    let bytes = data
        .ais
        .ok_or_else(|| failed(&"the mission needs a table of ship tracks: hand one over"))?;
    let text = std::str::from_utf8(bytes).map_err(|error| {
        failed(&format!(
            "is not UTF-8 ({error}): give comma-separated text"
        ))
    })?;
    let table = ais::parse(text).map_err(|error| failed(&error))?;
    let Some(frame) = frame else {
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
    let fastest_mps = entry.fastest_mps.unwrap_or(30.0);
    violations.require_positive(assumed.length_m, "ais.assumed_length_m");
    violations.require_positive(assumed.draught_m, "ais.assumed_draught_m");
    violations.require_positive(fastest_mps, "ais.fastest_mps");
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
    let mut ships = Vec::with_capacity(table.ships.len());
    for mut ship in table.ships {
        ship.fixes = longest_track(&ship.fixes, fastest_mps, &local);
        match ship.tracked(&local, assumed, entry.after_last_fix) {
            Ok(ship) => ships.push(ship),
            Err(wrong) => violations.absorb(&format!("ais vessel {}: ", ship.vessel), wrong),
        }
    }
    Ok(ships)
}

/// The longest run of fixes without a jump. A stray fix, or two ships under one name, would give a ship
/// an impossible speed.
fn longest_track(
    fixes: &[AisFix],
    fastest_mps: f64,
    local: &dyn Fn(f64, f64) -> (f64, f64),
) -> Vec<AisFix> {
    let at = |fix: &AisFix| {
        let (north_m, east_m) = local(fix.latitude_deg, fix.longitude_deg);
        Point3::new(north_m, east_m, 0.0)
    };
    let sailable = |a: &AisFix, b: &AisFix| {
        // Fixes are rounded to several metres.
        (at(b) - at(a)).norm() <= fastest_mps * (b.time_s - a.time_s) + 50.0
    };
    fixes
        .chunk_by(sailable)
        .rev()
        .max_by_key(|run| run.len())
        .map(<[AisFix]>::to_vec)
        .unwrap_or_default()
}
