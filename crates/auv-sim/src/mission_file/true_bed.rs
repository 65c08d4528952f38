//! The bed as planners know it and as it truly is.

use super::document::{BedTruth, MissionFile};
use crate::PresetValues;
use auv_mission::Mission;
use auv_ocean::{DrawnBed, LevelledBed, SeaBed};
use auv_types::{Seed, Violations};
use std::sync::Arc;

/// Distance over which the errors of a chart are correlated, metres, where the file states none.
const CORRELATION_M: f64 = 300.0;
/// Beds drawn until the start is deep enough.
const ATTEMPTS: u64 = 64;

impl MissionFile {
    /// Whether the true bed is drawn from the chart's standard deviation.
    pub(super) fn draws_bed(&self) -> bool {
        let entry = self.sea_bed.as_ref();
        entry.is_some_and(|entry| entry.truth == BedTruth::Drawn)
    }

    /// The charted bed below the lowest surface until the mission times out. Planners know this one: what is
    /// deep enough there is deep enough at any time.
    pub(super) fn under_lowest_surface(
        &self,
        bed: Option<Arc<dyn SeaBed>>,
        values: &PresetValues,
        violations: &mut Violations,
    ) -> Option<Arc<dyn SeaBed>> {
        let correlation_m = self.sea_bed.as_ref().and_then(|entry| entry.correlation_m);
        if let Some(correlation_m) = correlation_m {
            violations.require(
                (1.0..=1e6).contains(&correlation_m),
                "sea_bed.correlation_m",
                || format!("is {correlation_m}; give 1 to 1,000,000 m"),
            );
            violations.require(self.draws_bed(), "sea_bed.correlation_m", || {
                "is only used with truth = \"drawn\"; set it or leave the key out".into()
            });
        }
        let Some(level) = &self.water_level else {
            return bed;
        };
        let wrong = level.validate();
        violations.require(bed.is_some(), "water_level", || {
            "needs a [sea_bed]; give one or leave it out".into()
        });
        if !wrong.is_empty() {
            violations.absorb("water_level.", wrong);
            return bed;
        }
        let longest_s = values.budget_s * values.synchroniser.watchdogs.timeout_factor;
        let least_m = level.least_until(0.0, longest_s.max(values.budget_s));
        bed.map(|bed| Arc::new(LevelledBed::new(bed, least_m)) as _)
    }

    /// The true bed below the datum. Planners get it raised by water level and guidance error. A vehicle is
    /// launched where it floats: of the beds drawn, the first is taken under which the start keeps the least
    /// altitude.
    pub(super) fn true_bed(
        &self,
        charted: Option<&Arc<dyn SeaBed>>,
        mission: &Mission,
        seed: Seed,
    ) -> Option<Arc<dyn SeaBed>> {
        let charted = charted?;
        if !self.draws_bed() {
            return Some(Arc::clone(charted));
        }
        let entry = self.sea_bed.as_ref();
        let correlation_m = entry.and_then(|entry| entry.correlation_m);
        let start = mission.position_of(mission.start);
        let level_m = self.water_level.as_ref().map_or(0.0, |level| level.at(0.0));
        let draw = |attempt| {
            let chart = Arc::clone(charted);
            DrawnBed::draw(
                chart,
                correlation_m.unwrap_or(CORRELATION_M),
                seed.split(attempt),
            )
        };
        let floats = |bed: &DrawnBed<_>| {
            let depth_m = bed.depth_at(start.x, start.y) + level_m;
            depth_m - start.z >= mission.min_altitude_m
        };
        let mut beds = (0..ATTEMPTS).map(draw);
        let bed = beds.find(floats).unwrap_or_else(|| draw(ATTEMPTS));
        Some(Arc::new(bed))
    }
}
