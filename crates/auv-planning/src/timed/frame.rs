//! The frame that every planner of routes in time runs in.

use super::conflict::conflict;
use super::first_tour::{FirstTour, first_tour};
use super::partial::{Extended, PartialRoutes};
use super::timed_network::{Step, TimedNetwork};
use super::tour::TimedTour;
use crate::{Objective, PlanError, Planned, RouteProblem, Run, Schedule, StopReason};
use auv_graph::{NodeId, Route, RouteTotals, TimeModel};

/// Evaluations of partial routes for a first tour, and how many of them are kept, at most.
const MOST_FOR_FIRST: u64 = 50_000;
const MOST_KEPT_FOR_FIRST: usize = 200_000;

/// Plans a route in time: validates the problem, calls `improve` with the quickest tour (or the
/// incumbent), and scores the tour that `improve` leaves. The violation is the share of mandatory tasks
/// that are not done, or of the time that the quickest route lacks. `improve` gives
/// [`StopReason::Optimal`] only if no route does more mandatory tasks, or weighs more.
///
/// # Errors
/// [`PlanError::Invalid`], [`PlanError::Unreachable`], [`PlanError::Impossible`] for mandatory tasks that
/// provably cannot be done, [`PlanError::Failed`] where no tour is found that meets places again in time, and [`PlanError::Unsupported`] for objectives other than the most weight.
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
        FirstTour::Infeasible(nodes) => {
            let schedule = at_once(&tables, &nodes);
            if problem.violation(schedule.end_s) > 0.0 {
                return Ok(too_late(run, &tables, &nodes, schedule));
            }
            meeting_visits(run, &tables, planner)?
        }
    };
    if let Some(conflict) = conflict(&tables) {
        return Err(PlanError::Impossible { conflict });
    }
    if let Some(known) = incumbent_tour(&tables) {
        tour = known;
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

/// The incumbent as a tour, if it is feasible.
fn incumbent_tour(tables: &TimedNetwork<'_>) -> Option<TimedTour> {
    let problem = tables.problem;
    let incumbent = problem.incumbent?;
    let nodes = incumbent.nodes();
    let steps = nodes.iter().map(|node| Step::pass(node.0)).collect();
    let network = problem.network;
    let known = network.evaluate(incumbent, problem.removed, problem.times);
    let ends = nodes.first() == Some(&problem.start)
        && nodes
            .last()
            .is_some_and(|end| tables.destinations.contains(&end.0));
    TimedTour::new(tables, steps).filter(|_| known.is_ok() && ends)
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

/// A tour that meets the places of `visits` in time, where the quickest ways without waiting do not.
fn meeting_visits(
    run: &mut Run<'_>,
    tables: &TimedNetwork<'_>,
    planner: &str,
) -> Result<TimedTour, PlanError> {
    if let Some(conflict) = conflict(tables) {
        return Err(PlanError::Impossible { conflict });
    }
    let partial = PartialRoutes::new(run, tables, None);
    let (is_proven, found) = partial.map_or((false, None), |mut partial| {
        let extended = partial.extend(run, MOST_FOR_FIRST, MOST_KEPT_FOR_FIRST);
        (extended == Extended::All, partial.best())
    });
    found.ok_or_else(|| {
        let visits = tables.model.visits.as_ref();
        let every_s = visits.map_or(0.0, |visits| visits.every_s);
        let way = format!("way to a destination meets one of visits.nodes every {every_s} s");
        if is_proven {
            let conflict = format!("no {way}");
            PlanError::Impossible { conflict }
        } else {
            let (planner, reason) = (
                planner.into(),
                format!("no quick {way}, and it found no other in its time"),
            );
            PlanError::Failed { planner, reason }
        }
    })
}

/// The answer where even the quickest route takes too long.
fn too_late(
    run: &mut Run<'_>,
    tables: &TimedNetwork<'_>,
    nodes: &[u32],
    schedule: Schedule,
) -> Planned<Route> {
    let problem = tables.problem;
    let own = nodes
        .windows(2)
        .map(|pair| tables.own_weight(pair[0], pair[1]));
    let totals = RouteTotals {
        weight: own.fold(0.0, |sum, weight| sum + weight),
        time_s: schedule.end_s,
        ..RouteTotals::default()
    };
    let route = Route::new(nodes.iter().copied().map(NodeId).collect());
    let violation = problem.violation(totals.time_s);
    let answer = (route, schedule, totals);
    let planned = planned(run, problem, answer, violation, StopReason::Optimal);
    run.end_generation(planned.score(), &[], &[]);
    planned
}
