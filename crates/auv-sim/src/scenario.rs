//! One simulated mission: what is known, and what is true.

use auv_mission::{Mission, SyncSettings};
use auv_obstacles::truth::ObstacleField;
use auv_obstacles::{ClearancePolicy, Sonar, TrackerSettings};
use auv_ocean::{CurrentField, SeaBed};
use auv_types::{Seed, Violations};
use std::sync::Arc;

/// A mission with its sea. The synchroniser sees `mission`, the sonar's scans and what is charted;
/// `field`, `true_current` and `true_bed` are the truth.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Its name.
    pub name: String,
    /// Which set of numbers it flies with: `paper`, `default`, ...
    pub preset: String,
    /// What the synchroniser knows.
    pub mission: Arc<Mission>,
    /// How the synchroniser decides.
    pub settings: SyncSettings,
    /// The true obstacles at mission time 0.
    pub field: ObstacleField,
    /// The true current: it moves floating obstacles, and the vehicle where `current_moves_vehicle`.
    pub true_current: Option<Arc<dyn CurrentField>>,
    /// Whether the current moves the vehicle.
    pub current_moves_vehicle: bool,
    /// The true sea bed (`None`: as charted in the mission).
    pub true_bed: Option<Arc<dyn SeaBed>>,
    /// The sonar.
    pub sonar: Sonar,
    /// The tracker.
    pub tracker: TrackerSettings,
    /// Distances kept by kind of obstacle, beyond the mission's clearance.
    pub clearance: ClearancePolicy,
    /// Time between two scans, seconds.
    pub tick_s: f64,
    /// Greatest distance between the vehicle and where guidance wants it, metres: a slow wander.
    pub guidance_error_m: f64,
    /// Seed of everything random in the mission.
    pub seed: Seed,
}

impl Scenario {
    /// Everything wrong with the scenario, mission and settings included.
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
