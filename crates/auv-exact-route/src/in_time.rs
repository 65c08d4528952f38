//! The proof for routes in time: all partial routes are extended.

use auv_graph::{Route, TimeModel};
use auv_planning::timed::{
    Extended, PartialRoutes, TimedNetwork, TimedTour, fill, most_of_all, pieces, plan_in_time,
};
use auv_planning::{PlanError, Planned, RouteProblem, Run, StopReason};

/// Most partial routes that are kept.
const MOST_KEPT: usize = 3_000_000;

/// The route in time of most weight, or the best one found and a bound.
///
/// # Errors
/// Those of [`plan_in_time`].
pub(crate) fn plan(
    run: &mut Run<'_>,
    problem: &RouteProblem<'_>,
    model: &TimeModel,
    planner: &str,
) -> Result<Planned<Route>, PlanError> {
    let mut bound = None;
    let mut planned = plan_in_time(run, problem, model, planner, |run, tables, tour| {
        let (reason, most) = prove(run, tables, tour);
        bound = Some(most);
        reason
    })?;
    if planned.violation <= 0.0 {
        planned.bound = bound.map(|most| (-most).min(planned.cost));
    }
    Ok(planned)
}

/// Improves a tour; why the search ended, and a bound of the weight.
fn prove(run: &mut Run<'_>, tables: &TimedNetwork<'_>, tour: &mut TimedTour) -> (StopReason, f64) {
    run.grant(1);
    fill(tables, tour, &pieces(tables));
    let Some(mut partial) = PartialRoutes::new(run, tables, Some(tour)) else {
        return (StopReason::Finished, most_of_all(tables));
    };
    let is_whole = partial.extend(run, u64::MAX, MOST_KEPT) == Extended::All;
    if let Some(best) = partial.best() {
        *tour = best;
    }
    let most = partial.bound().max(tour.weight());
    let is_missing = tour.missing(tables) > 0;
    if is_whole && (is_missing || most <= tour.weight() + 1e-9 * tour.weight().abs()) {
        (StopReason::Optimal, tour.weight())
    } else {
        (StopReason::Finished, most)
    }
}
