//! Quantiles of the chi-square distribution with 3 and 6 degrees of freedom.

use auv_types::libm;

/// The degrees of freedom of a gate or a confidence region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dimensions {
    /// A position.
    Three,
    /// A position and a velocity.
    Six,
}

/// The probability that a chi-square variable is at most `x`.
pub(crate) fn cdf(dimensions: Dimensions, x: f64) -> f64 {
    let half = 0.5 * x.max(0.0);
    let root = libm::sqrt(half);
    match dimensions {
        Dimensions::Three => {
            libm::erf(root) - 2.0 / libm::sqrt(std::f64::consts::PI) * root * libm::exp(-half)
        }
        Dimensions::Six => 1.0 - libm::exp(-half) * (1.0 + half + 0.5 * half * half),
    }
}

/// The value below which a chi-square variable lies with a probability in `[0, 1)`.
pub(crate) fn quantile(dimensions: Dimensions, probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 200.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if cdf(dimensions, middle) < probability {
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
    fn quantiles_match_the_tables() {
        for (dimensions, probability, table) in [
            (Dimensions::Three, 0.99, 11.344_867),
            (Dimensions::Three, 0.738_535_9, 4.0),
            (Dimensions::Six, 0.99, 16.811_894),
            (Dimensions::Six, 0.05, 1.635_383),
        ] {
            let found = quantile(dimensions, probability);
            assert!(
                (found - table).abs() < 1e-5,
                "{dimensions:?} {probability}: {found}"
            );
        }
    }
}
