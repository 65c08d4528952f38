//! Statistics of samples: means, quantiles and what a box plot shows.

/// The mean of a sample; NaN of an empty one.
#[must_use]
pub fn mean(values: &[f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    values.iter().sum::<f64>() / values.len() as f64
}

/// The quantile of a sample at a share from 0 to 1, interpolated linearly between the two nearest
/// values in order; NaN of an empty sample. `total_cmp` orders the values, so that infinite ones
/// count and NaN is the greatest.
#[must_use]
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    of_sorted(&sorted, share)
}

/// The quantile at 0.5: see [`quantile`].
#[must_use]
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

fn of_sorted(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let place = share.clamp(0.0, 1.0) * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    let rest = place - below as f64;
    if rest > 0.0 && sorted[above] > sorted[below] {
        sorted[below] + (sorted[above] - sorted[below]) * rest
    } else {
        sorted[below]
    }
}

/// Quartiles, 5 % and 95 % quantiles, and mean of a sample: what a box of a box plot shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxStats {
    /// 5 % quantile: the lower whisker.
    pub low: f64,
    /// First quartile.
    pub first_quartile: f64,
    /// Median.
    pub median: f64,
    /// Third quartile.
    pub third_quartile: f64,
    /// 95 % quantile: the upper whisker.
    pub high: f64,
    /// Mean.
    pub mean: f64,
}

impl BoxStats {
    /// The statistics of the finite values among `values`; `None` without any.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
        if sorted.is_empty() {
            return None;
        }
        sorted.sort_by(f64::total_cmp);
        Some(Self {
            low: of_sorted(&sorted, 0.05),
            first_quartile: of_sorted(&sorted, 0.25),
            median: of_sorted(&sorted, 0.5),
            third_quartile: of_sorted(&sorted, 0.75),
            high: of_sorted(&sorted, 0.95),
            mean: mean(&sorted),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_interpolate_between_values_in_order() {
        let values = [4.0, 1.0, 3.0, 2.0];
        assert_eq!(median(&values), 2.5);
        assert_eq!([quantile(&values, 0.0), quantile(&values, 1.0)], [1.0, 4.0]);
        assert_eq!(mean(&values), 2.5);
        assert!(mean(&[]).is_nan() && median(&[]).is_nan());
    }

    #[test]
    fn infinite_values_count_as_the_greatest() {
        let values = [1.0, f64::INFINITY, 2.0];
        assert_eq!(
            [median(&values), quantile(&values, 1.0)],
            [2.0, f64::INFINITY]
        );
        assert_eq!(quantile(&[f64::INFINITY; 3], 0.6), f64::INFINITY);
    }

    #[test]
    fn a_box_leaves_out_what_is_not_finite() {
        let values: Vec<f64> = (0..=100).map(f64::from).chain([f64::NAN]).collect();
        let stats = BoxStats::of(&values).unwrap();
        assert_eq!(
            (stats.low, stats.median, stats.high, stats.mean),
            (5.0, 50.0, 95.0, 50.0)
        );
        assert_eq!(BoxStats::of(&[f64::INFINITY]), None);
    }
}
