//! A route of the memetic algorithm.

use super::search_space::SearchSpace;
use auv_graph::RouteTotals;

/// A route in the numbers of the search space, with its sums.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Tour {
    pub(crate) nodes: Vec<u32>,
    pub(crate) profit: f64,
    pub(crate) time_s: f64,
}

impl Tour {
    pub(crate) fn new(nodes: Vec<u32>, space: &SearchSpace) -> Self {
        let mut tour = Self {
            nodes,
            ..Self::default()
        };
        tour.sum(space);
        tour
    }

    /// Computes profit and time from the nodes.
    pub(crate) fn sum(&mut self, space: &SearchSpace) {
        let sum = space.sum(&self.nodes);
        (self.profit, self.time_s) = (sum.profit, sum.time_s);
    }

    /// Time available less the time of the route.
    pub(crate) fn time_left_s(&self, space: &SearchSpace) -> f64 {
        space.time_available_s - self.time_s
    }

    /// Profit plus the price of the time left: members of a population compete by this.
    pub(crate) fn worth(&self, space: &SearchSpace) -> f64 {
        self.profit + space.price * self.time_left_s(space)
    }

    /// Profit per second; positive even where nothing is earned or no time passes.
    pub(crate) fn profit_per_second(&self) -> f64 {
        (self.profit / self.time_s.max(1e-9)).max(1e-9)
    }

    /// The totals that the objective depends on; the others are 0.
    pub(crate) fn totals(&self) -> RouteTotals {
        RouteTotals {
            weight: self.profit,
            time_s: self.time_s,
            ..RouteTotals::default()
        }
    }
}
