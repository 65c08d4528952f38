//! The values of a mission: the preset's, where the file gives no others.

use super::document::MissionFile;
use super::overrides::{check_values, overridden};
use crate::PresetValues;
use auv_types::Violations;

impl MissionFile {
    /// The preset's values, overridden by the file's, within what the body can do; tells what it cannot.
    pub(super) fn values(
        &self,
        limited: &mut Vec<String>,
        violations: &mut Violations,
    ) -> PresetValues {
        let mut values = self.preset.values();
        let (body, turn_margin, vehicle) = self.body_of(violations);
        values.body = body;
        values.vehicle = overridden(values.vehicle, &vehicle, "vehicle", violations);
        values.vehicle.turn_radius_m *= turn_margin;
        if values.vehicle.validate().is_empty() {
            (values.vehicle, *limited) = body.within(values.vehicle);
        }
        values.sonar = overridden(values.sonar, &self.sonar, "sonar", violations);
        if self.preset == crate::Preset::Default {
            values.tracker = values.scaled_tracker();
        }
        let mut tracker = self.tracker.clone();
        if tracker.remove("sonar").is_some() {
            violations.push(
                "[tracker]",
                "has a sonar of its own; give [sonar], it holds for both",
            );
        }
        values.tracker = overridden(values.tracker, &tracker, "tracker", violations);
        values.tracker.sonar = values.sonar.clone();
        values.clearance = overridden(values.clearance, &self.clearance, "clearance", violations);
        values.synchroniser = overridden(
            values.synchroniser,
            &self.synchroniser,
            "synchroniser",
            violations,
        );
        values.obstacle_motion = overridden(
            values.obstacle_motion,
            &self.obstacle_motion,
            "obstacle_motion",
            violations,
        );
        self.override_numbers(&mut values);
        violations.absorb("", check_values(&values));
        let reserve_s = self.reserve_s.unwrap_or_default();
        let budget_s = values.budget_s;
        // A wrong budget is told once, by itself.
        let is_known = budget_s >= 1.0;
        violations.require(
            !is_known || (0.0..budget_s).contains(&reserve_s),
            "reserve_s",
            || format!("is {reserve_s}; give at least 0 and less than budget_s"),
        );
        values
    }

    /// Numbers of the file's top level take the place of the preset's.
    fn override_numbers(&self, values: &mut PresetValues) {
        let own = [
            (self.budget_s, &mut values.budget_s),
            (self.tick_s, &mut values.tick_s),
            (self.guidance_error_m, &mut values.guidance_error_m),
            (self.clearance_m, &mut values.clearance_m),
            (self.altitude.least_m, &mut values.min_altitude_m),
            (self.altitude.sigmas, &mut values.altitude_sigmas),
        ];
        for (given, number) in own {
            if let Some(given) = given {
                *number = given;
            }
        }
    }
}
