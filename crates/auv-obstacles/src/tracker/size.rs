//! The filter of a contact's radius, which may be constant, fluctuating or growing.

use super::settings::TrackerSettings;
use auv_types::libm;

/// Log odds beyond which a hypothesis counts as decided (1 %).
pub(super) const SETTLED: f64 = 4.6;

/// The mean, growth and fluctuation of a radius.
///
/// A linear Kalman filter of (radius, growth). The likelihoods of the innovations with and without a
/// fluctuation decide whether the radius fluctuates; it counts as fluctuating until decided otherwise.
/// Growth has no process noise until it is significant (4 standard deviations): until then its uncertainty
/// falls as fast as that of a regression.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Size {
    mean_m: f64,
    growth_mps: f64,
    /// Covariance of (radius, growth).
    rr: f64,
    rg: f64,
    gg: f64,
    /// Log odds that the radius fluctuates.
    fluctuates: f64,
    spread_sum: f64,
    spread_count: f64,
    grows: bool,
}

/// Weight of the prior in the estimate of the fluctuation, as a number of measurements.
const PRIOR_COUNT: f64 = 4.0;
/// Number of measurements after which the estimate of the fluctuation starts to forget.
const MEMORY: f64 = 60.0;

impl Size {
    pub(super) fn new(radius_m: f64, sigma_m: f64, settings: &TrackerSettings) -> Self {
        let spread = settings.fluctuation_ratio * radius_m;
        Self {
            mean_m: radius_m,
            growth_mps: 0.0,
            rr: sigma_m * sigma_m + spread * spread,
            rg: 0.0,
            gg: settings.growth_sigma_mps * settings.growth_sigma_mps,
            fluctuates: 0.0,
            spread_sum: 0.0,
            spread_count: 0.0,
            grows: false,
        }
    }

    pub(super) fn mean_m(&self) -> f64 {
        self.mean_m
    }

    /// Takes in that more of the contact is seen than before: that is no growth, and no fluctuation.
    pub(super) fn show(&mut self, radius_m: f64, sigma_m: f64, settings: &TrackerSettings) {
        self.mean_m = radius_m.min(settings.max_radius_m);
        self.rr = self.rr.max(sigma_m * sigma_m);
    }

    /// Standard deviation of the fluctuation, metres; 0 once decided that there is none.
    pub(super) fn spread_m(&self, settings: &TrackerSettings) -> f64 {
        if self.fluctuates < -SETTLED {
            return 0.0;
        }
        let prior = settings.fluctuation_ratio * self.mean_m;
        let sum = PRIOR_COUNT * prior * prior + self.spread_sum;
        libm::sqrt((sum / (PRIOR_COUNT + self.spread_count)).max(0.0))
    }

    fn noise(&self, settings: &TrackerSettings) -> f64 {
        if self.grows {
            settings.growth_noise_m2ps3
        } else {
            0.0
        }
    }

    /// Predicts the radius `dt_s` ahead. A contact at rest that does not grow keeps its size.
    pub(super) fn predict(&mut self, dt_s: f64, rests: bool, settings: &TrackerSettings) {
        if rests && !self.grows {
            return;
        }
        let q = self.noise(settings);
        self.mean_m = (self.mean_m + self.growth_mps * dt_s).clamp(0.0, settings.max_radius_m);
        self.rr += 2.0 * dt_s * self.rg + dt_s * dt_s * self.gg + q * dt_s * dt_s * dt_s / 3.0;
        self.rg += dt_s * self.gg + 0.5 * q * dt_s * dt_s;
        self.gg += q * dt_s;
    }

    /// Updates the filter with a measured radius; `since_s` is the time since the last one.
    pub(super) fn update(
        &mut self,
        radius_m: f64,
        sigma_m: f64,
        since_s: f64,
        settings: &TrackerSettings,
    ) {
        let innovation = radius_m - self.mean_m;
        let square = innovation * innovation;
        let steady = self.rr + sigma_m * sigma_m;
        let spread = self.spread_m(settings);
        let prior = settings.fluctuation_ratio * self.mean_m;
        let loose = steady + (spread * spread).max(prior * prior);
        let evidence = 0.5 * (libm::log(steady / loose) + square / steady - square / loose);
        // Repeated measurements within one interval of fluctuation are no evidence of constancy: the
        // interval counts once.
        let independent = (since_s / settings.fluctuation_interval_s).min(1.0);
        let weight = if evidence < 0.0 { independent } else { 1.0 };
        self.fluctuates = (self.fluctuates + weight * evidence).clamp(-8.0, 8.0);
        let memory = if self.spread_count >= MEMORY {
            1.0 - 1.0 / MEMORY
        } else {
            1.0
        };
        self.spread_sum = self.spread_sum * memory + independent * (square - steady);
        self.spread_count = self.spread_count * memory + independent;

        let spread = self.spread_m(settings);
        let total = steady + spread * spread / independent.max(1e-3);
        let (gain_r, gain_g) = (self.rr / total, self.rg / total);
        self.mean_m = (self.mean_m + gain_r * innovation).clamp(0.0, settings.max_radius_m);
        self.growth_mps += gain_g * innovation;
        self.gg -= gain_g * self.rg;
        self.rg -= gain_r * self.rg;
        self.rr -= gain_r * self.rr;
        self.grows |= self.growth_mps > 4.0 * libm::sqrt(self.gg);
    }

    /// The upper bound of the radius as a function of time, before the cap `max_radius_m`.
    pub(super) fn bound(&self, rests: bool, settings: &TrackerSettings) -> RadiusBound {
        let may_grow = self.grows || !rests;
        let counts = self.grows || (may_grow && settings.radius_sigmas > 0.0);
        let open = if may_grow { 1.0 } else { 0.0 };
        RadiusBound {
            start_m: self.mean_m + settings.fluctuation_sigmas * self.spread_m(settings),
            growth_mps: if counts {
                self.growth_mps.max(0.0)
            } else {
                0.0
            },
            sigmas: settings.radius_sigmas,
            // Without a negative covariance the bound never falls.
            variance: [
                self.rr,
                open * 2.0 * self.rg.max(0.0),
                open * self.gg,
                self.noise(settings) / 3.0,
            ],
        }
    }
}

/// An upper bound of the radius as a function of time: convex and never falling.
pub(super) struct RadiusBound {
    start_m: f64,
    growth_mps: f64,
    sigmas: f64,
    /// Coefficients of the variance's cubic in time.
    variance: [f64; 4],
}

impl RadiusBound {
    /// The bound at `ahead_s` after the filter's time, metres.
    pub(super) fn at(&self, ahead_s: f64) -> f64 {
        let [a, b, c, d] = self.variance;
        let variance = a + ahead_s * (b + ahead_s * (c + ahead_s * d));
        self.start_m + self.growth_mps * ahead_s + self.sigmas * libm::sqrt(variance.max(0.0))
    }
}
