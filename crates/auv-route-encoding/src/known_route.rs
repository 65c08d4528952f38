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
