//! How a mission file overrides a preset.

use super::plain_words::plain;
use crate::PresetValues;
use crate::scans::scan_s;
use auv_mission::{ComputeCharge, ExpectedTime, SyncSettings};
use auv_planning::Budget;
use auv_types::Violations;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Longest mission, seconds: 100 days.
const LONGEST_S: f64 = 8_640_000.0;
/// Largest distance of any kind, metres.
const FARTHEST_M: f64 = 10_000.0;

/// Every invalid value, by its key in the file.
pub(super) fn check_values(values: &PresetValues) -> Violations {
    let mut violations = Violations::new();
    violations.absorb("vehicle.", values.vehicle.validate());
    violations.absorb("sonar.", values.sonar.validate());
    if values.sonar.validate().is_empty() {
        violations.absorb("tracker.", values.tracker.validate());
    }
    violations.absorb("clearance.", values.clearance.validate());
    violations.absorb("synchroniser.", values.synchroniser.validate());
    check_synchroniser(&values.synchroniser, &mut violations);
    check_sonar(values, &mut violations);
    violations.absorb("obstacle_motion.", values.obstacle_motion.validate());
    let mut within = |value: f64, least: f64, most: f64, place: &str| {
        violations.require((least..=most).contains(&value), place, || {
            format!("is {value}; give {least} to {most}")
        });
    };
    within(values.budget_s, 1.0, LONGEST_S, "budget_s");
    within(values.tick_s, 0.05, 600.0, "tick_s");
    within(values.guidance_error_m, 0.0, FARTHEST_M, "guidance_error_m");
    within(values.clearance_m, 0.0, FARTHEST_M, "clearance_m");
    within(values.min_altitude_m, 0.0, FARTHEST_M, "altitude.least_m");
    within(values.altitude_sigmas, 0.0, 100.0, "altitude.sigmas");
    violations
}

/// A part of a preset, overridden key by key by a table of the file.
pub(super) fn overridden<T: Serialize + DeserializeOwned>(
    preset: T,
    table: &toml::Table,
    place: &str,
    violations: &mut Violations,
) -> T {
    if table.is_empty() {
        return preset;
    }
    let overridden = toml::Table::try_from(&preset)
        .map_err(|error| error.to_string())
        .and_then(|whole| with_keys(&whole, table));
    match overridden {
        Ok(value) => value,
        Err(error) => {
            violations.push(
                format!("[{place}]"),
                format!("{error}; see docs/mission-file.md"),
            );
            preset
        }
    }
}

/// The settings of a preset with the keys of a table.
///
/// # Errors
/// A key that the settings do not have, or a value of the wrong kind, with its key.
fn with_keys<T: Serialize + DeserializeOwned>(
    preset: &toml::Table,
    table: &toml::Table,
) -> Result<T, String> {
    let parse = |keys: &toml::Table| -> Result<T, String> {
        let mut whole = preset.clone();
        override_keys(&mut whole, keys);
        let parsed = whole.try_into();
        parsed.map_err(|error: toml::de::Error| {
            let message = error.message().trim().replace('\n', ": ");
            plain(&message, None).unwrap_or(message)
        })
    };
    // Errors of settings in groups do not name their key: each key is tried alone.
    for (key, value) in table {
        let alone = toml::Table::from_iter([(key.clone(), value.clone())]);
        parse(&alone).map_err(|error| {
            if error.contains(key.as_str()) {
                error
            } else {
                format!("{key}: {error}")
            }
        })?;
    }
    let value = parse(table)?;
    // Settings in groups ignore keys that none of them has.
    let known = toml::Table::try_from(&value).map_err(|error| error.to_string())?;
    match table.keys().find(|key| !known.contains_key(*key)) {
        None => Ok(value),
        Some(key) => {
            let known: Vec<String> = known.keys().map(|key| format!("`{key}`")).collect();
            let known = known.join(", ");
            Err(format!("unknown key `{key}`, expected one of {known}"))
        }
    }
}

fn override_keys(whole: &mut toml::Table, table: &toml::Table) {
    for (key, value) in table {
        match (whole.get_mut(key), value) {
            (Some(toml::Value::Table(inner)), toml::Value::Table(over))
                if key.ends_with("budget") =>
            {
                override_keys(inner, over);
            }
            _ => {
                whole.insert(key.clone(), value.clone());
            }
        }
    }
}

/// Refuses a sonar that sees less far than the vehicle goes until what lies ahead, at rest, is confirmed, and
/// then needs to turn away from it. A vehicle that turns on the spot and can stand still needs no more.
fn check_sonar(values: &PresetValues, violations: &mut Violations) {
    let (vehicle, sonar, clearance) = (&values.vehicle, &values.sonar, &values.clearance);
    let scans = f64::from(values.tracker.confirm_hits) / sonar.detection_near;
    let confirmed_m = vehicle.speed_mps * scans * scan_s(values.tick_s, sonar.period_s);
    let (range_m, turn_m) = (sonar.range_m, vehicle.turn_radius_m);
    let clearance_m = if turn_m > 0.0 || vehicle.min_speed_mps > 0.0 {
        clearance.contact_m + clearance.tracking_error_m + values.clearance_m
    } else {
        0.0
    };
    let asked_m = confirmed_m + turn_m + clearance_m;
    // A sonar without echoes, and invalid numbers, are refused elsewhere or meant.
    let sees = !asked_m.is_finite() || range_m.is_nan() || range_m >= asked_m;
    violations.require(sees, "sonar.range_m", || {
        format!(
            "is {range_m}: what lies ahead is confirmed too late; give at least {asked_m:.1} m \
             ({confirmed_m:.1} m until it is confirmed, {turn_m} m to turn, {clearance_m} m of clearance), or \
             a smaller sonar.period_s, vehicle.speed_mps, vehicle.turn_radius_m, clearance.contact_m or \
             tracker.confirm_hits"
        )
    });
}

/// Refuses settings that make a mission unrepeatable.
fn check_synchroniser(settings: &SyncSettings, violations: &mut Violations) {
    let timed = |budget: &Budget| budget.wall_time.is_some() || budget.target_cost.is_some();
    for (budget, place) in [
        (&settings.planning.launch_budget, "launch_budget"),
        (&settings.planning.route_budget, "route_budget"),
        (&settings.planning.path_budget, "path_budget"),
    ] {
        let bounded = budget.evaluations.is_some() && !timed(budget);
        violations.require(bounded, &format!("synchroniser.{place}"), || {
            "is not limited by evaluations alone; give { evaluations = N }".into()
        });
    }
    violations.require(
        settings.planning.compute != ComputeCharge::Measured,
        "synchroniser.compute",
        || "is measured and cannot be repeated; give \"none\" or fixed".into(),
    );
    violations.require(
        !matches!(settings.replan.expected_time, ExpectedTime::Given(_)),
        "synchroniser",
        || "replays a script; leave out expected_time.given".into(),
    );
}
