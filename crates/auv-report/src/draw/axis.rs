//! Axes: ranges, ticks, and what maps values to pixels.

use auv_types::libm;

/// An axis of a chart.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// What it shows, with the unit.
    pub label: String,
    /// Its range; `None`: fitted to the marks, with a margin.
    pub range: Option<(f64, f64)>,
    /// Whether values grow downwards or to the left, as depth does.
    pub reversed: bool,
    /// Whether 0 belongs to the range.
    pub from_zero: bool,
    /// Names at 0, 1, 2, ... instead of numbers.
    pub names: Vec<String>,
}

impl Axis {
    /// An axis with a label.
    #[must_use]
    pub fn new(label: &str) -> Self {
        Self {
            label: label.into(),
            ..Self::default()
        }
    }

    /// The same axis, starting at 0.
    #[must_use]
    pub fn from_zero(mut self) -> Self {
        self.from_zero = true;
        self
    }

    /// The same axis with a range.
    #[must_use]
    pub fn range(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }

    /// The same axis, growing downwards.
    #[must_use]
    pub fn reversed(mut self) -> Self {
        self.reversed = true;
        self
    }

    /// The same axis with names at 0, 1, 2, ...
    #[must_use]
    pub fn names<T: Into<String>>(mut self, names: impl IntoIterator<Item = T>) -> Self {
        self.names = names.into_iter().map(Into::into).collect();
        self.range = Some((-0.6, self.names.len() as f64 - 0.4));
        self
    }

    /// The range to draw, given the least and the greatest value of the marks.
    pub(crate) fn fitted(&self, seen: (f64, f64)) -> (f64, f64) {
        if let Some((low, high)) = self.range.filter(|(low, high)| low < high) {
            return (low, high);
        }
        let (mut low, mut high) = if seen.0 <= seen.1 { seen } else { (0.0, 1.0) };
        if self.from_zero {
            (low, high) = (low.min(0.0), high.max(0.0));
        }
        if high - low <= 1e-12 * (low.abs() + high.abs()) {
            let room = 0.1 * high.abs() + f64::from(high == 0.0);
            (low, high) = (low - room, high + room);
        }
        let room = 0.05 * (high - low);
        let keeps_low = self.from_zero && low == 0.0;
        let keeps_high = self.from_zero && high == 0.0;
        (
            if keeps_low { low } else { low - room },
            if keeps_high { high } else { high + room },
        )
    }

    /// Ticks with their labels.
    pub(crate) fn ticks(&self, (low, high): (f64, f64), most: usize) -> Vec<(f64, String)> {
        if !self.names.is_empty() {
            let named = self.names.iter().enumerate();
            return named.map(|(i, name)| (i as f64, name.clone())).collect();
        }
        if !(low.is_finite() && high.is_finite()) {
            return Vec::new();
        }
        let most = most.max(1);
        let between = |count: usize| {
            let step = nice_step((high - low) / count as f64);
            let (first, last) = (
                libm::ceil(low / step - 1e-9),
                libm::floor(high / step + 1e-9),
            );
            (step, first, last)
        };
        // A scale needs two ticks or more, better three.
        let (step, first, last) = (most..=2 * most)
            .map(between)
            .find(|(_, first, last)| last - first >= 2.0)
            .unwrap_or_else(|| between(most));
        let decimals = (-libm::floor(libm::log10(step) + 1e-9)).max(0.0) as usize;
        let count = (last - first).clamp(-1.0, 100.0) as i64;
        (0..=count)
            .map(|k| {
                let value = (first + k as f64) * step;
                let text = if decimals <= 4 {
                    format!("{:.decimals$}", if value == 0.0 { 0.0 } else { value })
                } else if value == 0.0 {
                    "0".into()
                } else {
                    // Rounded, so that 3e-5 is not 3.0000000000000004e-5.
                    let power = libm::pow(10.0, -(decimals as f64));
                    format!("{}e-{decimals}", libm::round(value / power))
                };
                (value, text)
            })
            .collect()
    }
}

/// The least of 1, 2, 5 times a power of ten that is at least `step`.
pub(crate) fn nice_step(step: f64) -> f64 {
    if !(step.is_finite() && step > 0.0) {
        return 1.0;
    }
    let power = libm::pow(10.0, libm::floor(libm::log10(step)));
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|&nice| nice >= step * (1.0 - 1e-9))
        .unwrap_or(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_within_the_range() {
        let texts = |low, high| {
            let ticks = Axis::new("").ticks((low, high), 5);
            ticks.into_iter().map(|(_, text)| text).collect::<Vec<_>>()
        };
        assert_eq!(
            texts(0.0, 10_000.0),
            ["0", "2000", "4000", "6000", "8000", "10000"]
        );
        assert_eq!(
            texts(-0.03, 0.07),
            ["-0.02", "0.00", "0.02", "0.04", "0.06"]
        );
        assert_eq!(texts(0.0, 4e-5), ["0", "1e-5", "2e-5", "3e-5", "4e-5"]);
        assert_eq!(texts(f64::NAN, 1.0).len(), 0);
    }

    #[test]
    fn a_range_that_misses_round_numbers_has_three_ticks_all_the_same() {
        for (low, high) in [(0.15, 3.5), (0.07, 2.9), (-0.3, 6.3), (99.0, 101.0)] {
            let ticks = Axis::new("").ticks((low, high), 3);
            assert!((3..=6).contains(&ticks.len()), "{ticks:?}");
        }
    }

    #[test]
    fn a_range_is_never_empty() {
        for seen in [(3.0, 3.0), (0.0, 0.0), (f64::INFINITY, f64::NEG_INFINITY)] {
            let (low, high) = Axis::new("").fitted(seen);
            assert!(low < high);
        }
    }
}
