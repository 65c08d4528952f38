//! Energy as a second budget beside time.

use auv_planning::Vehicle;
use auv_types::Violations;

/// A battery with a linear model: hotel load over time, propulsion over distance through the water, at
/// cruising speed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Battery {
    /// Energy that may be used from start to docking, joules (1 kWh is 3.6e6 J).
    pub usable_j: f64,
    /// Power of everything but propulsion, watts.
    pub hotel_w: f64,
    /// Energy of propulsion for each metre through the water, J/m.
    pub propulsion_j_per_m: f64,
}

impl Battery {
    /// Energy used in a time and over a distance through the water, joules.
    #[must_use]
    pub fn used_j(&self, time_s: f64, distance_m: f64) -> f64 {
        self.hotel_w * time_s + self.propulsion_j_per_m * distance_m
    }

    /// How long the energy left lasts at cruising speed, seconds.
    #[must_use]
    pub fn lasts_s(&self, left_j: f64, vehicle: &Vehicle) -> f64 {
        left_j / self.used_j(1.0, vehicle.speed_mps)
    }

    /// Everything wrong with the battery.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require_positive(self.usable_j, "usable_j");
        violations.require_not_negative(self.hotel_w, "hotel_w");
        violations.require_not_negative(self.propulsion_j_per_m, "propulsion_j_per_m");
        violations.require_positive(
            self.hotel_w + self.propulsion_j_per_m,
            "hotel_w + propulsion",
        );
        violations
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_battery_holds_energy_and_something_uses_it() {
        let told = |usable_j, hotel_w, propulsion_j_per_m| {
            let battery = Battery {
                usable_j,
                hotel_w,
                propulsion_j_per_m,
            };
            battery.validate().to_string()
        };
        assert_eq!(told(1e6, 5.0, 0.0), "");
        assert_eq!(told(1e6, 0.0, 20.0), "");
        assert!(told(0.0, 5.0, 20.0).contains("usable_j"));
        assert!(told(1e6, -1.0, 20.0).contains("hotel_w"));
        assert!(told(1e6, 5.0, -1.0).contains("propulsion_j_per_m"));
        assert!(told(1e6, 0.0, 0.0).contains("hotel_w + propulsion"));
    }
}
