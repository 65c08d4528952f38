//! What makes a route in time the better one.

use super::descent::Descent;
use super::field::Field;
use super::polish::polish;
use super::tour::Tour;
use auv_planning::{Deadline, Objective, RouteCost, RouteProblem, TaskCost};

/// The objective as a function of weight and time, which all routes compared here keep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    route_cost: Option<RouteCost>,
    time_available_s: f64,
}

impl Goal {
    /// Descent steps that perfect a best route.
    const STEPS: u64 = 100;

    /// The problem's objective, unless it depends on more than weight and time.
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

    /// The route's cost.
    pub(crate) fn cost(&self, tour: &Tour) -> f64 {
        self.route_cost.map_or(-tour.profit, |cost| {
            cost.total(&tour.totals(), self.time_available_s, 0.0)
        })
    }

    /// Whether a route costs less, or as much in less time.
    pub(crate) fn prefers(&self, tour: &Tour, other: &Tour) -> bool {
        let (cost, other_cost) = (self.cost(tour), self.cost(other));
        cost < other_cost || (cost <= other_cost && tour.time_s < other.time_s)
    }

    /// Improves a best route by the objective alone, without a price of its own for time; with `late`
    /// until no single insertion, removal and insertion or swap does.
    pub(crate) fn perfect(
        &self,
        field: &Field,
        best: &mut Tour,
        descent: &mut Descent,
        deadline: Deadline<'_>,
        late: Option<usize>,
    ) {
        let mut tour = best.clone();
        let price = self.price(&tour);
        if !deadline.passed() {
            descent.improve(field, &mut tour, price, None, Self::STEPS, deadline);
        }
        if let Some(late) = late {
            polish(field, &mut tour, price, deadline, late);
        }
        if self.prefers(&tour, best) {
            *best = tour;
        }
    }

    /// What a second is worth in profit under the objective: next to nothing, or less than
    /// nothing where unused time costs.
    fn price(&self, tour: &Tour) -> f64 {
        const TIE: f64 = 1e-9;
        self.route_cost.map_or(TIE, |cost| {
            let profit = tour.profit * tour.profit / cost.task_factor.max(TIE);
            TIE - cost.time_factor * profit / self.time_available_s.max(TIE)
        })
    }
}
