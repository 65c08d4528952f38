//! Questions for routes, and which of two routes is chosen.

use super::*;
use crate::fixture::{Fixture, place};
use crate::mode::LegMode;
use crate::state::RouteInForce;
use auv_graph::EdgeId;
use auv_planning::Stats;

fn nodes(nodes: &[u32]) -> Vec<NodeId> {
    nodes.iter().map(|&node| NodeId(node)).collect()
}

/// Judges an answer to a question from waypoint 0, with a route in force.
fn judged(
    in_force: &[u32],
    answer: Result<(&[u32], f64), PlanError>,
    budget_s: f64,
) -> JudgedRoute {
    let mut fixture = Fixture::new();
    fixture.mission.budget_s = budget_s;
    fixture.state.route = RouteInForce::Planned(nodes(in_force));
    let result = answer.map(|(route, violation)| {
        let route = Route::new(nodes(route));
        Planned::new(route, -1.0, violation, Stats::default())
    });
    fixture.view(|view| {
        let question = ask(view, RouteReason::Waypoint, RouteFrom::Waypoint);
        judge(view, question, result, 2.0)
    })
}

/// What is chosen, whether the new route is adopted, whether it is valid, and whether the planner
/// failed.
fn verdict(judged: &JudgedRoute) -> (Option<Vec<NodeId>>, bool, bool, bool) {
    let row = &judged.row;
    (judged.chosen.clone(), row.adopted, row.valid, judged.failed)
}

#[test]
fn the_better_of_a_valid_route_and_the_one_in_force_is_chosen() {
    let (tasks, transit): (&[u32], &[u32]) = (&[0, 1, 2], &[0, 2]);
    let found = |in_force, answer| verdict(&judged(in_force, answer, 2_000.0));
    let better = found(transit, Ok((tasks, 0.0)));
    assert_eq!(better, (Some(nodes(tasks)), true, true, true));
    let worse = found(tasks, Ok((transit, 0.0)));
    assert_eq!(worse, (Some(nodes(tasks)), false, true, true));
    // The route in force stays unless the new one is better.
    let equal = found(tasks, Ok((tasks, 0.0)));
    assert_eq!(equal, (Some(nodes(tasks)), false, true, true));
    let alone = found(&[0], Ok((transit, 0.0)));
    assert_eq!(alone, (Some(nodes(transit)), true, true, true));
}

#[test]
fn of_two_routes_with_the_same_weight_the_quicker_one_is_better() {
    let mut fixture = Fixture::new();
    let mut edges = fixture.mission.network.edges().to_vec();
    let mut waypoints = fixture.mission.network.waypoints().to_vec();
    let mut corner = place(900.0);
    corner.y = 300.0;
    waypoints.push(auv_graph::Waypoint::at(corner));
    let task = edges[0].task;
    edges.extend([(0, 3), (3, 2)].map(|(a, b)| auv_graph::Edge::undirected(a, b, task)));
    let network = auv_graph::Network::new(&waypoints, &edges, 3.0).unwrap();
    fixture.mission.network = std::sync::Arc::new(network);
    for (in_force, new, adopted) in [([0, 3, 2], [0, 1, 2], true), ([0, 1, 2], [0, 3, 2], false)] {
        fixture.state.route = RouteInForce::Planned(nodes(&in_force));
        let planned = Planned::new(Route::new(nodes(&new)), -6.0, 0.0, Stats::default());
        let judged = fixture.view(|view| {
            let question = ask(view, RouteReason::Waypoint, RouteFrom::Waypoint);
            judge(view, question, Ok(planned), 0.0)
        });
        assert_eq!(judged.row.adopted, adopted, "{new:?}");
        assert_eq!(judged.chosen, Some(nodes(&[0, 1, 2])));
    }
}

#[test]
fn a_route_in_time_that_is_late_for_its_order_of_work_keeps_what_it_can_do() {
    // Waypoint 1 is reached after 360 s. In force: first a task of 100 s, then one whose window closes.
    for (closes_s, done) in [(470.0, &[1, 0][..]), (370.0, &[0, 1]), (250.0, &[1])] {
        let mut fixture = Fixture::with_timed_tasks();
        let mut model = (**fixture.mission.time_model.as_ref().unwrap()).clone();
        model.tasks.truncate(2);
        model.tasks[0].windows = vec![[0.0, closes_s]];
        model.tasks[1].after.clear();
        model.tasks[1].task.completion_time_s = 100.0;
        fixture.mission.time_model = Some(std::sync::Arc::new(model));
        fixture.state.route = RouteInForce::Planned(nodes(&[0, 1, 2]));
        fixture.state.due = vec![1, 0];
        let mut planned = Planned::new(Route::new(nodes(&[0, 2])), 0.0, 0.0, Stats::default());
        planned.schedule = Some(Schedule {
            departures_s: vec![0.0],
            end_s: 600.0,
            ..Schedule::default()
        });
        let judged = fixture.view(|view| {
            let question = ask(view, RouteReason::Late, RouteFrom::Waypoint);
            judge(view, question, Ok(planned), 0.0)
        });
        let found = (judged.row.valid, judged.chosen, &judged.due[..]);
        assert_eq!(found, (true, Some(nodes(&[0, 1, 2])), done), "{closes_s} s");
        assert!(!judged.row.adopted);
    }
}

#[test]
fn an_answer_is_judged_with_the_time_that_planning_was_given() {
    // 720 s for both tasks; 100 s are set aside for planning, and given back with the answer.
    for (budget_s, valid) in [(719.0, false), (721.0, true)] {
        let mut fixture = Fixture::new();
        fixture.mission.budget_s = budget_s;
        fixture.settings.planning.planning_s = 100.0;
        let route = Route::new(nodes(&[0, 1, 2]));
        let planned = Planned::new(route, -6.0, 0.0, Stats::default());
        let judged = fixture.view(|view| {
            let mut question = ask(view, RouteReason::Waypoint, RouteFrom::Waypoint);
            let arcs = view.mission.network.arcs().iter();
            question.times_s = arcs.map(|arc| arc.time_s).collect();
            judge(view, question, Ok(planned), 0.0)
        });
        assert_eq!(judged.row.valid, valid, "{budget_s} s");
    }
}

#[test]
fn an_invalid_route_is_never_chosen() {
    let (tasks, transit): (&[u32], &[u32]) = (&[0, 1, 2], &[0, 2]);
    // 720 s for both tasks, 600 s for the transit.
    for (in_force, chosen) in [(transit, Some(nodes(transit))), (&[0][..], None)] {
        let found = verdict(&judged(in_force, Ok((tasks, 0.0)), 700.0));
        assert_eq!(found, (chosen.clone(), false, false, true));
        let honest = verdict(&judged(in_force, Ok((tasks, 20.0)), 700.0));
        assert_eq!(honest, (chosen.clone(), false, false, false));
        let failed = PlanError::Failed {
            planner: "test".into(),
            reason: "on purpose".into(),
        };
        let failed = verdict(&judged(in_force, Err(failed), 700.0));
        assert_eq!(failed, (chosen, false, false, true));
    }
    // The one in force is checked again as well.
    assert_eq!(judged(tasks, Ok((tasks, 0.0)), 700.0).chosen, None);
}

#[test]
fn a_row_records_the_question_and_what_the_route_adds_up_to() {
    let judged = judged(&[0, 2], Ok((&[0, 1, 2], 0.0)), 2_000.0);
    let mut row = judged.row.clone();
    assert_eq!(
        (row.call, row.reason, row.start),
        (1, RouteReason::Waypoint, NodeId(0))
    );
    assert_eq!(
        (row.available_s, row.compute_s, row.cost),
        (2_000.0, 2.0, -1.0)
    );
    row.mission_weight = 10.0;
    let mut homeward = row.clone();
    let fixture = Fixture::new();
    fixture.view(|view| {
        complete_row(
            view,
            &mut row,
            &judged.asked,
            &nodes(&[0, 1, 2]),
            (false, None),
            &[],
        )
    });
    assert_eq!(
        (row.tasks, row.route_weight, row.mission_weight),
        (2, 6.0, 16.0)
    );
    assert_eq!((row.route_s, row.route), (720.0, nodes(&[0, 1, 2])));
    fixture.view(|view| {
        complete_row(
            view,
            &mut homeward,
            &judged.asked,
            &nodes(&[0, 2]),
            (true, None),
            &[],
        )
    });
    assert_eq!((homeward.tasks, homeward.route_weight), (0, 0.0));
    assert_eq!((homeward.mission_weight, homeward.route_s), (10.0, 600.0));
}

#[test]
fn the_anchors_of_a_leg_given_up_leave_out_a_target_waited_for_in_vain() {
    let anchors_of = |open_water, mode, to: u32| {
        let mut fixture = Fixture::new();
        fixture.mission.open_water = open_water;
        let leg = fixture.leg_mut();
        (leg.mode, leg.to) = (mode, NodeId(to));
        fixture.ask(|view, leg| anchors(view, Some(leg)))
    };
    let under_way = LegMode::Underway { arrives_s: 300.0 };
    assert_eq!(anchors_of(true, under_way, 1), nodes(&[0, 1, 2]));
    assert_eq!(anchors_of(true, LegMode::Evading, 1), nodes(&[0, 2]));
    assert_eq!(anchors_of(false, under_way, 1), nodes(&[0, 1]));
    assert_eq!(anchors_of(false, LegMode::Evading, 1), nodes(&[0]));
    // The destination stays, whatever covers it.
    assert_eq!(anchors_of(false, LegMode::Evading, 2), nodes(&[0, 2]));
}

#[test]
fn a_question_from_the_target_is_for_its_arrival_and_without_its_task() {
    let mut fixture = Fixture::new().on_track(100.0);
    fixture.mission.reserve_s = 50.0;
    fixture.settings.planning.planning_s = 7.0;
    let question = |from| fixture.view(|view| ask(view, RouteReason::Projected, from));
    let target = question(RouteFrom::Target);
    assert_eq!(target.waypoint, NodeId(1));
    assert_eq!(target.time_available_s, 2_000.0 - 360.0 - 50.0);
    let removed: Vec<EdgeId> = target.removed.iter().collect();
    assert_eq!(removed, [EdgeId(0)]);
    assert_eq!(target.incumbent.unwrap().nodes(), nodes(&[1, 2]));
    let waypoint = question(RouteFrom::Waypoint);
    assert_eq!(waypoint.waypoint, NodeId(0));
    assert_eq!(waypoint.time_available_s, 2_000.0 - 100.0 - 50.0 - 7.0);
    assert!(waypoint.removed.is_empty());
    assert_eq!(waypoint.incumbent.unwrap().nodes(), nodes(&[0, 1, 2]));
    let launch = fixture.settings.planning.launch_budget;
    assert_eq!(waypoint.budget, launch);
}

#[test]
fn a_question_from_the_vehicle_starts_at_its_place() {
    let fixture = Fixture::new().on_track(100.0);
    let from = fixture.ask(from_vehicle);
    let RouteFrom::Vehicle(dropped, at) = from.clone() else {
        panic!("{from:?}");
    };
    assert_eq!(
        (at, dropped.known_arrival),
        (place(300.0), Some((NodeId(1), 300.0)))
    );
    let question = fixture.view(|view| ask(view, RouteReason::LegDropped, from.clone()));
    let asked = fixture.view(|view| question.request(view.mission, view.tide, view.seed));
    assert_eq!((asked.start, asked.network.num_nodes()), (NodeId(3), 4));
    assert_eq!(asked.network.waypoints()[3].position, place(300.0));
    assert_eq!(question.incumbent, None);
    let later = Fixture::new().on_track(200.0);
    let again = later.view(|view| from_here_again(view, from));
    assert_eq!(again, RouteFrom::Vehicle(dropped, place(600.0)));
}

#[test]
fn the_quickest_way_home_is_straight_in_open_water_else_over_any_edge() {
    let home = |open_water, current_mps: f64| {
        let mut fixture = Fixture::new();
        fixture.mission.open_water = open_water;
        // The edge 0-2 leads a long way round; its guide says so.
        let mut edges = fixture.mission.network.edges().to_vec();
        edges[2].distance_m = Some(9_000.0);
        let waypoints = fixture.mission.network.waypoints().to_vec();
        let network = auv_graph::Network::new(&waypoints, &edges, 3.0).unwrap();
        let arc = network.arc_between(NodeId(0), NodeId(2)).unwrap();
        fixture.mission.network = std::sync::Arc::new(network);
        let guide = vec![place(0.0), place(-3_600.0), place(1_800.0)];
        fixture.mission.guides.insert(arc, guide);
        let current = auv_ocean::UniformCurrent::new(auv_types::Vector3::x() * current_mps);
        fixture.mission.current = (current_mps != 0.0)
            .then(|| std::sync::Arc::new(current) as std::sync::Arc<dyn auv_ocean::CurrentField>);
        fixture.state.ledger.removed.insert(EdgeId(0));
        fixture.view(|view| {
            let question = ask(view, RouteReason::SonarLost, RouteFrom::Waypoint);
            let asked = question.request(view.mission, view.tide, view.seed);
            quickest_home(view, &asked)
        })
    };
    assert_eq!(home(true, 0.0), Some(nodes(&[0, 2])));
    assert_eq!(home(false, 0.0), Some(nodes(&[0, 1, 2])));
    // Nothing gets through the current as forecast: the shortest way is tried.
    assert_eq!(home(false, -4.0), Some(nodes(&[0, 1, 2])));
}
