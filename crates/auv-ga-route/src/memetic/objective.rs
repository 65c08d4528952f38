//! Which of two routes in time is better under the problem's objective.

use super::tour::Tour;
use auv_planning::{Objective, RouteCost, RouteProblem, TaskCost};

/// The problem's objective as a function of weight and time. All tours that it compares are in time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TourObjective {
    /// `None`: the most weight.
    route_cost: Option<RouteCost>,
    time_available_s: f64,
}

impl TourObjective {
    /// `None` if the objective depends on more than weight and time.
    pub(crate) fn new(problem: &RouteProblem<'_>) -> Option<Self> {
        let route_cost = match problem.objective {
            Objective::MostWeight => None,
            Objective::RouteCost(cost) if cost.task == TaskCost::InverseWeight => Some(cost),
            _ => return None,
        };
        Some(Self {
            route_cost,
            time_available_s: problem.time_available_s,
        })
    }

    /// The cost of a tour.
    pub(crate) fn cost(&self, tour: &Tour) -> f64 {
        self.route_cost.map_or(-tour.profit, |cost| {
            cost.total(&tour.totals(), self.time_available_s, 0.0)
        })
    }

    /// Whether a tour costs less than another, or the same and takes less time.
    pub(crate) fn prefers(&self, tour: &Tour, other: &Tour) -> bool {
        let (cost, other_cost) = (self.cost(tour), self.cost(other));
        cost < other_cost || (cost <= other_cost && tour.time_s < other.time_s)
    }

    /// The profit that a second is worth under the objective, near a tour: almost nothing, or a
    /// negative amount if unused time costs.
    pub(crate) fn price(&self, tour: &Tour) -> f64 {
        /// Decides between routes of equal profit.
        const TIE: f64 = 1e-9;
        self.route_cost.map_or(TIE, |cost| {
            let profit = tour.profit * tour.profit / cost.task_factor.max(TIE);
            TIE - cost.time_factor * profit / self.time_available_s.max(TIE)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{NodeId, Terrain};

    fn tour(profit: f64, time_s: f64) -> Tour {
        Tour {
            nodes: Vec::new(),
            profit,
            time_s,
        }
    }

    #[test]
    fn the_price_is_the_slope_of_the_cost() {
        let network = Terrain::figure12()
            .draw(auv_types::Seed(1))
            .unwrap()
            .network;
        let problem = RouteProblem {
            objective: Objective::paper(),
            ..RouteProblem::new(&network, NodeId(0), NodeId(1), 9_000.0)
        };
        let objective = TourObjective::new(&problem).unwrap();
        let (base, step) = (tour(40.0, 7_000.0), 1e-3);
        // What a second and what a unit of profit change the cost by.
        let slope = |changed: Tour| (objective.cost(&changed) - objective.cost(&base)) / step;
        let by_time = slope(tour(40.0, 7_000.0 + step));
        let by_profit = slope(tour(40.0 + step, 7_000.0));
        let (price, expected) = (objective.price(&base), by_time / -by_profit);
        assert!((price - expected).abs() < 1e-3 * expected.abs(), "{price}");
        assert!(price < 0.0, "the paper's cost penalises unused time");
    }

    #[test]
    fn equal_costs_are_decided_by_time() {
        let network = Terrain::figure12()
            .draw(auv_types::Seed(1))
            .unwrap()
            .network;
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(1), 9_000.0);
        let objective = TourObjective::new(&problem).unwrap();
        assert!(objective.prefers(&tour(2.0, 9.0), &tour(1.0, 1.0)));
        assert!(objective.prefers(&tour(2.0, 8.0), &tour(2.0, 9.0)));
        assert!(!objective.prefers(&tour(2.0, 9.0), &tour(2.0, 9.0)));
    }
}
