//! Presets, and how a mission file overrides them.

use auv_mission::{Acceptance, ComputeCharge, ExpectedTime, SyncSettings};
use auv_obstacles::truth::FieldSettings;
use auv_obstacles::{ClearancePolicy, Sonar, TrackerSettings};
use auv_planning::{Budget, Vehicle};
use auv_types::Violations;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// A consistent set of values for vehicle, sonar, tracker, clearance, current, obstacle motion,
/// synchroniser and reserve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Preset {
    /// The paper's vehicle: 3 m/s, able to hover, a sonar that sees 1000 m all round, not moved by the
    /// current.
    Paper,
    /// A survey vehicle of 2 m length: 1.5 m/s, unable to stop, a sonar that sees 100 m ahead, moved by
    /// the tide.
    Default,
    /// The paper's mission at half the speeds and twice the budget: 1.5 m/s.
    PaperAtSea,
}

/// The values of a preset.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    pub(super) vehicle: Vehicle,
    pub(super) sonar: Sonar,
    pub(super) tracker: TrackerSettings,
    pub(super) clearance: ClearancePolicy,
    pub(super) synchroniser: SyncSettings,
    pub(super) obstacle_motion: FieldSettings,
    pub(super) budget_s: f64,
    pub(super) reserve_share: f64,
    pub(super) tick_s: f64,
    pub(super) guidance_error_m: f64,
    pub(super) clearance_m: f64,
    pub(super) min_altitude_m: f64,
    pub(super) altitude_sigmas: f64,
}

/// Longest mission, seconds: 100 days.
const LONGEST_S: f64 = 8_640_000.0;
/// Largest distance of any kind, metres.
const FARTHEST_M: f64 = 10_000.0;

impl Preset {
    /// Its name in files and tables.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Default => "default",
            Self::PaperAtSea => "paper_at_sea",
        }
    }

    pub(super) fn numbers(self) -> Numbers {
        match self {
            Self::Paper => Numbers::paper(),
            Self::Default => Numbers::survey(),
            Self::PaperAtSea => {
                let mut numbers = Numbers::paper();
                numbers.vehicle.speed_mps *= 0.5;
                numbers.vehicle.max_speed_mps *= 0.5;
                numbers.obstacle_motion.jitter_mps *= 0.5;
                numbers.budget_s *= 2.0;
                numbers
            }
        }
    }

    /// Standard deviation of the drawn current's speed, m/s; `None` for a preset with a tide.
    pub(super) const fn drawn_current_mps(self) -> Option<f64> {
        match self {
            Self::Paper => Some(0.3),
            Self::PaperAtSea => Some(0.15),
            Self::Default => None,
        }
    }
}

impl Numbers {
    /// Every invalid value, by its key in the file.
    pub(super) fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.absorb("vehicle.", self.vehicle.validate());
        violations.absorb("sonar.", self.sonar.validate());
        if self.sonar.validate().is_empty() {
            violations.absorb("tracker.", self.tracker.validate());
        }
        violations.absorb("clearance.", self.clearance.validate());
        violations.absorb("synchroniser.", self.synchroniser.validate());
        check_synchroniser(&self.synchroniser, &mut violations);
        violations.absorb("obstacle_motion.", self.obstacle_motion.validate());
        let mut within = |value: f64, least: f64, most: f64, place: &str| {
            violations.require((least..=most).contains(&value), place, || {
                format!("is {value}; give {least} to {most}")
            });
        };
        within(self.budget_s, 1.0, LONGEST_S, "budget_s");
        within(self.tick_s, 0.05, 600.0, "tick_s");
        within(self.guidance_error_m, 0.0, FARTHEST_M, "guidance_error_m");
        within(self.clearance_m, 0.0, FARTHEST_M, "clearance_m");
        within(self.min_altitude_m, 0.0, FARTHEST_M, "altitude.least_m");
        within(self.altitude_sigmas, 0.0, 100.0, "altitude.sigmas");
        violations
    }

    fn paper() -> Self {
        Self {
            vehicle: Vehicle::paper(),
            sonar: Sonar::paper(),
            tracker: TrackerSettings::paper(),
            clearance: ClearancePolicy::paper(),
            synchroniser: SyncSettings::paper(),
            obstacle_motion: FieldSettings::paper(),
            budget_s: 10_800.0,
            reserve_share: 0.0,
            tick_s: 10.0,
            guidance_error_m: 0.0,
            clearance_m: 0.0,
            min_altitude_m: 0.0,
            altitude_sigmas: 0.0,
        }
    }

    fn survey() -> Self {
        Self {
            vehicle: Vehicle::default(),
            sonar: Sonar::default(),
            // Every second scan is used. Two false echoes per scan must not form tracks that block the
            // vehicle for minutes: confirmation is stricter, and the prior speed of contacts is lower.
            tracker: TrackerSettings {
                confirm_hits: 5,
                confirm_window: 7,
                first_speed_mps: 0.5,
                ..TrackerSettings::default()
            },
            clearance: ClearancePolicy::default(),
            synchroniser: SyncSettings {
                detour_margin: 0.03,
                detour_margin_s: 2.0,
                off_track_m: 10.0,
                // A contact from beyond the sonar's 100 m is not near before that time.
                sonar_silence_s: 40.0,
                ..SyncSettings::default()
            },
            obstacle_motion: FieldSettings {
                jitter_mps: 0.02,
                fluctuation_ratio: 0.1,
                min_radius_m: 1.0,
                max_growth: 1.5,
                ..FieldSettings::campaign()
            },
            budget_s: 21_600.0,
            reserve_share: 0.15,
            tick_s: 1.0,
            guidance_error_m: 2.0,
            clearance_m: 0.0,
            min_altitude_m: 5.0,
            altitude_sigmas: 2.0,
        }
    }
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
        .and_then(|mut whole| {
            override_keys(&mut whole, table);
            whole
                .try_into()
                .map_err(|error: toml::de::Error| error.message().trim().replace('\n', ": "))
        });
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

/// Refuses settings that make a mission unrepeatable.
fn check_synchroniser(settings: &SyncSettings, violations: &mut Violations) {
    let timed = |budget: &Budget| budget.wall_time.is_some() || budget.target_cost.is_some();
    for (budget, place) in [
        (&settings.launch_budget, "launch_budget"),
        (&settings.route_budget, "route_budget"),
        (&settings.path_budget, "path_budget"),
    ] {
        let bounded = budget.evaluations.is_some() && !timed(budget);
        violations.require(bounded, &format!("synchroniser.{place}"), || {
            "is not limited by evaluations alone; give { evaluations = N }".into()
        });
    }
    violations.require(
        settings.compute != ComputeCharge::Measured,
        "synchroniser.compute",
        || "is measured and cannot be repeated; give \"none\" or fixed".into(),
    );
    violations.require(
        settings.acceptance == Acceptance::Verified
            && !matches!(settings.expected_time, ExpectedTime::Given(_)),
        "synchroniser",
        || "replays a script; leave out acceptance and expected_time.given".into(),
    );
}
