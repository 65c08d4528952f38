//! Battery and emergencies of a mission file.

use super::document::{BatteryEntry, EmergencyEntry, MissionFile};
use super::fences::{check_polygon, flat};
use auv_mission::{Battery, Emergency};
use auv_ocean::{Footprint, LocalFrame};
use auv_types::Violations;

/// Joules of a watt-hour.
const WH_J: f64 = 3_600.0;

impl MissionFile {
    /// The battery of the file, for a vehicle that cruises at a speed.
    pub(super) fn battery_at(
        &self,
        speed_mps: f64,
        violations: &mut Violations,
    ) -> Option<Battery> {
        let entry = self.battery.as_ref()?;
        entry.check(violations);
        let propulsion_w = entry.propulsion_w(speed_mps);
        if !violations.is_empty() {
            return None;
        }
        let Some(propulsion_w) = propulsion_w else {
            violations.push(
                "battery.propulsion",
                format!("has no power for the cruising speed of {speed_mps} m/s; give [m/s, W] below and above it"),
            );
            return None;
        };
        Some(Battery {
            usable_j: entry.usable_wh * WH_J * (1.0 - 0.01 * entry.reserve_percent),
            hotel_w: entry.hotel_w,
            propulsion_j_per_m: propulsion_w / speed_mps,
        })
    }

    /// The emergencies of the file, in its order.
    pub(super) fn emergencies(
        &self,
        frame: Option<&LocalFrame>,
        violations: &mut Violations,
    ) -> Vec<Emergency> {
        let without_sonar = self.synchroniser.contains_key("without_sonar");
        violations.require(self.emergency.is_empty() || !without_sonar, "synchroniser.without_sonar", || {
            "and [[emergency]] are both given; keep one: when = \"sonar_lost\" says what is done without the sonar".into()
        });
        let entries = self.emergency.iter().enumerate();
        let read = |(i, entry): (usize, &EmergencyEntry)| {
            let given = !entry.ladder.is_empty();
            violations.require(given, &format!("emergency[{i}].do"), || {
                "is empty; give what is done, in order of preference".into()
            });
            let place = format!("emergency[{i}].where");
            let outline = entry.within.as_ref();
            let within = outline.map(|outline| flat(outline, frame, &place, violations));
            if let Some(outline) = &within {
                let area = Footprint::Area {
                    outline: outline.clone(),
                };
                check_polygon(&area, &place, violations);
            }
            Emergency {
                when: entry.when,
                within,
                ladder: entry.ladder.clone(),
            }
        };
        entries.map(read).collect()
    }
}

impl BatteryEntry {
    fn check(&self, violations: &mut Violations) {
        violations.require_positive(self.usable_wh, "battery.usable_wh");
        violations.require_not_negative(self.hotel_w, "battery.hotel_w");
        let reserve = self.reserve_percent;
        violations.require(
            (0.0..100.0).contains(&reserve),
            "battery.reserve_percent",
            || format!("is {reserve}; give 0 to less than 100"),
        );
        self.check_propulsion(violations);
    }

    /// What is wrong with the pairs of speed and power.
    fn check_propulsion(&self, violations: &mut Violations) {
        let pairs = &self.propulsion;
        violations.require(!pairs.is_empty(), "battery.propulsion", || {
            "is empty; give one pair of [m/s, W] or more".into()
        });
        for (i, [speed_mps, power_w]) in pairs.iter().enumerate() {
            let place = format!("battery.propulsion[{i}]");
            let (fast, strong) = (*speed_mps, *power_w);
            let sound = fast > 0.0 && strong >= 0.0 && fast.is_finite() && strong.is_finite();
            violations.require(sound, &place, || {
                format!(
                    "is [{fast}, {strong}]; give a speed above 0 m/s and a power of 0 W or more"
                )
            });
            let before = i.checked_sub(1).map(|before| pairs[before][0]);
            let descends = before.is_some_and(|before| before >= fast);
            violations.require(!descends, &place, || {
                format!(
                    "has the speed {fast} m/s after one as high; give ascending speeds, each once"
                )
            });
        }
    }

    /// Power of propulsion at a speed, watts: linear between the pairs. One pair holds by the cube of the speed.
    /// `None` outside of the pairs.
    fn propulsion_w(&self, speed_mps: f64) -> Option<f64> {
        if let &[[at_mps, power_w]] = &self.propulsion[..] {
            let ratio = speed_mps / at_mps;
            return Some(power_w * ratio * ratio * ratio);
        }
        let mut pairs = self.propulsion.windows(2);
        let pair = pairs.find(|pair| (pair[0][0]..=pair[1][0]).contains(&speed_mps))?;
        let share = (speed_mps - pair[0][0]) / (pair[1][0] - pair[0][0]);
        Some(pair[0][1] + share * (pair[1][1] - pair[0][1]))
    }
}
