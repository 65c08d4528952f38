//! Asking for routes and judging the answers.

use crate::check::Acceptor;
use crate::forecast::FieldForecast;
use crate::mode::Leg;
use crate::question::{DroppedLeg, RouteFrom, RouteQuestion};
use crate::view::View;
use crate::{RouteCall, RouteReason, RouteRequest, agenda, check, due, route_from_vehicle, times};
use auv_graph::{EdgeSet, Network, NetworkArc, NodeId, Route, RouteTotals};
use auv_planning::timed::schedule_at_once;
use auv_planning::{PlanError, Planned, RouteProblem, Schedule, UnderWay};

/// A trajectory leads to a waypoint if it passes no farther from it than this, metres.
const SAME_PLACE_M: f64 = 1e-6;

/// A question for a route.
pub(crate) fn ask(view: View<'_>, reason: RouteReason, from: RouteFrom) -> RouteQuestion {
    let (mission, state) = (view.mission, view.state);
    let nodes = state.route.nodes();
    let mut removed = state.ledger.removed.clone();
    let (mut waypoint, mut departs_s, mut rest) = (view.at(), view.now_s(), nodes);
    match (&from, view.leg()) {
        (RouteFrom::Target, Some(leg)) => {
            waypoint = leg.to;
            departs_s = view.ends_s().max(departs_s);
            rest = nodes.get(1..).unwrap_or_default();
            for edge in leg
                .duty
                .edge()
                .into_iter()
                .flat_map(|e| mission.done_with(e))
            {
                removed.insert(edge);
            }
        }
        (RouteFrom::Vehicle(..), _) => rest = &[],
        (RouteFrom::Target | RouteFrom::Waypoint, _) => {}
    }
    let mut forecast = FieldForecast::new(mission, view.settings, &view.beliefs().regions);
    let (network, start) = match &from {
        RouteFrom::Vehicle(dropped, place) => {
            if let Some((target, arrives_s)) = dropped.known_arrival {
                forecast =
                    forecast.with_known_path(mission.position_of(target), arrives_s - departs_s);
            }
            route_from_vehicle::network(mission, *place, &dropped.anchors, waypoint)
        }
        RouteFrom::Waypoint | RouteFrom::Target => {
            (std::sync::Arc::clone(&mission.network), waypoint)
        }
    };
    let times_s = arc_times_s(view, &network, (start, departs_s), &forecast);
    let ahead_s = departs_s - view.now_s();
    let time_available_s =
        mission.plannable_s(view.available_s()) - answered_in_s(view, &from) - ahead_s;
    let doing = doing(view, &from);
    let is_first = state.ledger.route_calls.is_empty();
    let planning = &view.settings.planning;
    RouteQuestion {
        id: state.next_question,
        reason,
        from,
        waypoint,
        removed,
        times_s,
        departs_s,
        time_available_s,
        incumbent: (rest.len() > 1).then(|| Route::new(rest.to_vec())),
        budget: if is_first {
            planning.launch_budget
        } else {
            planning.route_budget
        },
        open: due::open(view, departs_s, start, &doing),
    }
}

/// The tasks with windows and order that are done before a route begins.
fn doing(view: View<'_>, from: &RouteFrom) -> Vec<usize> {
    match (from, view.leg()) {
        (RouteFrom::Target, Some(leg)) => due::due_of(view, leg),
        _ => Vec::new(),
    }
}

/// Times of all arcs of a network for a route that starts somewhere at a time.
fn arc_times_s(
    view: View<'_>,
    network: &Network,
    (start, departs_s): (NodeId, f64),
    forecast: &FieldForecast<'_>,
) -> Vec<f64> {
    let (mission, settings) = (view.mission, view.settings);
    let Some(tide) = view.tide else {
        let start = (start, forecast);
        return times::arc_times_s(mission, settings, network, departs_s, start);
    };
    let delay_s = |ends, travel_s| forecast.delay_s(ends, departs_s, travel_s);
    tide.arc_times_s(mission, network, (start, departs_s), delay_s)
}

/// The start of a route at the vehicle's own place, when a leg is given up.
pub(crate) fn from_vehicle(view: View<'_>, leg: &Leg) -> RouteFrom {
    let dropped = DroppedLeg {
        anchors: anchors(view, Some(leg)),
        known_arrival: leg.mode.arrives_s().map(|arrives_s| (leg.to, arrives_s)),
    };
    RouteFrom::Vehicle(dropped, view.beliefs().position)
}

/// The same start where the vehicle is now. The arrival known of the leg given up counts only while the
/// trajectory in force still leads there.
pub(crate) fn from_here_again(view: View<'_>, from: RouteFrom) -> RouteFrom {
    let RouteFrom::Vehicle(dropped, _) = from else {
        return from;
    };
    let leads_there = |(target, arrives_s): &(NodeId, f64)| {
        let target = view.mission.position_of(*target);
        view.in_force()
            .is_some_and(|way| (way.at(*arrives_s).0 - target).norm() < SAME_PLACE_M)
    };
    let dropped = DroppedLeg {
        known_arrival: dropped.known_arrival.filter(leads_there),
        ..dropped
    };
    RouteFrom::Vehicle(dropped, view.beliefs().position)
}

/// Waypoints that a route from the vehicle's own place may lead to first: the ends of the leg, or any
/// in open water. A target that was waited for in vain is left out.
pub(crate) fn anchors(view: View<'_>, leg: Option<&Leg>) -> Vec<NodeId> {
    let network = &view.mission.network;
    let given_up = leg
        .filter(|leg| leg.mode.waits() || view.is_over_shoal(leg.to))
        .map(|leg| leg.to)
        .filter(|&to| !view.mission.is_dock(to));
    let mut nodes: Vec<NodeId> = if view.mission.open_water {
        (0..network.num_nodes() as u32).map(NodeId).collect()
    } else {
        let ends = leg.iter().flat_map(|leg| [leg.from, leg.to]);
        ends.chain([view.at()]).collect()
    };
    nodes.retain(|&node| network.has_node(node) && Some(node) != given_up);
    nodes.sort_unstable();
    nodes.dedup();
    if nodes.is_empty() {
        nodes.extend(given_up);
    }
    nodes
}

/// Time that passes until a route is answered while the vehicle waits for it, seconds.
fn answered_in_s(view: View<'_>, from: &RouteFrom) -> f64 {
    match from {
        RouteFrom::Waypoint | RouteFrom::Vehicle(..) => view.settings.planning.planning_s,
        RouteFrom::Target => 0.0,
    }
}

/// An answer, judged.
#[derive(Clone, Debug)]
pub(crate) struct JudgedRoute {
    pub(crate) question: RouteQuestion,
    /// The request that was asked, with the time that the answer has.
    pub(crate) asked: RouteRequest,
    /// The row of the route table so far.
    pub(crate) row: RouteCall,
    /// The planner's route if it is valid and better than the one in force, else the one in force if
    /// that is still valid.
    pub(crate) chosen: Option<Vec<NodeId>>,
    /// What it does of the tasks with windows and order.
    pub(crate) due: Vec<usize>,
    /// The planner failed, or called a route feasible that is not valid.
    pub(crate) failed: bool,
}

/// Judges an answer against the question that was asked.
pub(crate) fn judge(
    view: View<'_>,
    question: RouteQuestion,
    result: Result<Planned<Route>, PlanError>,
    compute_s: f64,
) -> JudgedRoute {
    let mut asked = question.request(view.mission, view.tide, view.seed);
    asked.time_available_s += answered_in_s(view, &question.from);
    let mut row = row(view, &asked, question.reason, compute_s);
    let failed = match &result {
        Err(PlanError::Unreachable { .. }) => false,
        Err(_) => true,
        Ok(planned) => planned.violation <= 0.0,
    };
    let planned = result.ok();
    if let Some(planned) = &planned {
        row.cost = planned.cost;
        row.evaluations = planned.stats.evaluations;
        row.valid = check::route_is_valid(&asked.problem(), planned);
    }
    let (chosen, due) = if view.mission.time_model.is_some() {
        choose_in_time(view, &question, &asked, planned, &mut row)
    } else {
        let chosen = choose(view.acceptor, &asked, planned.map(|p| p.best), &mut row);
        (chosen, Vec::new())
    };
    JudgedRoute {
        question,
        asked,
        row,
        chosen: chosen.map(|route| route.nodes().to_vec()),
        due,
        failed,
    }
}

/// A row of the route table, before there is an answer.
pub(crate) fn row(
    view: View<'_>,
    asked: &RouteRequest,
    reason: RouteReason,
    compute_s: f64,
) -> RouteCall {
    let ledger = &view.state.ledger;
    RouteCall {
        call: ledger.route_calls.len() + 1,
        reason,
        at_s: view.now_s(),
        start: asked.start,
        destination: asked.destination,
        tasks: 0,
        route_weight: 0.0,
        mission_weight: ledger.weight,
        cost: f64::MAX,
        available_s: view.available_s(),
        route_s: 0.0,
        valid: false,
        adopted: false,
        evaluations: 0,
        compute_s,
        route: Vec::new(),
    }
}

/// Fills in what an adopted route adds up to. A way home counts no tasks' weight. The time of the route is
/// that of its arcs, with the turns from leg to leg, begun `from` where and as the vehicle is under way.
pub(crate) fn complete_row(
    view: View<'_>,
    row: &mut RouteCall,
    asked: &RouteRequest,
    nodes: &[NodeId],
    (is_homeward, from): (bool, Option<UnderWay>),
    due: &[usize],
) {
    if let Some(totals) = totals_of(asked, nodes) {
        let planned_weight = if is_homeward { 0.0 } else { totals.weight };
        row.tasks = tasks_on(asked, nodes);
        row.route_weight = planned_weight;
        row.mission_weight += planned_weight;
        let (mission, settings) = (view.mission, view.settings);
        row.route_s =
            totals.time_s + times::turns_between_s(mission, settings, &asked.network, nodes, from);
    }
    if let Some(model) = view.mission.time_model.as_ref().filter(|_| !is_homeward) {
        let weight: f64 = due.iter().map(|&i| model.tasks[i].task.weight()).sum();
        row.tasks = due.len();
        row.route_weight += weight;
        row.mission_weight += weight;
        row.route_s += work_s(view, due);
    }
    row.destination = nodes.last().copied().unwrap_or(row.destination);
    row.route = nodes.to_vec();
}

fn choose(
    acceptor: Acceptor,
    asked: &RouteRequest,
    planned: Option<Route>,
    row: &mut RouteCall,
) -> Option<Route> {
    if acceptor.takes_unverified() && planned.is_some() {
        row.adopted = true;
        return planned;
    }
    let problem = asked.problem();
    let score = |route: &Route| {
        let totals = check::route_totals(&problem, route)?;
        let cost = problem.objective.cost(&totals, asked.time_available_s);
        Some((cost, totals.time_s))
    };
    let new = planned
        .filter(|_| row.valid)
        .and_then(|route| score(&route).map(|score| (score, route)));
    let old = asked
        .incumbent
        .clone()
        .and_then(|route| score(&route).map(|score| (score, route)));
    match (new, old) {
        (Some(((new_cost, new_s), new)), Some(((old_cost, old_s), old))) => {
            let order = new_cost.total_cmp(&old_cost).then(new_s.total_cmp(&old_s));
            row.adopted = order.is_lt();
            Some(if row.adopted { new } else { old })
        }
        (Some((_, new)), None) => {
            row.adopted = true;
            Some(new)
        }
        (None, old) => old.map(|(_, route)| route),
    }
}

/// A route in time, what it does of the open tasks, and when it ends.
type Timed = (Route, Vec<usize>, f64);

/// The planner's route in time if it is valid, else the one in force if it still is; where both are, the one of
/// more weight, of equal ones the quicker. With it what it does of the tasks with windows and order. A delay may
/// leave the route in force too late for work in its order: it stays without that work, or does the work at a
/// waypoint in the order in which windows close.
fn choose_in_time(
    view: View<'_>,
    question: &RouteQuestion,
    asked: &RouteRequest,
    planned: Option<Planned<Route>>,
    row: &mut RouteCall,
) -> (Option<Route>, Vec<usize>) {
    let weight = |due: &[usize]| {
        let model = asked.time_model.as_ref();
        // In the order of the model: equal work weighs the same in any order of the route.
        let mut due = due.to_vec();
        due.sort_unstable();
        let weight = |i: usize| model.map_or(0.0, |model| model.tasks[i].task.weight());
        due.into_iter().map(weight).sum::<f64>()
    };
    let new = planned.filter(|_| row.valid).and_then(|planned| {
        let Schedule { done, end_s, .. } = planned.schedule?;
        let due: Vec<usize> = done.iter().map(|done| done.task).collect();
        Some((planned.best, due, end_s))
    });
    let is_better = |(_, new, new_s): &Timed, (_, old, old_s): &Timed| {
        let order = weight(new).total_cmp(&weight(old));
        order.then(old_s.total_cmp(new_s)).is_gt()
    };
    let position = |task: &usize| question.open.iter().position(|open| open == task);
    let due: Vec<usize> = view.state.due.iter().filter_map(position).collect();
    let by_deadline = agenda::by_deadline(asked, &due);
    let old = [due, by_deadline]
        .into_iter()
        .filter_map(|due| left_of_route(asked, &due))
        .reduce(|old, other| if is_better(&other, &old) { other } else { old });
    let (route, due) = match (new, old) {
        (Some(new), Some(old)) if !is_better(&new, &old) => (Some(old.0), old.1),
        (Some(new), _) => {
            row.adopted = true;
            (Some(new.0), new.1)
        }
        (None, Some(old)) => (Some(old.0), old.1),
        (None, None) => (None, Vec::new()),
    };
    let of_mission = |i: usize| question.open.get(i).copied();
    (route, due.into_iter().filter_map(of_mission).collect())
}

/// The route in force with what it still does of these tasks, in order; `None` if it is not valid.
fn left_of_route(asked: &RouteRequest, due: &[usize]) -> Option<Timed> {
    let route = asked.incumbent.clone()?;
    let times = agenda::schedule(asked, &route, due)?;
    let holds = check::route_keeps_times(&asked.problem(), &route, &times);
    let done = times.done.iter().map(|done| done.task).collect();
    holds.then_some((route, done, times.end_s))
}

/// How long tasks with windows and order take without waiting for their windows, seconds.
fn work_s(view: View<'_>, due: &[usize]) -> f64 {
    let model = view.mission.time_model.as_ref();
    let of = |model: &auv_graph::TimeModel| {
        let times_s = due.iter().map(|&i| model.tasks[i].task.completion_time_s);
        times_s.sum::<f64>()
    };
    model.map_or(0.0, |model| of(model))
}

/// The quickest way home over any edges, passed ones too, leaving tasks undone.
pub(crate) fn quickest_home(view: View<'_>, asked: &RouteRequest) -> Option<Vec<NodeId>> {
    let mission = view.mission;
    if mission.open_water {
        let here = asked.network.waypoints()[asked.start.index()].position;
        let away_m = |dock: &NodeId| (mission.position_of(*dock) - here).norm();
        let docks = mission.all_docks();
        let nearest = docks.min_by(|a, b| away_m(a).total_cmp(&away_m(b)))?;
        return Some(vec![asked.start, nearest]);
    }
    let nothing = EdgeSet::empty();
    let network = &asked.network;
    let forecast_s = times::travel_times_s(mission, network, view.now_s()).collect();
    let still_s = |arc: &NetworkArc| arc.distance_m / mission.vehicle.speed_mps;
    let still_s: Vec<f64> = network.arcs().iter().map(still_s).collect();
    if let Some(tide) = view.tide {
        let home = tide.way_home(mission, network, asked.start, view.now_s());
        if home.is_some() {
            return home;
        }
    }
    // Where the forecast current lets no way through, the shortest is tried nevertheless.
    [forecast_s, still_s].iter().find_map(|times_s: &Vec<f64>| {
        let homes = mission.all_docks().filter_map(|dock| {
            let home = network.quickest_to(dock, &nothing, Some(times_s));
            Some((home.time_from_s(asked.start), home.route_from(asked.start)?))
        });
        let (_, route) = homes.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(route.nodes().to_vec())
    })
}

fn totals_of(asked: &RouteRequest, nodes: &[NodeId]) -> Option<RouteTotals> {
    let nothing = EdgeSet::empty();
    let route = Route::new(nodes.to_vec());
    let times_s = asked.times.as_deref();
    let totals = asked.network.evaluate(&route, &nothing, times_s).ok()?;
    let problem = RouteProblem {
        removed: &nothing,
        ..asked.problem()
    };
    let time_s = match problem.time_model {
        Some(model) => schedule_at_once(&problem, model, &route).end_s,
        None => totals.time_s,
    };
    Some(RouteTotals { time_s, ..totals })
}

/// Tasks that a route passes, each once. A transit is not a task.
fn tasks_on(asked: &RouteRequest, nodes: &[NodeId]) -> usize {
    let network = &asked.network;
    let mut passed = EdgeSet::empty();
    let arcs = nodes
        .windows(2)
        .filter_map(|leg| network.arc_between(leg[0], leg[1]));
    let edges = arcs.map(|arc| network.arcs()[arc.index()].edge);
    edges
        .filter(|&edge| network.task(edge).weight() > 0.0 && passed.insert(edge))
        .count()
}

#[cfg(test)]
mod tests;
