//! What every route planner computes before it searches.

use crate::{PlanError, RouteProblem, Score};
use auv_graph::{QuickestTo, Route, RouteTotals};

/// The quickest route of a problem, and the quickest ways to the destination from all nodes.
///
/// If this route takes longer than the time available, no route is feasible.
#[derive(Clone, Debug)]
pub struct QuickestRoute {
    /// The route.
    pub route: Route,
    /// Its totals.
    pub totals: RouteTotals,
    /// Its score under the problem's objective.
    pub score: Score,
    /// The quickest ways to the destination.
    pub home: QuickestTo,
}

impl RouteProblem<'_> {
    /// Validates the problem and finds its quickest route. The answer of a planner must not be worse.
    ///
    /// # Errors
    /// [`PlanError::Invalid`] when the problem is malformed, [`PlanError::Unreachable`] when no edges
    /// lead to the destination, [`PlanError::NotInTime`] when it asks for a route in time.
    pub fn prepare(&self) -> Result<QuickestRoute, PlanError> {
        self.validate().into_result()?;
        if self.time_model.is_some() {
            return Err(PlanError::NotInTime);
        }
        self.find_quickest()
    }

    /// The quickest route of a valid problem, whatever it earns.
    ///
    /// # Errors
    /// [`PlanError::Unreachable`] when no edges lead to the destination.
    pub fn quickest(&self) -> Result<(Route, RouteTotals), PlanError> {
        let quickest = self.find_quickest()?;
        Ok((quickest.route, quickest.totals))
    }

    fn find_quickest(&self) -> Result<QuickestRoute, PlanError> {
        let unreachable = PlanError::Unreachable {
            start: self.start.0,
            destination: self.destination.0,
        };
        let home = self
            .network
            .quickest_to(self.destination, self.removed, self.times);
        let route = home.route_from(self.start).ok_or(unreachable.clone())?;
        let totals = self
            .network
            .evaluate(&route, self.removed, self.times)
            .map_err(|_| unreachable)?;
        let score = self.score(&totals);
        Ok(QuickestRoute {
            route,
            totals,
            score,
            home,
        })
    }

    /// The score of a route with these totals.
    #[must_use]
    pub fn score(&self, totals: &RouteTotals) -> Score {
        let cost = self.objective.cost(totals, self.time_available_s);
        Score::new(self.violation(totals.time_s), cost)
    }
}
