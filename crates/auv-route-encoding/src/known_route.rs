//! The best route known before and beside a search, and the frame that every search runs in.

use crate::scored_route::ScoredRoute;
use auv_graph::{QuickestTo, Route};
use auv_planning::baseline::greedy;
use auv_planning::{PlanError, Planned, RouteProblem, Run, Score, StopReason};

/// The best route known without search.
#[derive(Clone, Debug)]
pub struct KnownRoute {
    /// The quickest route, or a better one that was offered.
    pub best: ScoredRoute,
    /// The quickest ways to the destination.
    pub home: QuickestTo,
}

impl KnownRoute {
    /// Validates the problem and takes the quickest route, or the incumbent if it is feasible and
    /// costs no more.
    fn new(problem: &RouteProblem<'_>) -> Result<Self, PlanError> {
        let quickest = problem.prepare()?;
        let mut known = Self {
            best: ScoredRoute {
                nodes: quickest.route.nodes().to_vec(),
                score: quickest.score,
            },
            home: quickest.home,
        };
        if let Some(incumbent) = problem.incumbent {
            known.offer(problem, incumbent);
        }
        Ok(known)
    }

    /// Takes the greedy route, if it is better, when the clock or the caller cut a search short: a
    /// caller in a hurry still gets what takes no search. After any other stop nothing changes, so
    /// that the answer depends on seed and problem alone.
    pub fn offer_greedy_if_cut_short(&mut self, problem: &RouteProblem<'_>, stop: StopReason) {
        if !stop.is_reproducible() {
            self.offer(problem, &greedy(problem, &self.home));
        }
    }

    /// Takes a route if it is feasible and costs no more than the best known.
    pub fn offer(&mut self, problem: &RouteProblem<'_>, route: &Route) {
        let Ok(totals) = problem.check(route) else {
            return;
        };
        let cost = problem.objective.cost(&totals, problem.time_available_s);
        if cost <= self.best.score.cost {
            self.best.nodes = route.nodes().to_vec();
            self.best.score.cost = cost;
        }
    }
}

/// Plans a route: validates the problem, calls `improve` with the best route known, and sums and
/// scores the route that `improve` returns. The answer is never worse than the best known.
///
/// `improve` is not called if start and destination are the same node, or if even the quickest route
/// takes longer than the time available.
///
/// # Errors
/// [`PlanError::Invalid`] and [`PlanError::Unreachable`].
pub fn plan_from_known(
    run: &mut Run<'_>,
    problem: &RouteProblem<'_>,
    improve: impl FnOnce(&mut Run<'_>, &mut KnownRoute) -> (Route, StopReason),
) -> Result<Planned<Route>, PlanError> {
    let mut known = KnownRoute::new(problem)?;
    let nothing_to_search =
        problem.start == problem.destination || known.best.score.violation > 0.0;
    let (found, reason) = if nothing_to_search {
        run.end_generation(known.best.score, &[], &[]);
        (known.best.route(), StopReason::Optimal)
    } else {
        improve(run, &mut known)
    };
    let stats = run.stats(reason);
    if let Ok(totals) = problem
        .network
        .evaluate(&found, problem.removed, problem.times)
    {
        let score = problem.score(&totals);
        if score <= known.best.score {
            return Ok(Planned::new(found, score.cost, score.violation, stats));
        }
    }
    let Score { violation, cost } = known.best.score;
    Ok(Planned::new(known.best.route(), cost, violation, stats))
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{EdgeSet, NodeId, RouteInstance, Terrain};
    use auv_planning::Budget;
    use auv_types::Seed;

    fn instance() -> RouteInstance {
        Terrain::figure12().draw(Seed(1)).unwrap()
    }

    fn run() -> Run<'static> {
        Run::new(Seed(0), Budget::evaluations(1))
    }

    #[test]
    fn the_answer_is_the_better_of_what_is_found_and_what_is_known() {
        let instance = instance();
        let (start, destination) = (instance.start, instance.destination);
        let problem = RouteProblem::new(&instance.network, start, destination, instance.budget_s);
        let quickest = problem.prepare().unwrap();
        let greedy = greedy(&problem, &quickest.home);
        let answer = |found: Route| {
            plan_from_known(&mut run(), &problem, |_, _| (found, StopReason::Finished)).unwrap()
        };
        let planned = answer(greedy.clone());
        assert!(planned.cost < quickest.score.cost && planned.best == greedy);
        // A route over a missing edge and one that visits a node twice.
        for nodes in [vec![start, NodeId(99), destination], vec![start, start]] {
            assert_eq!(answer(Route::new(nodes)).best, quickest.route);
        }
        let warm = RouteProblem {
            incumbent: Some(&greedy),
            ..problem
        };
        let found = quickest.route.clone();
        let planned = plan_from_known(&mut run(), &warm, |_, _| (found, StopReason::Finished));
        assert_eq!(planned.unwrap().best, greedy);
    }

    #[test]
    fn nothing_is_searched_without_a_route_in_time_or_a_way_to_go() {
        let instance = instance();
        let (start, destination) = (instance.start, instance.destination);
        for (to, time_s, violation) in [(start, 10.0, false), (destination, 10.0, true)] {
            let problem = RouteProblem::new(&instance.network, start, to, time_s);
            let planned = plan_from_known(&mut run(), &problem, |_, _| panic!("searched"));
            let planned = planned.unwrap();
            assert_eq!(planned.violation > 0.0, violation);
            assert_eq!(planned.stats.stop, StopReason::Optimal);
            assert_eq!(planned.best, problem.prepare().unwrap().route);
        }
    }

    #[test]
    fn only_a_feasible_route_that_costs_no_more_is_taken() {
        let instance = instance();
        let (start, destination) = (instance.start, instance.destination);
        let problem = RouteProblem::new(&instance.network, start, destination, 9_000.0);
        let mut known = KnownRoute::new(&problem).unwrap();
        let quickest = known.best.clone();
        known.offer(&problem, &Route::new(vec![start]));
        assert_eq!(known.best, quickest);
        known.offer_greedy_if_cut_short(&problem, StopReason::EvaluationsSpent);
        assert_eq!(known.best, quickest);
        known.offer_greedy_if_cut_short(&problem, StopReason::DeadlinePassed);
        assert!(known.best.score < quickest.score);
        let better = known.best.clone();
        known.offer(&problem, &quickest.route());
        assert_eq!(known.best, better);
        let totals = instance
            .network
            .evaluate(&better.route(), &EdgeSet::empty(), None);
        assert_eq!(better.score, problem.score(&totals.unwrap()));
    }
}
