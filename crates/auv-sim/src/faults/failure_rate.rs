//! The confidence interval of a measured failure rate.

use auv_types::libm;

/// Number of failures among independent runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FailureRate {
    /// Number of failed runs.
    pub failures: u64,
    /// Number of runs.
    pub runs: u64,
}

impl FailureRate {
    /// The exact two-sided 95 % confidence interval of the failure probability (Clopper and Pearson). With
    /// no failure in n runs its upper end is about 3.7 / n.
    #[must_use]
    pub fn bounds_95(&self) -> (f64, f64) {
        let Self { failures, runs } = *self;
        if runs == 0 {
            return (0.0, 1.0);
        }
        let low = if failures == 0 {
            0.0
        } else {
            // The least p for which at least this many failures have a probability of 2.5 %.
            bisect(|p| 1.0 - self.cumulative(failures - 1, p) < 0.025)
        };
        let high = if failures >= runs {
            1.0
        } else {
            bisect(|p| self.cumulative(failures, p) > 0.025)
        };
        (low, high)
    }

    /// The probability of at most `k` failures if each run fails with probability `p`.
    fn cumulative(&self, k: u64, p: f64) -> f64 {
        let n = self.runs as f64;
        let (log_p, log_q) = (libm::log(p), libm::log1p(-p));
        let chance = |i: u64| {
            let i = i as f64;
            let ways = libm::lgamma(n + 1.0) - libm::lgamma(i + 1.0) - libm::lgamma(n - i + 1.0);
            libm::exp(ways + i * log_p + (n - i) * log_q)
        };
        (0..=k).map(chance).sum()
    }
}

/// The p at which a condition that holds for small p stops holding.
fn bisect(holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_those_of_the_tables() {
        // Published values of the exact interval.
        for (failures, runs, low, high) in [
            (0, 100, 0.0, 0.036_217),
            (1, 100, 0.000_253, 0.054_459),
            (5, 20, 0.086_571, 0.491_046),
            (20, 20, 0.831_566, 1.0),
        ] {
            let bounds = FailureRate { failures, runs }.bounds_95();
            assert!(
                (bounds.0 - low).abs() < 2e-6,
                "{failures}/{runs}: {bounds:?}"
            );
            assert!(
                (bounds.1 - high).abs() < 2e-6,
                "{failures}/{runs}: {bounds:?}"
            );
        }
    }
}
