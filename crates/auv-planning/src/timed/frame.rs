//! The frame that every planner of routes in time runs in.

use super::conflict::conflict;
use super::first_tour::{FirstTour, first_tour};
use super::timed_network::{Step, TimedNetwork};
use super::tour::TimedTour;
use crate::{Objective, PlanError, Planned, RouteProblem, Run, Schedule, StopReason};
use auv_graph::{NodeId, Route, RouteTotals, TimeModel};

/// Plans a route in time: validates the problem, calls `improve` with the quickest tour (or the
/// incumbent), and scores the tour that `improve` leaves. The violation is the share of mandatory tasks
/// that are not done, or of the time that the quickest route lacks. `improve` gives
/// [`StopReason::Optimal`] only if no route does more mandatory tasks, or weighs more.
///
/// # Errors
/// [`PlanError::Invalid`], [`PlanError::Unreachable`], [`PlanError::Impossible`] for mandatory tasks that
/// provably cannot be done, and [`PlanError::Unsupported`] for objectives other than the most weight.
pub fn plan_in_time(
    run: &mut Run<'_>,
    problem: &RouteProblem<'_>,
    model: &TimeModel,
    planner: &str,
    improve: impl FnOnce(&mut Run<'_>, &TimedNetwork<'_>, &mut TimedTour) -> StopReason,
) -> Result<Planned<Route>, PlanError> {
    problem.validate().into_result()?;
    if problem.objective != Objective::MostWeight {
        return Err(PlanError::Unsupported {
            planner: planner.into(),
            what: "routes in time with objectives other than the most weight".into(),
        });
    }
    let tables = TimedNetwork::new(problem, model);
    let mut tour = match first_tour(&tables)? {
        FirstTour::Feasible(tour) => *tour,
        FirstTour::Infeasible(nodes) => return too_late(run, &tables, &nodes),
    };
    if let Some(conflict) = conflict(&tables) {
        return Err(PlanError::Impossible { conflict });
    }
    if let Some(incumbent) = problem.incumbent {
        let steps = incumbent
            .nodes()
            .iter()
            .map(|node| Step::pass(node.0))
            .collect();
        let known = problem
            .network
            .evaluate(incumbent, problem.removed, problem.times)
            .is_ok();
        let ends = incumbent.nodes().first() == Some(&problem.start)
            && incumbent
                .nodes()
                .last()
                .is_some_and(|end| tables.destinations.contains(&end.0));
        if let Some(known) = TimedTour::new(&tables, steps).filter(|_| known && ends) {
            tour = known;
        }
    }
    let reason = improve(run, &tables, &mut tour);
    if reason == StopReason::Optimal && tour.missing(&tables) > 0 {
        let all = model.tasks.iter().filter(|task| task.mandatory);
        let names: Vec<String> = all.map(|task| task.name.to_string()).collect();
        let conflict = format!("tasks {} cannot all be done", names.join(", "));
        return Err(PlanError::Impossible { conflict });
    }
    let (route, schedule, totals) = tour.answer(&tables);
    let mandatory = tables.works.iter().filter(|work| work.is_mandatory).count();
    let violation = tour.missing(&tables) as f64 / mandatory.max(1) as f64;
    Ok(planned(
        run,
        problem,
        (route, schedule, totals),
        violation,
        reason,
    ))
}

fn planned(
    run: &Run<'_>,
    problem: &RouteProblem<'_>,
    (route, schedule, totals): (Route, Schedule, RouteTotals),
    violation: f64,
    reason: StopReason,
) -> Planned<Route> {
    let cost = problem.objective.cost(&totals, problem.time_available_s);
    let mut planned = Planned::new(route, cost, violation, run.stats(reason));
    planned.schedule = Some(schedule);
    planned
}

/// The schedule of a route that leaves every node at once and does no tasks but the edges' own. It ends at
/// infinity where no usable arc leads on.
#[must_use]
pub fn schedule_at_once(problem: &RouteProblem<'_>, model: &TimeModel, route: &Route) -> Schedule {
    let nodes: Vec<u32> = route.nodes().iter().map(|node| node.0).collect();
    at_once(&TimedNetwork::new(problem, model), &nodes)
}

fn at_once(tables: &TimedNetwork<'_>, nodes: &[u32]) -> Schedule {
    let mut schedule = Schedule::default();
    for pair in nodes.windows(2) {
        schedule.departures_s.push(schedule.end_s);
        schedule.end_s = tables.arrival_s(pair[0], pair[1], schedule.end_s);
    }
    schedule
}

/// The answer where even the quickest route takes too long.
fn too_late(
    run: &mut Run<'_>,
    tables: &TimedNetwork<'_>,
    nodes: &[u32],
) -> Result<Planned<Route>, PlanError> {
    let problem = tables.problem;
    let schedule = at_once(tables, nodes);
    let own = nodes
        .windows(2)
        .map(|pair| tables.own_weight(pair[0], pair[1]));
    let weight = own.fold(0.0, |sum, weight| sum + weight);
    let violation = problem.violation(schedule.end_s);
    if violation <= 0.0 {
        let visits = tables.model.visits.as_ref();
        let every_s = visits.map_or(0.0, |visits| visits.every_s);
        let conflict =
            format!("no way to a destination meets one of visits.nodes every {every_s} s");
        return Err(PlanError::Impossible { conflict });
    }
    let totals = RouteTotals {
        weight,
        time_s: schedule.end_s,
        ..RouteTotals::default()
    };
    let route = Route::new(nodes.iter().copied().map(NodeId).collect());
    let answer = (route, schedule, totals);
    let planned = planned(run, problem, answer, violation, StopReason::Optimal);
    run.end_generation(planned.score(), &[], &[]);
    Ok(planned)
}
