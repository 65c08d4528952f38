//! One simulated mission with its true sea.

use auv_mission::{Mission, SyncSettings};
use auv_obstacles::truth::ObstacleField;
use auv_obstacles::{ClearancePolicy, Sonar, TrackerSettings};
use auv_ocean::{CurrentField, SeaBed};
use auv_types::{Seed, Violations};
use std::sync::Arc;

/// A mission with its true sea.
///
/// The synchroniser sees `mission`, the charted obstacles and the regions predicted from scans; `field`,
/// `true_current` and `true_bed` are the truth.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The mission's name, for logs.
    pub name: String,
    /// The name of its preset, for logs: `paper`, `default`, ...
    pub preset: String,
    /// The mission as the synchroniser knows it.
    pub mission: Arc<Mission>,
    /// Settings of the synchroniser.
    pub settings: SyncSettings,
    /// The true obstacles at mission time 0.
    pub field: ObstacleField,
    /// The true current. It moves drifting obstacles, and the vehicle if `current_moves_vehicle`.
    pub true_current: Option<Arc<dyn CurrentField>>,
    /// Whether the current moves the vehicle.
    pub current_moves_vehicle: bool,
    /// The true sea bed; `None`: the mission's.
    pub true_bed: Option<Arc<dyn SeaBed>>,
    /// The sonar.
    pub sonar: Sonar,
    /// The tracker.
    pub tracker: TrackerSettings,
    /// Margins by source of a region, in addition to the mission's clearance.
    pub clearance: ClearancePolicy,
    /// Time between two ticks of the synchroniser and between two scans, seconds.
    pub tick_s: f64,
    /// Greatest guidance error, metres: a slow, bounded deviation from the trajectory.
    pub guidance_error_m: f64,
    /// Seed of all random draws during the mission.
    pub seed: Seed,
}

impl Scenario {
    /// Every invalid value of the scenario, of its mission and of its settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.absorb("", self.mission.validate());
        violations.absorb("synchroniser.", self.settings.validate());
        violations.absorb("sonar.", self.sonar.validate());
        violations.absorb("tracker.", self.tracker.validate());
        violations.absorb("clearance.", self.clearance.validate());
        violations.require_positive(self.tick_s, "tick_s");
        violations.require_not_negative(self.guidance_error_m, "guidance_error_m");
        let start = self.mission.position_of(self.mission.start);
        let room_m = self.field.distance_m(&start);
        violations.require(room_m > 0.0, "start", || {
            format!(
                "lies {:.1} m inside an obstacle; move the start or the obstacle",
                -room_m
            )
        });
        violations
    }
}
