//! What a box of a box plot shows.

/// Quartiles, 5 % and 95 % quantiles, and mean of a sample.
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
        let quantile = |share: f64| {
            let place = share * (sorted.len() - 1) as f64;
            let below = place.floor() as usize;
            let above = (below + 1).min(sorted.len() - 1);
            sorted[below] + (sorted[above] - sorted[below]) * (place - below as f64)
        };
        Some(Self {
            low: quantile(0.05),
            first_quartile: quantile(0.25),
            median: quantile(0.5),
            third_quartile: quantile(0.75),
            high: quantile(0.95),
            mean: sorted.iter().sum::<f64>() / sorted.len() as f64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_interpolate_and_the_rest_is_left_out() {
        let values: Vec<f64> = (0..=100).map(f64::from).chain([f64::NAN]).collect();
        let stats = BoxStats::of(&values).unwrap();
        assert_eq!(
            (stats.low, stats.median, stats.high, stats.mean),
            (5.0, 50.0, 95.0, 50.0)
        );
        assert_eq!(BoxStats::of(&[f64::INFINITY]), None);
    }
}
