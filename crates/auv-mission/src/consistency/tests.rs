//! Each refusal of a saved state.

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
    refused("beliefs", |f| f.state.beliefs.position.y = 1.1e10);
    refused("beliefs", |f| f.state.beliefs.velocity.z = f64::INFINITY);
    let shoal = auv_ocean::Shoal {
        north_m: 0.0,
        east_m: f64::NAN,
        raised_m: 1.0,
        reach_m: 1.0,
    };
    refused("soundings", |f| f.state.soundings.shoals.push(shoal));
    let known = auv_ocean::Shoal {
        east_m: 0.0,
        ..shoal
    };
    refused("soundings", |f| f.state.soundings.shoals = vec![known; 65]);
    refused("beliefs.fixed_s", |f| f.state.beliefs.fixed_s = 0.1);
    refused("beliefs.regions[0]", |f| {
        f.state.beliefs.regions = [Region::ball(place(0.0), -1.0)].into();
    });
    refused("in_force", |f| {
        f.state.in_force = Some(way(&[(0.0, 0.0), (1.1e10, 9.0)]).into());
    });
}

#[test]
fn a_ledger_that_does_not_add_up_is_refused() {
    refused("ledger", |f| f.state.ledger.charged_s = -1.0);
    refused("ledger", |f| f.state.ledger.weight = -1.0);
    refused("ledger", |f| f.state.ledger.weight = 1.1e10);
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
            let asked = question.request(view.mission, view.tide, view.seed);
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
    wrong(|question| question.target.x = 1.1e10);
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
    wrong(|leg| leg.mode = LegMode::ToStandOff { arrives_s: 1.1e10 });
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
