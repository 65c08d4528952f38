//! When a sensor, the clock or the mission itself has failed.

use auv_types::Violations;

/// What the vehicle does when its sonar stays silent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum WithoutSonar {
    /// The mission is aborted along its contingencies; by default the vehicle surfaces. It meets
    /// moving obstacles unseen for a minute instead of the whole way home.
    GiveUp,
    /// It takes the quickest way home and leaves tasks undone. For water where nothing moves.
    GoHome,
}

/// Also of saved states that do not have it.
const fn cannot_follow_s() -> f64 {
    600.0
}

/// When a sensor, the clock or the mission itself has failed.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WatchdogSettings {
    /// Silence of the sonar after which the vehicle leaves its tasks, seconds. It should be shorter
    /// than an obstacle needs from beyond the sonar's range to the vehicle.
    pub sonar_silence_s: f64,
    /// What the vehicle does then.
    pub without_sonar: WithoutSonar,
    /// After the first altitude, a silence longer than this ends the mission, seconds.
    pub altitude_silence_s: f64,
    /// Ticks in a row at which the clock may stand still. Allow more where ticks come faster than the
    /// clock counts. A vehicle that steers by a stopped clock stays where it is.
    pub clock_stalls: u32,
    /// How long dead reckoning replaces fixes that are missing or implausible, seconds.
    pub position_silence_s: f64,
    /// The mission is aborted when the vehicle leaves one trajectory after the other for longer than this, seconds,
    /// and comes nearer to its target at less than a quarter of its speed.
    #[cfg_attr(feature = "serde", serde(default = "cannot_follow_s"))]
    pub cannot_follow_s: f64,
    /// The mission is aborted when it lasts this many times its budget.
    pub timeout_factor: f64,
}

impl WatchdogSettings {
    /// The default for a sonar of 1000 m: it may be silent for longer. The paper does not mention failed
    /// sensors.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            sonar_silence_s: 120.0,
            ..Self::default()
        }
    }

    pub(super) fn validate_into(&self, violations: &mut Violations) {
        violations.require_not_negative(self.sonar_silence_s, "sonar_silence_s");
        violations.require_not_negative(self.position_silence_s, "position_silence_s");
        violations.require_not_negative(self.altitude_silence_s, "altitude_silence_s");
        violations.require_positive(self.cannot_follow_s, "cannot_follow_s");
        violations.require_positive(self.timeout_factor, "timeout_factor");
    }
}

impl Default for WatchdogSettings {
    /// A survey vehicle with a sonar of 100 m. A mission file's `preset = "default"` has the same values.
    fn default() -> Self {
        Self {
            // A contact from beyond the default sonar's 100 m is not near before that time.
            sonar_silence_s: 40.0,
            without_sonar: WithoutSonar::GiveUp,
            altitude_silence_s: 30.0,
            clock_stalls: 10,
            position_silence_s: 30.0,
            cannot_follow_s: cannot_follow_s(),
            timeout_factor: 2.0,
        }
    }
}
