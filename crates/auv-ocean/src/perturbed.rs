//! A true current that differs from its forecast.

use crate::CurrentField;
use auv_types::rand::RngExt;
use auv_types::{Point3, Seed, Vector3, Violations};

/// The difference between the true current and its forecast.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct ForecastError {
    /// Ratio of the true speed to the forecast speed.
    pub gain: f64,
    /// Delay of the true current, seconds; negative if it is early.
    pub delay_s: f64,
}

impl Default for ForecastError {
    /// No error.
    fn default() -> Self {
        Self {
            gain: 1.0,
            delay_s: 0.0,
        }
    }
}

impl ForecastError {
    /// Largest typical gain and delay in seconds; the least gain is as far below 1.
    const TYPICAL: Self = Self {
        gain: 1.2,
        delay_s: 1_200.0,
    };

    /// The largest typical errors: weak or strong, early or late.
    #[must_use]
    pub fn largest() -> [Self; 4] {
        let Self { gain, delay_s } = Self::TYPICAL;
        let of = |gain, delay_s| Self { gain, delay_s };
        [
            of(2.0 - gain, -delay_s),
            of(2.0 - gain, delay_s),
            of(gain, -delay_s),
            of(gain, delay_s),
        ]
    }

    /// A typical error: gain uniform in 0.8 to 1.2, delay uniform within 20 minutes either way.
    #[must_use]
    pub fn draw(seed: Seed) -> Self {
        let mut random = seed.stream(0);
        Self {
            gain: random.random_range(0.8..1.2),
            delay_s: random.random_range(-1_200.0..1_200.0),
        }
    }

    /// Everything malformed about it.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require_not_negative(self.gain, "gain");
        violations.require(self.delay_s.is_finite(), "delay_s", || {
            "is not finite; give seconds".into()
        });
        violations
    }
}

/// A true current: a forecast with an error.
///
/// ```
/// use auv_ocean::{CurrentField, ForecastError, Perturbed, UniformCurrent};
/// use auv_types::{Point3, Seed, Vector3};
///
/// let forecast = UniformCurrent::new(Vector3::new(0.5, 0.0, 0.0));
/// let truth = Perturbed::new(forecast, ForecastError::draw(Seed(1)));
/// let met_mps = truth.velocity_at(&Point3::origin(), 0.0).x;
/// assert!(0.4 <= met_mps && met_mps <= 0.6 && met_mps != 0.5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perturbed<F> {
    forecast: F,
    error: ForecastError,
}

impl<F: CurrentField> Perturbed<F> {
    /// The true current for a forecast and its error.
    #[must_use]
    pub const fn new(forecast: F, error: ForecastError) -> Self {
        Self { forecast, error }
    }
}

impl<F: CurrentField> CurrentField for Perturbed<F> {
    fn velocity_at(&self, position: &Point3<f64>, time_s: f64) -> Vector3<f64> {
        let forecast = self
            .forecast
            .velocity_at(position, time_s - self.error.delay_s);
        forecast * self.error.gain
    }

    fn max_speed_mps(&self) -> f64 {
        self.forecast.max_speed_mps() * self.error.gain
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AnalyticCurrent, TidalConstituent};
    use std::sync::Arc;

    #[test]
    fn gain_and_delay_apply() {
        let forecast: Arc<dyn CurrentField> = Arc::new(AnalyticCurrent {
            tide: vec![TidalConstituent::turning_at(10_800.0, [0.4, 0.0])],
            ..AnalyticCurrent::default()
        });
        let error = ForecastError {
            gain: 1.2,
            delay_s: 600.0,
        };
        let truth = Perturbed::new(Arc::clone(&forecast), error);
        let place = Point3::new(1.0, 2.0, 3.0);
        assert!(truth.velocity_at(&place, 11_400.0).norm() < 1e-12);
        assert_eq!(
            truth.velocity_at(&place, 600.0),
            forecast.velocity_at(&place, 0.0) * 1.2
        );
        assert_eq!(truth.max_speed_mps(), 0.4 * 1.2);
    }

    #[test]
    fn drawn_errors_stay_in_their_ranges() {
        for i in 0..1_000 {
            let error = ForecastError::draw(Seed(9).split(i));
            assert!((0.8..1.2).contains(&error.gain) && error.delay_s.abs() <= 1_200.0);
        }
    }
}
