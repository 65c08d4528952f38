//! A route of the memetic algorithm.

use super::field::Field;
use auv_graph::RouteTotals;

/// A route in the field's numbering with its sums.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Tour {
    pub(crate) nodes: Vec<u32>,
    pub(crate) profit: f64,
    pub(crate) time_s: f64,
}

impl Tour {
    pub(crate) fn new(nodes: Vec<u32>, field: &Field) -> Self {
        let mut tour = Self {
            nodes,
            ..Self::default()
        };
        tour.sum(field);
        tour
    }

    /// Sums profit and time anew.
    pub(crate) fn sum(&mut self, field: &Field) {
        let sum = field.sum(&self.nodes);
        (self.profit, self.time_s) = (sum.profit, sum.time_s);
    }

    pub(crate) fn time_left_s(&self, field: &Field) -> f64 {
        field.time_available_s - self.time_s
    }

    /// Profit and the time left at its price: what routes compete by while they are bred.
    pub(crate) fn worth(&self, field: &Field) -> f64 {
        self.profit + field.price * self.time_left_s(field)
    }

    /// A positive rate even where nothing is earned or no time passes.
    pub(crate) fn profit_per_second(&self) -> f64 {
        (self.profit / self.time_s.max(1e-9)).max(1e-9)
    }

    pub(crate) fn totals(&self) -> RouteTotals {
        RouteTotals {
            weight: self.profit,
            time_s: self.time_s,
            ..RouteTotals::default()
        }
    }
}
