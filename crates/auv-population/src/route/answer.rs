//! What any route planner has before it searches, and how it ends.

use super::Candidate;
use auv_graph::{QuickestTo, Route};
use auv_planning::{PlanError, Planned, RouteProblem, Stats, deb_order};

/// The routes known before any search: the quickest, and the incumbent where it is feasible.
#[derive(Clone, Debug)]
pub struct Standard {
    /// The better of the two.
    pub best: Candidate,
    /// Whether nothing is left to search: start and destination are one, or even the quickest
    /// route takes too long.
    pub settled: bool,
    /// The quickest ways to the destination.
    pub home: QuickestTo,
}

/// Checks the problem and finds the quickest route, which every planner's answer must match.
///
/// # Errors
/// [`PlanError::Invalid`] and [`PlanError::Unreachable`].
pub fn standard(problem: &RouteProblem<'_>) -> Result<Standard, PlanError> {
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
    let cost = |totals| problem.objective.cost(totals, problem.time_available_s);
    let mut best = Candidate {
        nodes: quickest.nodes().to_vec(),
        cost: cost(&totals),
        violation: problem.violation(totals.time_s),
    };
    let settled = problem.start == problem.destination || best.violation > 0.0;
    if let Some((route, totals)) = problem
        .incumbent
        .and_then(|route| Some((route, problem.check(route).ok()?)))
        && cost(&totals) <= best.cost
    {
        best.nodes = route.nodes().to_vec();
        best.cost = cost(&totals);
    }
    Ok(Standard {
        best,
        settled,
        home,
    })
}

/// A planner's answer: the route found, summed anew, or the one known before where that is better.
pub fn answer(
    problem: &RouteProblem<'_>,
    known: Candidate,
    found: Route,
    stats: Stats,
) -> Planned<Route> {
    if let Ok(totals) = problem
        .network
        .evaluate(&found, problem.removed, problem.times)
    {
        let cost = problem.objective.cost(&totals, problem.time_available_s);
        let violation = problem.violation(totals.time_s);
        if deb_order((violation, cost), (known.violation, known.cost)).is_le() {
            return Planned::new(found, cost, violation, stats);
        }
    }
    Planned::new(known.route(), known.cost, known.violation, stats)
}
