//! Profit and time, the two sums that every move of the search changes.

use std::ops::{Add, Sub};

/// Profit and time of an arc or of several, or the change of both by a move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ProfitTime {
    pub(crate) profit: f64,
    pub(crate) time_s: f64,
}

impl ProfitTime {
    /// A missing arc: it takes infinitely long.
    pub(crate) const MISSING: Self = Self {
        profit: 0.0,
        time_s: f64::INFINITY,
    };

    /// Profit less time at the price of a second.
    pub(crate) fn worth(self, price: f64) -> f64 {
        self.profit - price * self.time_s
    }
}

impl Add for ProfitTime {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            profit: self.profit + other.profit,
            time_s: self.time_s + other.time_s,
        }
    }
}

impl Sub for ProfitTime {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            profit: self.profit - other.profit,
            time_s: self.time_s - other.time_s,
        }
    }
}
