//! Which of two routes is better.

use crate::scored_route::ScoredRoute;
use std::cmp::Ordering;

/// What makes a route better than another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum RouteRanking {
    /// Less violation, then less cost: every late route ranks behind every one in time.
    #[default]
    Deb,
    /// The cost alone, which may include a penalty for lateness.
    Cost,
}

impl RouteRanking {
    /// The order of two routes, the better one first.
    #[must_use]
    pub fn order(self, a: &ScoredRoute, b: &ScoredRoute) -> Ordering {
        match self {
            Self::Deb => a.score.cmp(&b.score),
            Self::Cost => a.score.cost.total_cmp(&b.score.cost),
        }
    }

    /// One number in roughly the same order, for the roulette wheel: the cost, increased in
    /// proportion to the violation.
    #[must_use]
    pub fn penalised(self, route: &ScoredRoute) -> f64 {
        let score = route.score;
        match self {
            Self::Deb => score.cost + score.violation * score.cost.abs().max(1.0),
            Self::Cost => score.cost,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_planning::Score;

    fn route(violation: f64, cost: f64) -> ScoredRoute {
        ScoredRoute {
            nodes: Vec::new(),
            score: Score::new(violation, cost),
        }
    }

    #[test]
    fn debs_rule_puts_late_routes_last_and_the_cost_alone_does_not() {
        let (in_time, late) = (route(0.0, 2.0), route(0.5, 1.0));
        assert!(RouteRanking::Deb.order(&in_time, &late).is_lt());
        assert!(RouteRanking::Cost.order(&in_time, &late).is_gt());
        assert_eq!(RouteRanking::Deb.penalised(&late), 1.5);
        assert_eq!(RouteRanking::Deb.penalised(&route(0.5, -8.0)), -4.0);
        assert_eq!(RouteRanking::Cost.penalised(&late), 1.0);
        assert!(
            RouteRanking::Deb
                .penalised(&ScoredRoute::none())
                .is_infinite()
        );
    }
}
