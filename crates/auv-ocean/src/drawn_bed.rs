//! A true bed drawn from the uncertainty of a chart.

use crate::SeaBed;
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Seed, libm};

/// A true bed: the charted depth plus its standard deviation times a smooth random field.
///
/// The field is a sum of cosines with normal wave numbers. Its values are nearly normal with mean 0 and
/// standard deviation 1, cut off at three; two places have the correlation `exp(-d^2 / (2 c^2))` at distance
/// `d` for the correlation length `c`. On land the chart is true.
///
/// # Determinism
/// The bed depends on chart, seed and correlation length only.
///
/// ```
/// use auv_ocean::{AnalyticBed, DrawnBed, SeaBed};
/// use auv_types::Seed;
///
/// let chart = AnalyticBed::new(60.0); // of 3 m standard deviation there
/// let truth = DrawnBed::draw(&chart, 300.0, Seed(1));
/// let error_m = truth.depth_at(100.0, 200.0) - 60.0;
/// assert!(error_m != 0.0 && error_m.abs() <= 9.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnBed<B> {
    chart: B,
    waves: Vec<Wave>,
    /// Bound of the field's slope, per metre.
    steepest: f64,
}

/// A cosine of the field.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wave {
    /// Wave numbers north and east, radians per metre.
    numbers: [f64; 2],
    phase: f64,
}

/// Number of cosines.
const WAVES: usize = 48;
/// Where the field is cut off, in standard deviations.
const MOST_SIGMAS: f64 = 3.0;
/// By how much a chart's standard deviation changes at most with its depth; 0.05 is an ordinary survey's.
const SIGMA_PER_DEPTH: f64 = 0.2;

impl<B: SeaBed> DrawnBed<B> {
    /// A bed drawn from a chart's standard deviation, with errors correlated over `correlation_m` metres.
    #[must_use]
    pub fn draw(chart: B, correlation_m: f64, seed: Seed) -> Self {
        let mut random = seed.stream(0);
        let waves: Vec<Wave> = (0..WAVES)
            .map(|_| Wave {
                numbers: normal_pair(&mut random).map(|x| x / correlation_m),
                phase: random.random_range(0.0..std::f64::consts::TAU),
            })
            .collect();
        let lengths = waves.iter().map(|wave| {
            let [n, e] = wave.numbers;
            libm::sqrt(n * n + e * e)
        });
        let steepest = scale() * lengths.sum::<f64>();
        Self {
            chart,
            waves,
            steepest,
        }
    }

    /// The field at a place, in standard deviations.
    fn sigmas_at(&self, north_m: f64, east_m: f64) -> f64 {
        let sum = self.waves.iter().fold(0.0, |sum, wave| {
            let [n, e] = wave.numbers;
            sum + libm::cos(n * north_m + e * east_m + wave.phase)
        });
        (scale() * sum).clamp(-MOST_SIGMAS, MOST_SIGMAS)
    }
}

/// The amplitude of each cosine, for a standard deviation of 1.
fn scale() -> f64 {
    libm::sqrt(2.0 / WAVES as f64)
}

/// Two independent normal numbers (Box and Muller 1958).
fn normal_pair(random: &mut ChaCha8Rng) -> [f64; 2] {
    let radius = libm::sqrt(-2.0 * libm::log(1.0 - random.random_range(0.0..1.0)));
    let angle = random.random_range(0.0..std::f64::consts::TAU);
    [radius * libm::cos(angle), radius * libm::sin(angle)]
}

impl<B: SeaBed> SeaBed for DrawnBed<B> {
    fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
        let charted_m = self.chart.depth_at(north_m, east_m);
        if charted_m <= 0.0 || !(north_m.is_finite() && east_m.is_finite()) {
            return charted_m;
        }
        // The error fades out towards the shore, so that the bed stays continuous.
        let sigma_m = self.chart.depth_sigma_m(north_m, east_m).min(charted_m);
        charted_m + sigma_m * self.sigmas_at(north_m, east_m)
    }

    fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
        let slope = self.chart.max_slope_near(north_m, east_m, radius_m);
        let sigma_m = self.chart.depth_sigma_m(north_m, east_m);
        let most_m = sigma_m + SIGMA_PER_DEPTH * slope * radius_m;
        // Near the shore the error's standard deviation is the depth.
        let shallowest_m = self.chart.depth_at(north_m, east_m) - slope * radius_m;
        let share = if shallowest_m < most_m {
            1.0
        } else {
            SIGMA_PER_DEPTH
        };
        slope * (1.0 + MOST_SIGMAS * share) + most_m * self.steepest
    }

    fn depth_sigma_m(&self, _north_m: f64, _east_m: f64) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AnalyticBed, BedFeature, Footprint};

    fn chart() -> AnalyticBed {
        let shore = Footprint::Beyond {
            through: [800.0, 0.0],
            towards: [900.0, 0.0],
        };
        AnalyticBed::new(80.0).with(BedFeature::new("shore", shore, -10.0, 300.0))
    }

    #[test]
    fn errors_have_the_charts_standard_deviation_and_the_correlation_length() {
        let flat = AnalyticBed::new(60.0);
        let (mut square, mut product) = (0.0, 0.0);
        let count = 4_000;
        for k in 0..count {
            let truth = DrawnBed::draw(&flat, 200.0, Seed(k));
            let sigmas = |n: f64| (truth.depth_at(n, 50.0) - 60.0) / 3.0;
            square += sigmas(0.0) * sigmas(0.0);
            product += sigmas(0.0) * sigmas(200.0);
        }
        let (variance, correlation) = (square / count as f64, product / square);
        assert!((variance - 1.0).abs() < 0.06, "{variance}");
        assert!((correlation - 0.61).abs() < 0.05, "{correlation}");
    }

    #[test]
    fn the_slope_bound_holds_and_land_stays_land() {
        let (chart, mut random) = (chart(), Seed(5).stream(0));
        let truth = DrawnBed::draw(&chart, 150.0, Seed(3));
        for _ in 0..400 {
            let mut draw = |low: f64, high: f64| random.random_range(low..high);
            let (n, e, radius_m) = (draw(0.0, 900.0), draw(-500.0, 500.0), draw(0.5, 60.0));
            let bound = truth.max_slope_near(n, e, radius_m);
            for k in 0..32 {
                let angle = f64::from(k) * 0.2;
                let (far_n, far_e) = (
                    n + radius_m * libm::cos(angle),
                    e + radius_m * libm::sin(angle),
                );
                let step_m = (truth.depth_at(far_n, far_e) - truth.depth_at(n, e)).abs();
                assert!(
                    step_m <= bound * radius_m + 1e-9,
                    "{step_m} over {radius_m}"
                );
            }
            let charted_m = chart.depth_at(n, e);
            assert!(charted_m > 0.0 || truth.depth_at(n, e) == charted_m);
        }
    }
}
