//! Whether the echoes of a new contact are those of one thing: Wald's sequential probability ratio test against
//! false echoes.

use super::motion::{Motion, log_likelihood};
use super::settings::TrackerSettings;
use crate::{Detection, Scan, Sonar};
use auv_types::{Vector3, libm};
use std::f64::consts::TAU;

/// Of the contacts that false echoes begin, one passes the test in this time at most, seconds. Few of those close in.
const FALSE_EVERY_S: f64 = 900.0;
/// More evidence is not kept.
const MOST: f64 = 50.0;
/// Fewer false echoes per scan are not counted on.
const LEAST_CLUTTER: f64 = 0.1;
/// Sizes of false echoes are spread over as many metres.
const CLUTTER_SIZES_M: f64 = 5.0;
/// Share of echoes whose size tells nothing: the sonar sees more of a large contact as it comes nearer.
const OTHER_SIZE: f64 = 0.5;

/// The log likelihood ratio of the echoes after the first: of one thing, and of false echoes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Score(f64);

impl Score {
    /// Adds evidence, a log likelihood ratio. Echoes without errors may give none.
    pub(super) fn add(&mut self, evidence: f64) {
        if !evidence.is_nan() {
            self.0 = (self.0 + evidence).clamp(-MOST, MOST);
        }
    }

    /// Takes in an echo of a contact that was expected with a motion and a radius, and detected with a probability.
    pub(super) fn hit(
        &mut self,
        echo: &Detection,
        (motion, radius_m): (&Motion, f64),
        probability: f64,
        scan: &Scan,
        sonar: &Sonar,
    ) {
        let place = log_likelihood(echo, &motion.position, motion.pp) - 1.5 * libm::log(TAU);
        let density = clutter_density(sonar, &(echo.position - scan.from));
        let size = OTHER_SIZE + (1.0 - OTHER_SIZE) * size_ratio(echo, radius_m);
        self.add(place + libm::log(probability.max(0.01) * size / density));
    }

    /// Takes in a scan without an echo of a contact that was to be detected with a probability.
    pub(super) fn miss(&mut self, probability: f64) {
        self.add(libm::log(1.0 - probability.min(0.99)));
    }

    /// Whether the echoes, and more evidence, are rather those of one thing.
    pub(super) fn is_likely(self, evidence: f64) -> bool {
        self.0 + evidence > 0.0
    }

    /// Whether false echoes alone reach this, and more evidence, too seldom to count.
    pub(super) fn is_true(self, evidence: f64, settings: &TrackerSettings) -> bool {
        let sonar = &settings.sonar;
        let begun = sonar.clutter_per_scan.max(LEAST_CLUTTER) * FALSE_EVERY_S / sonar.period_s;
        self.0 + evidence >= libm::log(begun.max(1.0))
    }
}

/// False echoes per scan and cubic metre at an offset from the sonar: they are even over the area of the sector.
fn clutter_density(sonar: &Sonar, offset: &Vector3<f64>) -> f64 {
    let area_m2 = sonar.half_width_rad * sonar.range_m * sonar.range_m;
    let height_m = 2.0 * sonar.half_height_rad * offset.norm().max(1.0);
    sonar.clutter_per_scan.max(LEAST_CLUTTER) / (area_m2 * height_m)
}

/// How many times as likely as a false echo's the size of an echo is, of a contact of a radius.
fn size_ratio(echo: &Detection, radius_m: f64) -> f64 {
    // Both sizes have errors.
    let variance = 2.0 * echo.radius_sigma_m * echo.radius_sigma_m;
    if variance <= 0.0 {
        return 1.0;
    }
    let differs_m = echo.radius_m - radius_m;
    CLUTTER_SIZES_M * libm::exp(-0.5 * differs_m * differs_m / variance)
        / libm::sqrt(TAU * variance)
}
