//! The height of the water's surface.

use auv_types::{Violations, libm};

/// The height of the surface above the datum of the charted depths, as a function of time.
///
/// ```
/// use auv_ocean::{LevelConstituent, WaterLevel};
///
/// let tide = LevelConstituent { amplitude_m: 1.5, period_s: 44_714.0, highest: 3_600.0 };
/// let level = WaterLevel { height_m: 2.0, tide: vec![tide] };
/// assert_eq!(level.at(3_600.0), 3.5);
/// let least_m = level.least_until(0.0, 44_714.0);
/// assert!(least_m <= 0.5 && least_m > 0.49);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct WaterLevel {
    /// The mean height above the datum, metres.
    pub height_m: f64,
    /// Tides added to it.
    pub tide: Vec<LevelConstituent>,
}

/// One harmonic of a tide's height.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct LevelConstituent {
    /// Half the range from low to high water, metres.
    pub amplitude_m: f64,
    /// Time from one high water to the next, seconds.
    pub period_s: f64,
    /// A time of high water, mission time in seconds.
    pub highest: f64,
}

/// Greatest height and amplitude, metres.
const MOST_M: f64 = 100.0;
/// Samples of [`WaterLevel::least_until`].
const SAMPLES: u32 = 2_048;

impl WaterLevel {
    /// The height at a time, metres.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        self.tide.iter().fold(self.height_m, |height_m, tide| {
            let turns = (time_s - tide.highest) / tide.period_s;
            height_m + tide.amplitude_m * libm::cos(std::f64::consts::TAU * turns)
        })
    }

    /// A lower bound of the height between two times, metres. It lies below the least height by at most what
    /// the tide falls in 1 / 4096 of the time between.
    #[must_use]
    pub fn least_until(&self, from_s: f64, until_s: f64) -> f64 {
        let step_s = (until_s - from_s).max(0.0) / f64::from(SAMPLES);
        let steepest_mps = self
            .tide
            .iter()
            .map(|tide| tide.amplitude_m.abs() * std::f64::consts::TAU / tide.period_s);
        let between_m = 0.5 * step_s * steepest_mps.sum::<f64>();
        let lowest_m = self.height_m - self.tide.iter().map(|t| t.amplitude_m.abs()).sum::<f64>();
        let samples = (0..=SAMPLES).map(|k| self.at(from_s + step_s * f64::from(k)));
        (samples.fold(f64::INFINITY, f64::min) - between_m).max(lowest_m)
    }

    /// Everything malformed about it.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let mut plausible = |metres: f64, place: &str| {
            violations.require(metres.abs() <= MOST_M, place, || {
                format!("is {metres}; give at most {MOST_M} m")
            });
        };
        plausible(self.height_m, "height_m");
        for (i, tide) in self.tide.iter().enumerate() {
            plausible(tide.amplitude_m, &format!("tide[{i}].amplitude_m"));
        }
        for (i, tide) in self.tide.iter().enumerate() {
            let place = |key: &str| format!("tide[{i}].{key}");
            violations.require_positive(tide.period_s, &place("period_s"));
            violations.require(tide.highest.is_finite(), &place("highest"), || {
                "is not finite; give seconds".into()
            });
        }
        violations
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_height_is_a_close_lower_bound() {
        let tide = |amplitude_m, period_s, highest| LevelConstituent {
            amplitude_m,
            period_s,
            highest,
        };
        let level = WaterLevel {
            height_m: 1.2,
            tide: vec![tide(1.1, 44_714.0, 5_000.0), tide(0.4, 43_200.0, -900.0)],
        };
        for (from_s, until_s) in [(0.0, 3_600.0), (5_000.0, 60_000.0), (7.0, 7.0)] {
            let fine =
                (0..=100_000).map(|k| level.at(from_s + (until_s - from_s) * f64::from(k) / 1e5));
            let true_m = fine.fold(f64::INFINITY, f64::min);
            let least_m = level.least_until(from_s, until_s);
            assert!(
                least_m <= true_m && least_m > true_m - 0.01,
                "{least_m} {true_m}"
            );
        }
    }

    #[test]
    fn malformed_tides_are_named() {
        let level = WaterLevel {
            height_m: f64::NAN,
            tide: vec![LevelConstituent {
                amplitude_m: 1e3,
                period_s: 0.0,
                highest: f64::INFINITY,
            }],
        };
        assert_eq!(level.validate().total(), 4, "{}", level.validate());
    }
}
