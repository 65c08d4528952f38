//! Ships with a timetable and ships from recorded tracks.

use super::document::{AisEntry, MissionFile, ShipEntry};
use super::{DataFile, MissionData, MissionFileError};
use auv_obstacles::ais::{self, AisOptions, AssumedSize};
use auv_obstacles::truth::{ShipFix, TrackedShip};
use auv_ocean::{Geodetic, LocalFrame};
use auv_types::{Seed, Violations};

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
    // Names of ships in other alphabets' encodings are not used.
    let text = String::from_utf8_lossy(bytes);
    let options = AisOptions {
        fastest_mps: entry.fastest_mps.unwrap_or(ais::FASTEST_MPS),
        ..AisOptions::default()
    };
    let table = ais::parse_with(&text, &options).map_err(|error| failed(&error))?;
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
    let mut ships = Vec::with_capacity(table.ships.len());
    for ship in table.ships {
        match ship.tracked(&local, assumed, entry.after_last_fix) {
            Ok(ship) => ships.push(ship),
            Err(wrong) => violations.absorb(&format!("ais vessel {}: ", ship.vessel), wrong),
        }
    }
    Ok(ships)
}
