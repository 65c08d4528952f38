//! What any route planner has before it searches, and how it ends.

use super::Candidate;
use auv_graph::{QuickestTo, Route};
use auv_planning::baseline::greedy;
use auv_planning::{PlanError, Planned, RouteProblem, Run, Score, StopReason};

/// What is known before any search.
#[derive(Clone, Debug)]
pub struct Standard {
    /// The best route known: the quickest, the incumbent where it is feasible, or what was offered.
    pub best: Candidate,
    /// The quickest ways to the destination.
    pub home: QuickestTo,
}

impl Standard {
    /// Checks the problem and finds the quickest route, which every planner's answer must match.
    fn new(problem: &RouteProblem<'_>) -> Result<Self, PlanError> {
        problem.validate().into_result()?;
        let unreachable = || PlanError::Unreachable {
            start: problem.start.0,
            destination: problem.destination.0,
        };
        let home = problem
            .network
            .quickest_to(problem.destination, problem.removed, problem.times);
        let quickest = home.route_from(problem.start).ok_or_else(unreachable)?;
        let totals = problem
            .network
            .evaluate(&quickest, problem.removed, problem.times)
            .map_err(|_| unreachable())?;
        let best = Candidate {
            nodes: quickest.nodes().to_vec(),
            cost: problem.objective.cost(&totals, problem.time_available_s),
            violation: problem.violation(totals.time_s),
        };
        let mut standard = Self { best, home };
        if let Some(incumbent) = problem.incumbent {
            standard.offer(problem, incumbent);
        }
        Ok(standard)
    }

    /// Takes over the greedy route where clock or caller cut a search short: those who cannot wait
    /// still get what takes no search. What depends on seed and problem alone stays as it is.
    pub fn offer_greedy_if_cut_short(&mut self, problem: &RouteProblem<'_>, stop: StopReason) {
        if !stop.is_reproducible() {
            self.offer(problem, &greedy(problem, &self.home));
        }
    }

    /// Takes over a feasible route that costs no more than the best known.
    pub fn offer(&mut self, problem: &RouteProblem<'_>, route: &Route) {
        let Ok(totals) = problem.check(route) else {
            return;
        };
        let cost = problem.objective.cost(&totals, problem.time_available_s);
        if cost <= self.best.cost {
            self.best.nodes = route.nodes().to_vec();
            self.best.cost = cost;
        }
    }
}

/// Plans a route: checks the problem, lets `improve` search from what is known, and sums the route
/// it found anew. The answer is never worse than the best known. Where start and destination are
/// one, or even the quickest route takes too long, nothing is left to search.
///
/// # Errors
/// [`PlanError::Invalid`] and [`PlanError::Unreachable`].
pub fn plan(
    run: &mut Run<'_>,
    problem: &RouteProblem<'_>,
    improve: impl FnOnce(&mut Run<'_>, &mut Standard) -> (Route, StopReason),
) -> Result<Planned<Route>, PlanError> {
    let mut known = Standard::new(problem)?;
    let (found, reason) = if problem.start == problem.destination || known.best.violation > 0.0 {
        run.end_generation(known.best.score(), &[], &[]);
        (known.best.route(), StopReason::Optimal)
    } else {
        improve(run, &mut known)
    };
    let stats = run.stats(reason);
    if let Ok(totals) = problem
        .network
        .evaluate(&found, problem.removed, problem.times)
    {
        let cost = problem.objective.cost(&totals, problem.time_available_s);
        let violation = problem.violation(totals.time_s);
        if Score::new(violation, cost) <= known.best.score() {
            return Ok(Planned::new(found, cost, violation, stats));
        }
    }
    let Candidate {
        cost, violation, ..
    } = known.best;
    Ok(Planned::new(known.best.route(), cost, violation, stats))
}
