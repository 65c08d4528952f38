//! What the vehicle can do.

use auv_types::Violations;

/// The least pitch limit, radians. A vehicle that can pitch less cannot be said to change depth: a climb
/// of 100 m takes it more than 10 km.
const LEAST_PITCH_RAD: f64 = 0.01;

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
    /// Greatest pitch, up or down, radians (at least 0.01; pi/2 or more: no limit).
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
        let steep = self.max_pitch_rad >= LEAST_PITCH_RAD && self.max_pitch_rad.is_finite();
        violations.require(steep, "max_pitch_rad", || {
            let pitch_rad = self.max_pitch_rad;
            format!("is {pitch_rad}; give at least {LEAST_PITCH_RAD} rad, or 1.5708 for no limit")
        });
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pitch_limit_too_small_to_change_depth_is_refused() {
        let with = |max_pitch_rad| Vehicle {
            max_pitch_rad,
            ..Vehicle::default()
        };
        for pitch_rad in [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e-6, 0.009] {
            let text = with(pitch_rad).validate().to_string();
            assert!(text.contains("max_pitch_rad"), "{pitch_rad}: {text}");
        }
        for pitch_rad in [0.01, 0.3, std::f64::consts::FRAC_PI_2, 4.0] {
            assert!(with(pitch_rad).validate().is_empty());
        }
    }
}
