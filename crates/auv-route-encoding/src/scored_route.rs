//! A route with its score.

use crate::usable_arcs::UsableArcs;
use auv_graph::{NodeId, Route};
use auv_planning::Score;

/// A route under search, with its score.
#[derive(Clone, Debug, PartialEq)]
pub struct ScoredRoute {
    /// The nodes in order; empty when there is no route.
    pub nodes: Vec<NodeId>,
    /// The cost under the problem's objective, and the excess over the time available as a share of
    /// it. Both are infinite when there is no route.
    pub score: Score,
}

impl ScoredRoute {
    /// No route at all: worse than any route.
    #[must_use]
    pub const fn none() -> Self {
        Self {
            nodes: Vec::new(),
            score: Score::WORST,
        }
    }

    /// Scores the nodes: one evaluation. A sequence that is empty or uses an arc that may not be
    /// used gets [`Score::WORST`].
    pub fn evaluate(&mut self, arcs: &UsableArcs<'_>) {
        let totals = if self.nodes.is_empty() {
            None
        } else {
            arcs.totals(&self.nodes)
        };
        self.score = totals.map_or(Score::WORST, |totals| arcs.problem().score(&totals));
    }

    /// The route.
    #[must_use]
    pub fn route(&self) -> Route {
        Route::new(self.nodes.clone())
    }
}

impl Default for ScoredRoute {
    fn default() -> Self {
        Self::none()
    }
}
