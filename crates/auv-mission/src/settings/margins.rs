//! How much time and distance plans keep free.

use auv_types::Violations;

/// How much time and distance plans keep free.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MarginSettings {
    /// Share of every travel time that routes keep free for detours.
    pub detour_margin: f64,
    /// Time that routes keep free for detours on each leg, seconds.
    pub detour_margin_s: f64,
    /// Whether routes count the delay that predicted obstacles cause on the next leg.
    pub forecast: bool,
    /// Extra clearance asked of a new path, metres. A path in force is given up only when it has lost
    /// all of it, so small changes of the prediction do not cause replanning.
    pub hysteresis_m: f64,
    /// How long the way on from the end of a trajectory must last, seconds, in addition to the time that
    /// planners are given.
    pub escape_s: f64,
    /// How far ahead the trajectory in force is checked against the prediction, seconds.
    pub lookahead_s: f64,
    /// Distance from the trajectory in force beyond which a path is planned from where the vehicle
    /// is, metres.
    pub off_track_m: f64,
}

impl MarginSettings {
    /// The paper's: no time kept free, no forecast of delays.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            detour_margin: 0.0,
            detour_margin_s: 0.0,
            forecast: false,
            off_track_m: 5.0,
            ..Self::default()
        }
    }

    pub(super) fn validate_into(&self, violations: &mut Violations) {
        violations.require_not_negative(self.detour_margin, "detour_margin");
        violations.require_not_negative(self.detour_margin_s, "detour_margin_s");
        violations.require_not_negative(self.hysteresis_m, "hysteresis_m");
        let escape_s = self.escape_s;
        violations.require((0.0..=1e6).contains(&escape_s), "escape_s", || {
            format!("is {escape_s}; give 0 to 1e6 s")
        });
        violations.require_positive(self.lookahead_s, "lookahead_s");
        violations.require_positive(self.off_track_m, "off_track_m");
    }
}

impl Default for MarginSettings {
    /// A survey vehicle with a guidance error of 2 m. A mission file's `preset = "default"` has the same
    /// values.
    fn default() -> Self {
        Self {
            detour_margin: 0.03,
            detour_margin_s: 2.0,
            forecast: true,
            hysteresis_m: 5.0,
            escape_s: 120.0,
            lookahead_s: 600.0,
            off_track_m: 10.0,
        }
    }
}
