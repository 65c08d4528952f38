//! Checks that the parts of a saved state fit each other and the mission.

use crate::Mission;
use crate::ledger::Ledger;
use crate::mode::{Leg, LegMode, Mode, NextRoute};
use crate::question::{PathQuestion, RouteFrom, RouteQuestion};
use crate::state::State;
use auv_graph::{EdgeId, NodeId};
use auv_obstacles::TimedPoint;
use auv_types::Violations;

/// Times, coordinates and speeds beyond this are refused, SI units. The clock may show up to 1e9 s; what is planned lies
/// in its future.
const LARGEST: f64 = 1e10;

/// Everything that keeps a state from being a state of this mission.
pub(crate) fn check(mission: &Mission, state: &State) -> Violations {
    let mut wrong = Violations::new();
    check_beliefs(state, &mut wrong);
    check_ledger(mission, state, &mut wrong);
    check_route(mission, state, &mut wrong);
    let mut points = state.in_force.iter().flat_map(|way| way.whole.points());
    let possible = |p: &TimedPoint| p.position.iter().chain([&p.time_s]).all(is_plausible);
    wrong.require(points.all(possible), "in_force", || {
        "has a place or a time out of range".into()
    });
    match &state.mode {
        Mode::Ready => wrong.require(state.next_question == 0, "mode", || {
            "is before the start of a mission that has started".into()
        }),
        Mode::AwaitRoute(question) => check_route_question(mission, state, question, &mut wrong),
        Mode::Leg(leg) => check_leg(mission, state, leg, &mut wrong),
        Mode::Contingency(_) | Mode::Finished { .. } => {}
    }
    wrong
}

fn is_plausible(value: &f64) -> bool {
    value.abs() <= LARGEST
}

fn check_beliefs(state: &State, wrong: &mut Violations) {
    let beliefs = &state.beliefs;
    let times = [
        beliefs.now_s,
        beliefs.fixed_s,
        beliefs.sigma_m,
        beliefs.under_s,
        beliefs.fix_s,
    ];
    let moving = beliefs.position.iter().chain(beliefs.velocity.iter());
    wrong.require(
        times.iter().chain(moving).all(is_plausible),
        "beliefs",
        || "have a time, a place or a velocity out of range".into(),
    );
    wrong.require(beliefs.fixed_s <= beliefs.now_s, "beliefs.fixed_s", || {
        "is after the last tick".into()
    });
    let soundings = state.soundings.are_sound(is_plausible);
    wrong.require(soundings, "soundings", || {
        "are out of range, or more than there can be".into()
    });
    for (i, region) in beliefs.regions.iter().enumerate() {
        region.validate_into(&format!("beliefs.regions[{i}]"), wrong);
    }
}

fn check_ledger(mission: &Mission, state: &State, wrong: &mut Violations) {
    let ledger: &Ledger = &state.ledger;
    let is_node = |node: &NodeId| mission.network.has_node(*node);
    // The vehicle's own place counts as a waypoint where a leg starts there.
    let is_place = |node: &NodeId| node.index() <= mission.network.num_nodes();
    let numbers = [ledger.started_s, ledger.charged_s, ledger.weight];
    let positive = ledger.charged_s >= 0.0 && ledger.weight >= 0.0;
    let started = ledger.started_s <= state.beliefs.now_s;
    let plausible = numbers.iter().all(is_plausible);
    wrong.require(plausible && positive && started, "ledger", || {
        "has a time or a weight out of range".into()
    });
    // A battery gauge may report any number of joules.
    wrong.require(ledger.used_j.is_finite(), "ledger.used_j", || {
        "is not finite".into()
    });
    let raised = |(node, by_m): &(NodeId, f64)| is_node(node) && is_plausible(by_m);
    wrong.require(ledger.raised.iter().all(raised), "ledger.raised", || {
        "names an unknown waypoint or a height out of range".into()
    });
    let starts = ledger.visited.first() == Some(&mission.start);
    wrong.require(
        starts && ledger.visited.iter().all(is_node),
        "ledger.visited",
        || "does not lead from the start over known waypoints".into(),
    );
    let count = mission
        .time_model
        .as_ref()
        .map_or(0, |model| model.tasks.len());
    let mut numbers = ledger
        .done
        .iter()
        .map(|done| done.task)
        .chain(state.due.iter().copied());
    wrong.require(numbers.all(|task| task < count), "ledger.done", || {
        format!("names a task beyond the {count} there are")
    });
    let edges = mission.network.num_edges();
    let known = |edge: EdgeId| edge.index() < edges;
    wrong.require(ledger.removed.iter().all(known), "ledger.removed", || {
        format!("names an edge beyond the {edges} there are")
    });
    let completed = ledger.path_calls.iter().filter(|call| call.completed);
    let legs = completed.count();
    let in_time = mission.time_model.as_ref();
    let most = legs + in_time.map_or(0, |model| model.tasks.len());
    let fits = ledger.visited.len() == legs + 1 && ledger.tasks <= most;
    wrong.require(fits, "ledger.tasks", || {
        format!("does not fit the {legs} legs completed")
    });
    let mut rows = ledger.path_calls.iter();
    let mut routes = ledger.route_calls.iter();
    let known = rows.all(|row| is_place(&row.from) && is_node(&row.to))
        && routes.all(|row| is_place(&row.start) && row.route.iter().all(is_place));
    wrong.require(known, "ledger", || {
        "has tables with unknown waypoints".into()
    });
}

fn check_route(mission: &Mission, state: &State, wrong: &mut Violations) {
    let here = NodeId(mission.network.num_nodes() as u32);
    let nodes = state.route.nodes();
    let connected = nodes.windows(2).enumerate().all(|(i, pair)| {
        let from_here = i == 0 && pair[0] == here;
        let straight = state.route.is_homeward() || from_here;
        let known =
            mission.network.has_node(pair[1]) && (mission.network.has_node(pair[0]) || from_here);
        known && (straight || mission.network.arc_between(pair[0], pair[1]).is_some())
    });
    let over = matches!(state.mode, Mode::Finished { .. });
    let leads_home = nodes.len() >= 2 && nodes.last().is_some_and(|&end| mission.is_dock(end));
    let whole = nodes.is_empty() || over || leads_home;
    wrong.require(connected && whole, "route", || {
        "is not connected or does not lead to the destination".into()
    });
}

fn check_route_question(
    mission: &Mission,
    state: &State,
    question: &RouteQuestion,
    wrong: &mut Violations,
) {
    let network = &mission.network;
    wrong.require(question.id < state.next_question, "mode", || {
        format!("waits for question {}, which was never asked", question.id)
    });
    let mut places = network.num_nodes();
    let mut known = network.has_node(question.waypoint);
    if let RouteFrom::Vehicle(dropped, place) = &question.from {
        let mut nodes = dropped.anchors.iter().copied();
        places += 1;
        known &= nodes.all(|node| network.has_node(node));
        let arrival = dropped.known_arrival.iter();
        known &= arrival.clone().all(|(node, _)| network.has_node(*node));
        known &= place
            .iter()
            .chain(arrival.map(|(_, time_s)| time_s))
            .all(is_plausible);
    }
    let count = mission
        .time_model
        .as_ref()
        .map_or(0, |model| model.tasks.len());
    known &= question.open.iter().all(|&task| task < count) && is_plausible(&question.departs_s);
    let edges = network.num_edges();
    known &= question.removed.iter().all(|edge| edge.index() < edges);
    let mut incumbent = question.incumbent.iter().flat_map(|route| route.nodes());
    known &= incumbent.all(|node| node.index() < places);
    wrong.require(known, "mode", || {
        "asks for a route over unknown waypoints or edges".into()
    });
    if !known {
        return;
    }
    let arcs = question.network(mission).0.arcs().len();
    let times = &question.times_s;
    let positive = times.iter().all(|time_s| *time_s >= 0.0);
    let fits = positive && times.len() == arcs;
    let known = !question.time_available_s.is_nan() && is_plausible(&question.departs_s);
    wrong.require(fits && known, "mode", || {
        format!("asks for a route with times that do not fit the {arcs} arcs")
    });
}

fn check_path_question(state: &State, question: &PathQuestion, wrong: &mut Violations) {
    wrong.require(question.id < state.next_question, "leg", || {
        "waits for a path that was never asked for".into()
    });
    let numbers = [
        question.departure_s,
        question.clearance_m,
        question.min_altitude_m,
        question.altitude_sigmas,
    ];
    let velocity = question.start_velocity.iter().flat_map(|v| v.iter());
    let stand_off = question.stand_off.iter().flat_map(|p| p.iter());
    let places = question.start.iter().chain(question.target.iter());
    let mut all = numbers
        .iter()
        .chain(velocity)
        .chain(stand_off)
        .chain(places);
    let positive = numbers[1..].iter().all(|number| *number >= 0.0);
    wrong.require(positive && all.all(is_plausible), "leg", || {
        "asks for a path with numbers out of range".into()
    });
    for (i, region) in question.regions.iter().enumerate() {
        region.validate_into(&format!("leg.regions[{i}]"), wrong);
    }
}

fn check_leg(mission: &Mission, state: &State, leg: &Leg, wrong: &mut Violations) {
    check_times(mission, state, leg, wrong);
    check_work(mission, leg, wrong);
    let nodes = state.route.nodes();
    let on_route = nodes.len() >= 2 && nodes[..2] == [leg.from, leg.to];
    let edge = edge_of(mission, leg);
    wrong.require(on_route && edge == leg.duty.edge(), "leg", || {
        "is not the first of the route".into()
    });
    if let Some(question) = leg.awaited.question() {
        check_path_question(state, question, wrong);
    }
    if let NextRoute::Asked(question) = &leg.next_route {
        check_route_question(mission, state, question, wrong);
    }
    let asks = leg.awaited.question().is_some();
    let flies = state.in_force.is_some() && leg.mode != LegMode::AwaitFirstPath;
    wrong.require(asks || flies, "leg", || {
        "has no trajectory and waits for none".into()
    });
}

fn edge_of(mission: &Mission, leg: &Leg) -> Option<EdgeId> {
    let arc = mission.network.arc_between(leg.from, leg.to)?;
    Some(mission.network.arcs()[arc.index()].edge)
}

fn check_times(mission: &Mission, state: &State, leg: &Leg, wrong: &mut Violations) {
    let astray = leg.astray.iter();
    let astray: Vec<f64> = astray.flat_map(|a| [a.since_s, a.away_m]).collect();
    wrong.require(astray.iter().all(is_plausible), "leg.astray", || {
        "has numbers out of range".into()
    });
    let past = [
        leg.started_s,
        leg.booked_s,
        leg.asked_s,
        leg.fix_asked_s,
        leg.missed_s,
    ];
    let others = [
        leg.charged_s,
        leg.task_left_s,
        leg.waited_s,
        leg.mode.arrives_s().unwrap_or(0.0),
    ];
    wrong.require(past.iter().chain(&others).all(is_plausible), "leg", || {
        "has times out of range".into()
    });
    let now_s = state.beliefs.now_s;
    wrong.require(past.iter().all(|&time_s| time_s <= now_s), "leg", || {
        "has times after the last tick".into()
    });
    // Nobody waits longer than the mission lasts: the wait is planned as a trajectory.
    let waits = leg.departs_s <= now_s.max(leg.started_s) + mission.budget_s;
    wrong.require(waits && is_plausible(&leg.departs_s), "leg", || {
        "departs after the end of the mission".into()
    });
}

fn check_work(mission: &Mission, leg: &Leg, wrong: &mut Violations) {
    let edge = edge_of(mission, leg);
    let task_s = edge.map_or(0.0, |edge| mission.network.task(edge).completion_time_s);
    // A window may be waited for.
    let task_s = mission.time_model.as_ref().map_or(task_s, |_| LARGEST);
    wrong.require((0.0..=task_s).contains(&leg.task_left_s), "leg", || {
        format!("has {} s left of a task of {task_s} s", leg.task_left_s)
    });
    let count = mission
        .time_model
        .as_ref()
        .map_or(0, |model| model.tasks.len());
    wrong.require(
        leg.works.iter().all(|done| done.task < count),
        "leg",
        || format!("does a task beyond the {count} there are"),
    );
}

#[cfg(test)]
mod tests;
