//! Settings of the tracker.

use super::chi_square::{Dimensions, quantile};
use crate::Sonar;
use auv_types::{Violations, libm};

/// Greatest number of spans of one track.
pub(super) const MAX_SPANS: usize = 16;

/// How tracks are formed, filtered and predicted.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct TrackerSettings {
    /// The sonar that takes the scans. Its field of view decides whether a missing echo is a miss.
    pub sonar: Sonar,
    /// The probability that an echo falls into the gate of its own track.
    pub gate_probability: f64,
    /// Number of echoes that confirm a track, within `confirm_window` scans.
    pub confirm_hits: u32,
    /// Number of scans within which a track must be confirmed, at most 32.
    pub confirm_window: u32,
    /// Acceleration noise of the targets, m/s².
    pub acceleration_mps2: f64,
    /// Duration of an acceleration, seconds. The velocity's variance grows by `acceleration² duration` per
    /// second.
    pub acceleration_time_s: f64,
    /// Growth of a position's variance per axis by jitter, m²/s (class 3 of the paper, Eq. 4:
    /// `sigma_p² step / 3`).
    pub jitter_m2ps: f64,
    /// Standard deviation per axis of the velocity of a new track, m/s. Contacts three times as fast are
    /// still tracked.
    pub first_speed_mps: f64,
    /// Standard deviation per axis added to the velocity of a track that manoeuvres, m/s.
    pub manoeuvre_mps: f64,
    /// How fast the vehicle gets out of the way: the acceleration across its course that it can turn with,
    /// speed² over turn radius, m/s². A contact that closes in gives a region before it is confirmed when the
    /// vehicle has no time to wait. `+inf`: it always has.
    #[cfg_attr(feature = "serde", serde(with = "crate::unbounded"))]
    pub evasion_mps2: f64,
    /// Whether targets may be classified as at rest. Their prediction then does not widen.
    pub rest_hypothesis: bool,
    /// Prior standard deviation of a fluctuating radius, as a share of its mean (class 2).
    pub fluctuation_ratio: f64,
    /// Time between two changes of a fluctuating radius, seconds.
    pub fluctuation_interval_s: f64,
    /// Prior standard deviation of a radius' growth, m/s (class 4: the speed of the current times the growth
    /// state).
    pub growth_sigma_mps: f64,
    /// Process noise of that growth for a radius classified as growing, m²/s³.
    pub growth_noise_m2ps3: f64,
    /// Greatest radius of any obstacle, metres (may be `+inf`).
    #[cfg_attr(feature = "serde", serde(with = "crate::unbounded"))]
    pub max_radius_m: f64,
    /// Standard deviations of the position added to a region (k of the paper).
    pub position_sigmas: f64,
    /// Standard deviations of the radius and its growth added to a region.
    pub radius_sigmas: f64,
    /// Standard deviations of a fluctuating radius added to a region (class 2 is clipped at 3).
    pub fluctuation_sigmas: f64,
    /// Whether regions extend over all depths, for a sonar that does not measure vertical extent.
    pub columns: bool,
    /// Time ahead for which regions are predicted, seconds. Regions of contacts at rest have no end.
    pub horizon_s: f64,
    /// Greatest number of consecutive regions of one track, 1 to 16. One more is added if the radius reaches
    /// its cap, and one for a contact at rest after the horizon.
    pub max_spans: usize,
    /// How far a region may exceed the bound it covers before it is split in two, metres.
    pub span_tolerance_m: f64,
    /// A track is dropped if misses have reduced the odds of its existence below this value ...
    pub lost_odds: f64,
    /// ... and it has been unseen for at least this time, seconds.
    pub lost_after_s: f64,
    /// Time after which a moving track outside the field of view is dropped, seconds. A track at rest is
    /// kept.
    pub forget_after_s: f64,
    /// Greatest number of tracks. Those nearest the sonar are kept.
    pub max_tracks: usize,
    /// Greatest number of echoes used per scan. Those nearest the sonar are used.
    pub max_detections: usize,
}

impl TrackerSettings {
    /// The paper's settings: its sonar, a pure constant-velocity filter, every echo a track, regions of two
    /// standard deviations (73.9 % of positions in three dimensions).
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            sonar: Sonar::paper(),
            gate_probability: 0.9999,
            confirm_hits: 1,
            confirm_window: 1,
            acceleration_mps2: 0.0,
            acceleration_time_s: 1.0,
            jitter_m2ps: 0.1 * 0.1 * 10.0 / 3.0,
            first_speed_mps: 0.5,
            manoeuvre_mps: 0.5,
            evasion_mps2: f64::INFINITY,
            rest_hypothesis: false,
            fluctuation_ratio: 0.2,
            fluctuation_interval_s: 10.0,
            growth_sigma_mps: 0.3,
            growth_noise_m2ps3: 0.3 * 0.3 * 0.1 * 0.1 / 10.0,
            max_radius_m: f64::INFINITY,
            position_sigmas: 2.0,
            radius_sigmas: 0.0,
            fluctuation_sigmas: 2.0,
            columns: false,
            horizon_s: 3600.0,
            max_spans: 3,
            span_tolerance_m: 5.0,
            lost_odds: 1e-4,
            lost_after_s: 60.0,
            forget_after_s: 600.0,
            max_tracks: 100,
            max_detections: 1000,
        }
    }

    /// Settings for whole missions among the paper's obstacles: regions hold 99 % of positions in three
    /// dimensions (k = 3.37), with as many standard deviations of radius and growth; class 2 counts with its
    /// clip bound; radii are at most 250 m.
    #[must_use]
    pub fn campaign() -> Self {
        Self {
            max_radius_m: 250.0,
            position_sigmas: sigmas_in_space(0.99),
            radius_sigmas: sigmas_in_space(0.99),
            fluctuation_sigmas: 3.0,
            ..Self::paper()
        }
    }

    /// Every invalid value.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.absorb("sonar.", self.sonar.validate());
        for (value, place) in [
            (self.gate_probability, "gate_probability"),
            (self.lost_odds, "lost_odds"),
        ] {
            violations.require(value > 0.0 && value < 1.0, place, || {
                format!("is {value}; give a value between 0 and 1")
            });
        }
        for (value, place) in [
            (self.acceleration_mps2, "acceleration_mps2"),
            (self.acceleration_time_s, "acceleration_time_s"),
            (self.jitter_m2ps, "jitter_m2ps"),
            (self.manoeuvre_mps, "manoeuvre_mps"),
            (self.fluctuation_ratio, "fluctuation_ratio"),
            (self.growth_sigma_mps, "growth_sigma_mps"),
            (self.growth_noise_m2ps3, "growth_noise_m2ps3"),
            (self.position_sigmas, "position_sigmas"),
            (self.radius_sigmas, "radius_sigmas"),
            (self.fluctuation_sigmas, "fluctuation_sigmas"),
            (self.span_tolerance_m, "span_tolerance_m"),
            (self.lost_after_s, "lost_after_s"),
            (self.forget_after_s, "forget_after_s"),
        ] {
            violations.require_not_negative(value, place);
        }
        violations.require_positive(self.first_speed_mps, "first_speed_mps");
        violations.require_positive(self.fluctuation_interval_s, "fluctuation_interval_s");
        violations.require_positive(self.horizon_s, "horizon_s");
        for (value, place) in [
            (self.evasion_mps2, "evasion_mps2"),
            (self.max_radius_m, "max_radius_m"),
        ] {
            violations.require(value > 0.0, place, || {
                format!("is {value}; give a value above 0")
            });
        }
        self.check_counts(&mut violations);
        violations
    }

    fn check_counts(&self, violations: &mut Violations) {
        let window = self.confirm_window;
        violations.require((1..=32).contains(&window), "confirm_window", || {
            format!("is {window}; give 1 to 32 scans")
        });
        violations.require(
            (1..=window).contains(&self.confirm_hits),
            "confirm_hits",
            || format!("is {}; give 1 to confirm_window", self.confirm_hits),
        );
        violations.require(
            (1..=MAX_SPANS).contains(&self.max_spans),
            "max_spans",
            || format!("is {}; give 1 to {MAX_SPANS}", self.max_spans),
        );
        for (value, place) in [
            (self.max_tracks, "max_tracks"),
            (self.max_detections, "max_detections"),
        ] {
            violations.require((1..=100_000).contains(&value), place, || {
                format!("is {value}; give 1 to 100000")
            });
        }
    }

    /// Spectral density of the acceleration noise, m²/s³.
    pub(super) fn acceleration_density(&self) -> f64 {
        self.acceleration_mps2 * self.acceleration_mps2 * self.acceleration_time_s
    }
}

impl Default for TrackerSettings {
    /// A forward-looking sonar with two false echoes per scan, among real traffic: confirmation by 5 of 7
    /// scans, gate 99 %, 0.05 m/s² for 0.5 s, contacts at rest recognised and kept, regions of 99 % over
    /// all depths, a vehicle of 1.5 m/s that turns in 20 m. A mission file's `preset = "default"` has the same values.
    ///
    /// With a weaker confirmation false echoes form tracks that block the vehicle for minutes.
    fn default() -> Self {
        Self {
            sonar: Sonar::default(),
            gate_probability: 0.99,
            confirm_hits: 5,
            confirm_window: 7,
            acceleration_mps2: 0.05,
            acceleration_time_s: 0.5,
            jitter_m2ps: 0.0,
            first_speed_mps: 0.8,
            evasion_mps2: 0.1,
            rest_hypothesis: true,
            growth_sigma_mps: 0.02,
            growth_noise_m2ps3: 1e-6,
            max_radius_m: f64::INFINITY,
            position_sigmas: sigmas_in_space(0.99),
            radius_sigmas: sigmas_in_space(0.99),
            fluctuation_sigmas: 3.0,
            columns: true,
            horizon_s: 120.0,
            lost_after_s: 15.0,
            forget_after_s: 120.0,
            ..Self::paper()
        }
    }
}

/// The radius, in standard deviations, of the ball that holds a three-dimensional normal variable with a
/// probability (3.37 for 99 %).
#[must_use]
pub fn sigmas_in_space(probability: f64) -> f64 {
    libm::sqrt(quantile(
        Dimensions::Three,
        probability.clamp(0.0, 1.0 - 1e-12),
    ))
}
