//! The planner: checks the problem, runs the proof and answers with its result.

use crate::incumbent::Incumbent;
use crate::proof::prove;
use crate::settings::ExactSettings;
use auv_graph::Route;
use auv_planning::baseline::greedy;
use auv_planning::{
    Objective, PlanError, Planned, RoutePlanner, RouteProblem, Run, Score, StopReason,
};

/// Finds the route of most weight with a proof, or a route and a bound of the most weight.
///
/// # Algorithm
/// Upper bounds come from relaxed walks, which may return to a node once they have forgotten it, at
/// prices for time and visits. A subgradient method lowers these bounds. A search over partial routes,
/// layer by layer, keeps those of highest bounds. What it drops bounds what it may have missed; if that
/// is nothing above the best route, the route is proven optimal. Between searches, arcs that cannot
/// belong to a better route are removed, walks remember more, and the layers widen.
///
/// # Budget
/// One evaluation is one label, or one node of one layer of relaxed walks, extended over its arcs.
/// Stopped early, the planner gives the best route so far, at least the greedy one. Then
/// [`Planned::bound`] is minus a proven upper bound of the weight, or `None` if there was no time for
/// the first one. Otherwise it ends with [`StopReason::Optimal`], or with [`StopReason::Finished`] if
/// [`ExactSettings::most_labels`] labels do not suffice for a proof.
///
/// Above 2000 nodes it gives the greedy route and the bound of a knapsack with one arc out of each
/// node.
///
/// # Determinism
/// Equal problems and evaluation budgets give equal bits. Nothing is random; one thread is used.
///
/// # References
/// Baldacci, Mingozzi and Roberti, Operations Research 59(5), 2011 (ng-routes); Righini and Salani,
/// Computers and Operations Research 36(4), 2009 (orienteering by decremental relaxation).
#[derive(Clone, Debug, Default)]
pub struct ExactRoute {
    settings: ExactSettings,
}

impl ExactRoute {
    /// A planner with these settings.
    #[must_use]
    pub const fn new(settings: ExactSettings) -> Self {
        Self { settings }
    }
}

impl RoutePlanner for ExactRoute {
    fn name(&self) -> &str {
        "exact"
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        self.settings.validate().into_result()?;
        if problem.objective != Objective::MostWeight {
            return Err(PlanError::Unsupported {
                planner: self.name().into(),
                what: "objectives other than the most weight".into(),
            });
        }
        let quickest = problem.prepare()?;
        let score = quickest.score;
        if !score.is_feasible() {
            run.end_generation(score, &[], &[]);
            let stats = run.stats(StopReason::Finished);
            let (cost, violation) = (score.cost, score.violation);
            return Ok(Planned::new(quickest.route, cost, violation, stats));
        }
        let mut incumbent = Incumbent::new(problem, quickest.route, quickest.totals.weight);
        if problem.start == problem.destination {
            incumbent.bound = incumbent.weight;
        } else {
            if let Some(known) = problem.incumbent {
                incumbent.offer(known);
            }
            run.grant(1);
            incumbent.offer(&greedy(problem, &quickest.home));
            if prove(&self.settings, run, &mut incumbent, &quickest.home).is_none() {
                // It stopped in the middle of a step: this records why.
                run.should_stop();
            }
        }
        Ok(answer(run, incumbent))
    }
}

/// The best route with its bound.
fn answer(run: &mut Run<'_>, incumbent: Incumbent<'_>) -> Planned<Route> {
    let (cost, is_proven) = (-incumbent.weight, incumbent.is_proven());
    run.end_generation(Score::feasible(cost), &[], &[]);
    let stats = run.stats(StopReason::Finished);
    let bound = incumbent.bound.max(incumbent.weight);
    let mut planned = Planned::new(incumbent.route, cost, 0.0, stats);
    planned.bound = bound.is_finite().then_some(-bound);
    if is_proven {
        planned.bound = Some(planned.cost);
        planned.stats.stop = StopReason::Optimal;
    }
    planned
}
