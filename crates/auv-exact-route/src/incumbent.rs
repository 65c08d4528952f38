//! The best route found, and what is proven about it.

use auv_graph::{NodeId, Route};
use auv_planning::RouteProblem;

/// The best route so far and the proven bound of the weight of all routes.
pub(crate) struct Incumbent<'a> {
    pub(crate) problem: &'a RouteProblem<'a>,
    pub(crate) route: Route,
    pub(crate) weight: f64,
    /// No route weighs more.
    pub(crate) bound: f64,
    /// Two different weights differ by at least this.
    pub(crate) gain: f64,
}

impl<'a> Incumbent<'a> {
    pub(crate) fn new(problem: &'a RouteProblem<'a>, route: Route, weight: f64) -> Self {
        Self {
            problem,
            route,
            weight,
            bound: f64::INFINITY,
            gain: 0.0,
        }
    }

    /// Takes a route if it is feasible and weighs more.
    pub(crate) fn offer(&mut self, route: &Route) {
        if let Ok(totals) = self.problem.check(route)
            && totals.weight > self.weight
        {
            self.weight = totals.weight;
            self.route = route.clone();
        }
    }

    /// Takes the route along some nodes if it is feasible and weighs more. Returns the best weight.
    pub(crate) fn offer_nodes(&mut self, nodes: impl IntoIterator<Item = usize>) -> f64 {
        let nodes = nodes.into_iter().map(|node| NodeId(node as u32));
        self.offer(&Route::new(nodes.collect()));
        self.weight
    }

    /// Whether no route can weigh more.
    pub(crate) fn is_proven(&self) -> bool {
        self.bound <= self.weight || self.bound < self.weight + self.gain
    }
}
