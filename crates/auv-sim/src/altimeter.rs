//! An altimeter that looks straight down.

use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Violations, libm};

/// A simulated altimeter. It measures once a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Altimeter {
    /// Greatest altitude that it measures, metres. Beyond it, the answer is that the bed is farther.
    pub range_m: f64,
    /// Error of a measured altitude, standard deviation in metres.
    pub noise_m: f64,
    /// Probability that a measurement is lost.
    pub dropout: f64,
}

impl Default for Altimeter {
    /// An ordinary echo sounder: 60 m, 0.1 m, one measurement of fifty lost.
    fn default() -> Self {
        Self {
            range_m: 60.0,
            noise_m: 0.1,
            dropout: 0.02,
        }
    }
}

impl Altimeter {
    /// Everything malformed about it.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require_positive(self.range_m, "range_m");
        violations.require_not_negative(self.noise_m, "noise_m");
        violations.require((0.0..1.0).contains(&self.dropout), "dropout", || {
            format!("is {}; give at least 0 and less than 1", self.dropout)
        });
        violations
    }

    /// What it answers at an altitude: metres, `+inf` where the bed is out of range, `None` where the
    /// measurement is lost. It draws three numbers whatever it answers.
    pub(crate) fn measure(&self, altitude_m: f64, random: &mut ChaCha8Rng) -> Option<f64> {
        let lost = random.random_range(0.0..1.0) < self.dropout;
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - random.random_range(0.0..1.0)));
        let angle = random.random_range(0.0..std::f64::consts::TAU);
        let measured_m = altitude_m + self.noise_m * radius * libm::cos(angle);
        match lost {
            true => None,
            false if altitude_m > self.range_m => Some(f64::INFINITY),
            false => Some(measured_m.max(0.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Seed;

    #[test]
    fn measures_with_noise_and_loses_some() {
        let (altimeter, mut random) = (Altimeter::default(), Seed(1).stream(0));
        assert!(altimeter.validate().is_empty());
        let answers: Vec<f64> = (0..2_000)
            .filter_map(|_| altimeter.measure(8.0, &mut random))
            .collect();
        assert!((1_930..1_990).contains(&answers.len()), "{}", answers.len());
        let mean_m = answers.iter().sum::<f64>() / answers.len() as f64;
        assert!((mean_m - 8.0).abs() < 0.01, "{mean_m}");
        assert!(answers.iter().all(|m| (m - 8.0).abs() < 0.6));
        let far = (0..99).find_map(|_| altimeter.measure(61.0, &mut random));
        assert_eq!(far, Some(f64::INFINITY));
    }
}
