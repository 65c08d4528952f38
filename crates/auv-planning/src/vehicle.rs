//! What the vehicle can do.

use auv_types::Violations;

/// Limits of the vehicle's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Vehicle {
    /// Cruising speed through the water, m/s (0.001 to 1000).
    pub speed_mps: f64,
    /// Least speed through the water at which the vehicle steers, m/s (0: it can hover).
    pub min_speed_mps: f64,
    /// Greatest speed through the water, m/s.
    pub max_speed_mps: f64,
    /// Least turn radius, metres (0: it turns on the spot).
    pub turn_radius_m: f64,
    /// Greatest pitch, up or down, radians (at least pi/2: no limit).
    pub max_pitch_rad: f64,
}

impl Vehicle {
    /// The paper's vehicle: 3 m/s, no turn or pitch limit, hovers.
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            speed_mps: 3.0,
            min_speed_mps: 0.0,
            max_speed_mps: 3.0,
            turn_radius_m: 0.0,
            max_pitch_rad: std::f64::consts::FRAC_PI_2,
        }
    }

    /// Whether the vehicle can stay in one place.
    #[must_use]
    pub fn can_hover(&self) -> bool {
        self.min_speed_mps <= 0.0
    }

    /// Everything wrong with the limits.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let possible = (1e-3..=1e3).contains(&self.speed_mps);
        violations.require(possible, "speed_mps", || {
            format!("is {:?}; give 0.001 to 1000 m/s", self.speed_mps)
        });
        violations.require_not_negative(self.min_speed_mps, "min_speed_mps");
        violations.require_not_negative(self.turn_radius_m, "turn_radius_m");
        violations.require_positive(self.max_pitch_rad, "max_pitch_rad");
        let ordered = self.min_speed_mps <= self.speed_mps && self.speed_mps <= self.max_speed_mps;
        violations.require(
            !possible || ordered && self.max_speed_mps.is_finite(),
            "max_speed_mps",
            || {
                format!(
                    "is {}; speeds must be ordered: min {} <= cruise {} <= max",
                    self.max_speed_mps, self.min_speed_mps, self.speed_mps
                )
            },
        );
        violations
    }
}

impl Default for Vehicle {
    /// A 2 m survey vehicle: 1.5 m/s (0.7 to 2.0), 20 m turn radius, 15 degrees of pitch.
    fn default() -> Self {
        Self {
            speed_mps: 1.5,
            min_speed_mps: 0.7,
            max_speed_mps: 2.0,
            turn_radius_m: 20.0,
            max_pitch_rad: 15.0 * std::f64::consts::PI / 180.0,
        }
    }
}
