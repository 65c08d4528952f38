//! Checks that the parts of a saved state fit each other and the mission.

use crate::Mission;
use crate::ledger::Ledger;
use crate::mode::{Leg, LegMode, Mode, NextRoute};
use crate::question::{PathQuestion, RouteFrom, RouteQuestion};
use crate::state::State;
use auv_graph::{EdgeId, NodeId};
use auv_obstacles::TimedPoint;
use auv_types::Violations;

/// Times, coordinates and speeds beyond this are refused, SI units.
const LARGEST: f64 = 1e9;

/// Everything that keeps a state from being a state of this mission.
pub(crate) fn check(mission: &Mission, state: &State) -> Violations {
    let mut wrong = Violations::new();
    check_beliefs(state, &mut wrong);
    check_ledger(mission, state, &mut wrong);
    check_route(mission, state, &mut wrong);
    let mut points = state.in_force.iter().flat_map(|way| way.points());
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
    let times = [beliefs.now_s, beliefs.fixed_s];
    let moving = beliefs.position.iter().chain(beliefs.velocity.iter());
    wrong.require(
        times.iter().chain(moving).all(is_plausible),
        "beliefs",
        || "have a time, a place or a velocity out of range".into(),
    );
    wrong.require(beliefs.fixed_s <= beliefs.now_s, "beliefs.fixed_s", || {
        "is after the last tick".into()
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
    let starts = ledger.visited.first() == Some(&mission.start);
    wrong.require(
        starts && ledger.visited.iter().all(is_node),
        "ledger.visited",
        || "does not lead from the start over known waypoints".into(),
    );
    let edges = mission.network.num_edges();
    let known = |edge: EdgeId| edge.index() < edges;
    wrong.require(ledger.removed.iter().all(known), "ledger.removed", || {
        format!("names an edge beyond the {edges} there are")
    });
    let completed = ledger.path_calls.iter().filter(|call| call.completed);
    let legs = completed.count();
    let fits = ledger.visited.len() == legs + 1 && ledger.tasks <= legs;
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
    let leads_home = nodes.len() >= 2 && nodes.last() == Some(&mission.destination);
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
    let (mut arcs, mut places) = (network.arcs().len(), network.num_nodes());
    let mut known = network.has_node(question.waypoint);
    if let RouteFrom::Vehicle(dropped, place) = &question.from {
        let mut nodes = dropped.anchors.iter().copied();
        arcs += dropped.anchors.len();
        places += 1;
        known &= nodes.all(|node| network.has_node(node));
        let arrival = dropped.known_arrival.iter();
        known &= arrival.clone().all(|(node, _)| network.has_node(*node));
        known &= place
            .iter()
            .chain(arrival.map(|(_, time_s)| time_s))
            .all(is_plausible);
    }
    let edges = network.num_edges();
    known &= question.removed.iter().all(|edge| edge.index() < edges);
    let mut incumbent = question.incumbent.iter().flat_map(|route| route.nodes());
    known &= incumbent.all(|node| node.index() < places);
    wrong.require(known, "mode", || {
        "asks for a route over unknown waypoints or edges".into()
    });
    let times = &question.times_s;
    let positive = times.iter().all(|time_s| *time_s >= 0.0);
    let fits = positive && (times.is_empty() || times.len() == arcs);
    wrong.require(
        fits && question.time_available_s.is_finite(),
        "mode",
        || format!("asks for a route with times that do not fit the {arcs} arcs"),
    );
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
    let past = [leg.started_s, leg.booked_s, leg.asked_s];
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
    let arc = mission.network.arc_between(leg.from, leg.to);
    let edge = arc.map(|arc| mission.network.arcs()[arc.index()].edge);
    let task_s = edge.map_or(0.0, |edge| mission.network.task(edge).completion_time_s);
    wrong.require((0.0..=task_s).contains(&leg.task_left_s), "leg", || {
        format!("has {} s left of a task of {task_s} s", leg.task_left_s)
    });
    let nodes = state.route.nodes();
    let on_route = nodes.len() >= 2 && nodes[..2] == [leg.from, leg.to];
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RouteReason;
    use crate::fixture::{Fixture, path_row, place, way};
    use crate::mode::{Awaited, Duty};
    use crate::route_question::{self, row};
    use crate::state::RouteInForce;
    use crate::{path_question, question::DroppedLeg};
    use auv_graph::Route;
    use auv_obstacles::Region;

    /// What is found wrong with a state after a change.
    fn found(change: impl FnOnce(&mut Fixture)) -> String {
        let mut fixture = Fixture::new();
        change(&mut fixture);
        check(&fixture.mission, &fixture.state).to_string()
    }

    fn refused(place: &str, change: impl FnOnce(&mut Fixture)) {
        let wrong = found(change);
        assert!(wrong.contains(place), "{place}: {wrong:?}");
    }

    #[test]
    fn a_state_as_it_is_saved_passes() {
        assert_eq!(found(|_| {}), "");
        assert_eq!(found(ask_path), "");
        assert_eq!(found(|fixture| ask_route(fixture, |_| {})), "");
    }

    #[test]
    fn beliefs_out_of_range_are_refused() {
        refused("beliefs", |f| f.state.beliefs.now_s = f64::NAN);
        refused("beliefs", |f| f.state.beliefs.position.y = 1.1e9);
        refused("beliefs", |f| f.state.beliefs.velocity.z = f64::INFINITY);
        refused("beliefs.fixed_s", |f| f.state.beliefs.fixed_s = 0.1);
        refused("beliefs.regions[0]", |f| {
            f.state.beliefs.regions = [Region::ball(place(0.0), -1.0)].into();
        });
        refused("in_force", |f| {
            f.state.in_force = Some(way(&[(0.0, 0.0), (1.1e9, 9.0)]));
        });
    }

    #[test]
    fn a_ledger_that_does_not_add_up_is_refused() {
        refused("ledger", |f| f.state.ledger.charged_s = -1.0);
        refused("ledger", |f| f.state.ledger.weight = -1.0);
        refused("ledger", |f| f.state.ledger.weight = 1.1e9);
        refused("ledger", |f| f.state.ledger.started_s = 0.1);
        refused("ledger.used_j", |f| f.state.ledger.used_j = f64::NAN);
        assert_eq!(found(|f| f.state.ledger.used_j = -1e300), "");
        refused("ledger.visited", |f| {
            f.state.ledger.visited = vec![NodeId(1)]
        });
        refused("ledger.visited", |f| f.state.ledger.visited.push(NodeId(3)));
        refused("ledger.removed", |f| {
            f.state.ledger.removed.insert(EdgeId(3));
        });
        refused("ledger.tasks", |f| f.state.ledger.tasks = 1);
        refused("ledger.tasks", |f| f.state.ledger.visited.push(NodeId(1)));
        refused("ledger.tasks", |f| {
            f.state.ledger.path_calls = vec![path_row(true, 0.0, 1.0)];
        });
        let row_from = |from, to| {
            move |fixture: &mut Fixture| {
                let mut row = path_row(false, 0.0, 1.0);
                (row.from, row.to) = (NodeId(from), NodeId(to));
                fixture.state.ledger.path_calls = vec![row];
            }
        };
        // The vehicle's own place is one past the waypoints; no leg ends there.
        assert_eq!(found(row_from(3, 0)), "");
        refused("unknown waypoints", row_from(4, 0));
        refused("unknown waypoints", row_from(0, 3));
        refused("unknown waypoints", |fixture| {
            let mut row = fixture.view(|view| {
                let from = RouteFrom::Waypoint;
                let question = route_question::ask(view, RouteReason::Start, from);
                let asked = question.request(view.mission, view.seed);
                row(view, &asked, RouteReason::Start, 0.0)
            });
            row.route = vec![NodeId(4)];
            fixture.state.ledger.route_calls = vec![row];
        });
    }

    #[test]
    fn a_route_that_does_not_lead_to_the_destination_is_refused() {
        let planned = |nodes: &[u32]| {
            let nodes: Vec<_> = nodes.iter().map(|&node| NodeId(node)).collect();
            move |fixture: &mut Fixture| fixture.state.route = RouteInForce::Planned(nodes)
        };
        refused("route is not connected", planned(&[0, 1]));
        refused("route is not connected", planned(&[0, 1, 4, 2]));
        refused("route is not connected", planned(&[0, 3, 2]));
        refused("route is not connected", planned(&[0, 0, 2]));
        // From the vehicle's own place, and home, any waypoint is led to.
        assert!(!found(planned(&[3, 1, 2])).contains("route is not connected"));
        assert!(
            !found(|fixture| {
                fixture.state.route = RouteInForce::QuickestHome(vec![NodeId(0), NodeId(2)]);
            })
            .contains("route is not connected")
        );
    }

    /// On a leg, waiting for a path.
    fn ask_path(fixture: &mut Fixture) {
        let question = fixture.ask(|view, leg| path_question::ask(view, leg, None));
        fixture.leg_mut().awaited = Awaited::Path(question);
        fixture.state.next_question = 3;
    }

    /// Waiting for a route from the vehicle's own place.
    fn ask_route(fixture: &mut Fixture, change: impl FnOnce(&mut RouteQuestion)) {
        fixture.settings.planning.planning_s = 1.0;
        let mut question = fixture.ask(|view, leg| {
            let from = route_question::from_vehicle(view, leg);
            route_question::ask(view, RouteReason::LegDropped, from)
        });
        change(&mut question);
        fixture.state.mode = Mode::AwaitRoute(Box::new(question));
        fixture.state.next_question = 3;
    }

    #[test]
    fn a_route_question_that_cannot_have_been_asked_is_refused() {
        fn wrong(change: impl FnOnce(&mut RouteQuestion)) {
            refused("mode", |fixture| ask_route(fixture, change));
        }
        fn dropped(question: &mut RouteQuestion) -> (&mut DroppedLeg, &mut f64) {
            match &mut question.from {
                RouteFrom::Vehicle(dropped, place) => (dropped, &mut place.x),
                from => panic!("{from:?}"),
            }
        }
        wrong(|question| question.id = 3);
        wrong(|question| question.waypoint = NodeId(3));
        wrong(|question| dropped(question).0.anchors[0] = NodeId(3));
        wrong(|question| dropped(question).0.known_arrival = Some((NodeId(3), 0.0)));
        wrong(|question| dropped(question).0.known_arrival = Some((NodeId(1), f64::NAN)));
        wrong(|question| *dropped(question).1 = f64::NAN);
        wrong(|question| {
            question.removed.insert(EdgeId(3));
        });
        wrong(|question| question.incumbent = Some(Route::new(vec![NodeId(4)])));
        wrong(|question| question.times_s[0] = -1.0);
        wrong(|question| {
            question.times_s.pop();
        });
        wrong(|question| question.time_available_s = f64::NAN);
        refused("mode", |fixture| fixture.state.mode = Mode::Ready);
        refused("mode", |fixture| {
            let mut question = fixture
                .view(|view| route_question::ask(view, RouteReason::Projected, RouteFrom::Target));
            question.id = 9;
            fixture.leg_mut().next_route = NextRoute::Asked(Box::new(question));
        });
    }

    #[test]
    fn a_path_question_that_cannot_have_been_asked_is_refused() {
        fn wrong(change: impl FnOnce(&mut PathQuestion)) {
            refused("leg", |fixture| {
                ask_path(fixture);
                match &mut fixture.leg_mut().awaited {
                    Awaited::Path(question) => change(question),
                    awaited => panic!("{awaited:?}"),
                }
            });
        }
        wrong(|question| question.id = 3);
        wrong(|question| question.departure_s = f64::NAN);
        wrong(|question| question.clearance_m = -0.1);
        wrong(|question| question.min_altitude_m = -0.1);
        wrong(|question| question.altitude_sigmas = -0.1);
        wrong(|question| question.start.x = f64::NAN);
        wrong(|question| question.target.x = 1.1e9);
        wrong(|question| question.stand_off = Some(place(f64::NAN)));
        wrong(|question| question.start_velocity = Some(place(f64::NAN).coords));
        wrong(|question| question.regions = [Region::ball(place(0.0), -1.0)].into());
    }

    #[test]
    fn a_leg_that_does_not_fit_is_refused() {
        fn wrong(change: impl FnOnce(&mut Leg)) {
            refused("leg", |fixture| change(fixture.leg_mut()));
        }
        wrong(|leg| leg.started_s = 0.1);
        wrong(|leg| leg.booked_s = 0.1);
        wrong(|leg| leg.asked_s = 0.1);
        wrong(|leg| leg.started_s = f64::NEG_INFINITY);
        wrong(|leg| leg.charged_s = f64::NAN);
        wrong(|leg| leg.waited_s = f64::NAN);
        wrong(|leg| leg.mode = LegMode::ToStandOff { arrives_s: 1.1e9 });
        wrong(|leg| leg.task_left_s = 60.1);
        wrong(|leg| leg.task_left_s = -0.1);
        wrong(|leg| leg.to = NodeId(2));
        wrong(|leg| leg.duty = Duty::NoEdge);
        wrong(|leg| leg.duty = Duty::Pass(EdgeId(1)));
        wrong(|leg| leg.mode = LegMode::AwaitFirstPath);
        refused("leg has no trajectory", |fixture| {
            fixture.state.in_force = None
        });
        // Nothing is flown before the first path is answered.
        let first = |fixture: &mut Fixture| {
            ask_path(fixture);
            fixture.leg_mut().mode = LegMode::AwaitFirstPath;
            fixture.state.in_force = None;
        };
        assert_eq!(found(first), "");
    }
}
