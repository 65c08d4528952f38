//! The planner: checks the problem, runs the proof and answers with its result.

use crate::in_time;
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
/// Upper bounds come from a linear relaxation: links in time, one at start and destination, at most two
/// at every other node, with inequalities of connectivity and of parity where they are violated. Few links
/// are columns; the others are priced. Reduced costs close links that cannot belong to a better route.
/// What is left is divided by whether a node is visited or a link used, the part of the highest bound
/// first.
///
/// Every bound is computed from the multipliers of the relaxation's rows, which prove it whatever they
/// are, with a margin for rounding. So errors of the linear program cannot make a bound too low.
///
/// # Budget
/// One evaluation is one pivot of the linear program. Stopped early, the planner gives the best route so
/// far, at least the greedy one and [`RouteProblem::incumbent`]. Then [`Planned::bound`] is minus a proven
/// upper bound of the weight, or `None` if there was no time for the first one. Otherwise it ends with
/// [`StopReason::Optimal`], or with [`StopReason::Finished`] if [`ExactSettings::most_parts`] do not suffice
/// for a proof.
///
/// A good incumbent makes proofs much quicker: give it the answer of another planner.
///
/// Above [`ExactSettings::most_nodes`] nodes it gives the greedy route and the bound of a knapsack with one
/// arc out of each node.
///
/// # Routes in time
/// All partial routes are extended, see [`PartialRoutes`](auv_planning::timed::PartialRoutes); one evaluation is
/// one extension. Above 128 nodes the bound is that of all tasks that can be reached.
///
/// # Determinism
/// Equal problems and evaluation budgets give equal bits. Nothing is random; one thread is used.
///
/// # References
/// Fischetti, Salazar and Toth, INFORMS Journal on Computing 10(2), 1998 (branch and cut for
/// orienteering); Ben-Ameur and Neto, Networks 49(1), 2007 (separation between two points).
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
        if let Some(model) = problem.time_model {
            return in_time::plan(run, problem, model, self.name());
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
