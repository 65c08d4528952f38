//! What a route planner minimises.

use auv_graph::RouteTotals;

/// What makes one feasible route better than another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Objective {
    /// The most weight, ties broken by less time: the cost is minus the weight.
    #[default]
    MostWeight,
}

impl Objective {
    /// The cost of a route that adds up to `totals`.
    #[must_use]
    pub fn cost(&self, totals: &RouteTotals, _time_available_s: f64) -> f64 {
        match self {
            Self::MostWeight => -totals.weight,
        }
    }
}
