//! Ends, legs, departures, visits and the time of a route in time, kept and broken.

use crate::in_time::{
    BEYOND_S, NEARLY_S, along, at, checked, found, model, network, route, schedule, task, work,
};
use auv_graph::{
    ArcId, EdgeId, EdgeSet, NodeId, Profiles, TaskPlace, TimeModel, TimedTask, Visits,
};
use auv_planning::RouteProblem;
use auv_verify::{RouteReport, TimeViolation as V, verify_route_in_time};

#[test]
fn adds_up_legs_work_and_waits() {
    let on_edge = TimedTask {
        task: task(3.0, 2.0, 10.0),
        ..work(TaskPlace::Edge(EdgeId(1)))
    };
    let model = model([work(at(1)), on_edge]);
    // 150 s to node 1, 30 s of work; 120 s to node 2, 10 s of work; 100 s to node 3.
    let (report, found) = checked(
        &model,
        &[0, 1, 2, 3],
        &[0.0, 180.0, 310.0],
        &[(0, 150.0), (1, 300.0)],
    );
    assert_eq!(found, []);
    assert_eq!((report.time_s, report.distance_m), (410.0, 900.0));
    assert_eq!((report.weight, report.tasks), (2.0 + 2.0 + 1.5 + 1.5, 4));
    // 7 s late off, 5 s before the first task, 3 s before node 2 is left.
    let (report, found) = checked(
        &model,
        &[0, 1, 2, 3],
        &[7.0, 192.0, 325.0],
        &[(0, 162.0), (1, 312.0)],
    );
    assert_eq!((report.time_s, found), (425.0, vec![]));
}

#[test]
fn an_edge_passed_back_does_its_own_task_once() {
    let home = TimeModel {
        destinations: vec![NodeId(2), NodeId(0)],
        ..TimeModel::default()
    };
    let (report, found) = checked(&home, &[0, 1, 0], &[0.0, 150.0], &[]);
    assert_eq!(found, []);
    assert_eq!(
        (report.time_s, report.weight, report.tasks),
        (250.0, 2.0, 1)
    );
    assert_eq!(report.distance_m, 600.0);
}

#[test]
fn travel_times_are_the_problems_or_those_of_the_departure() {
    let network = network();
    let nodes = route(&[0, 1, 2, 3]);
    let arc = |from: u32, to: u32| {
        let mut ends = network.arcs().iter().map(|arc| (arc.tail, arc.head));
        ends.position(|ends| ends == (NodeId(from), NodeId(to)))
            .unwrap()
    };
    // The problem's times hold the edge's own task: 75 s there, 33 s of them under way to node 2.
    let mut times = vec![1e6; network.arcs().len()];
    times[arc(0, 1)] = 75.0;
    times[arc(1, 2)] = 53.0;
    times[arc(2, 3)] = 40.0;
    let problem = RouteProblem {
        times: Some(&times),
        ..RouteProblem::new(&network, NodeId(0), NodeId(3), 168.0)
    };
    let quick = schedule(&[0.0, 75.0, 128.0], &[]);
    let (report, found) = verify_route_in_time(&problem, &nodes, &quick);
    assert_eq!((report.time_s, found), (168.0, vec![]));
    // By departure, to node 2: 60 s until 100 s, 90 s at 200 s, 40 s from 400 s on.
    let row = [(ArcId(arc(1, 2) as u32), vec![60.0, 90.0, 40.0])].into();
    let name = |arc: ArcId| arc.0.to_string();
    let model = TimeModel {
        profiles: Profiles::new(vec![100.0, 200.0, 400.0], row, name).unwrap(),
        ..TimeModel::default()
    };
    for (departure_s, travel_s) in [
        (80.0, 60.0),
        (100.0, 60.0),
        (130.0, 69.0),
        (200.0, 90.0),
        (280.0, 70.0),
        (400.0, 40.0),
        (700.0, 40.0),
    ] {
        let problem = RouteProblem {
            time_model: Some(&model),
            time_available_s: 1_000.0,
            ..problem
        };
        let ready_s = departure_s + travel_s + 20.0;
        let timed = schedule(&[0.0, departure_s, ready_s], &[]);
        let (report, found) = verify_route_in_time(&problem, &nodes, &timed);
        assert_eq!(found, [], "{departure_s}");
        assert!((report.time_s - ready_s - 40.0).abs() < 1e-9, "{report}");
        // A moment earlier it is not ready yet.
        let early = schedule(&[0.0, departure_s, ready_s - 1e-3], &[]);
        let (_, found) = verify_route_in_time(&problem, &nodes, &early);
        assert!(
            matches!(found[..], [V::LeavesEarly { node: NodeId(2), ready_s: told, .. }] if (told - ready_s).abs() < 1e-9),
            "{departure_s}: {found:?}"
        );
    }
}

#[test]
fn what_is_no_route_with_departures_is_not_added_up() {
    let model = model([work(at(1))]);
    let malformed = |nodes: &[u32], departures_s: &[f64], done: &[(usize, f64)]| {
        checked(&model, nodes, departures_s, done) == (RouteReport::default(), vec![V::Malformed])
    };
    assert!(malformed(&[], &[], &[]));
    assert!(malformed(&[0, 1, 4], &[0.0, 150.0], &[]));
    assert!(malformed(&[0, 3], &[], &[]));
    assert!(malformed(&[0, 3], &[0.0, 300.0], &[]));
    assert!(malformed(&[0, 3], &[0.0], &[(1, 0.0)]));
    assert!(!malformed(&[0, 3], &[0.0], &[]));
    assert!(!malformed(&[0], &[], &[]));
}

#[test]
fn ends_and_repeated_nodes_are_found() {
    let free = TimeModel::default();
    let ends = |first, last| V::WrongEnds {
        first: NodeId(first),
        last: NodeId(last),
    };
    assert_eq!(found(&free, &[0, 3], &[0.0], &[]), []);
    assert_eq!(found(&free, &[0, 1], &[0.0], &[]), [ends(0, 1)]);
    assert_eq!(found(&free, &[2, 3], &[0.0], &[]), [ends(2, 3)]);
    // Destinations of the model count in place of the problem's.
    let to = |nodes: &[u32]| TimeModel {
        destinations: nodes.iter().copied().map(NodeId).collect(),
        ..TimeModel::default()
    };
    assert_eq!(found(&to(&[2, 1]), &[0, 1], &[0.0], &[]), []);
    assert_eq!(found(&to(&[2]), &[0, 3], &[0.0], &[]), [ends(0, 3)]);
    let again = |node| V::RepeatedNode { node: NodeId(node) };
    let there_and_back = [0.0, 150.0, 270.0, 370.0];
    assert_eq!(
        found(
            &free,
            &[0, 1, 2, 1, 0, 3],
            &[0.0, 150.0, 270.0, 370.0, 470.0],
            &[]
        ),
        [again(0), again(1)]
    );
    // Start and end may be one node, but no third one.
    assert_eq!(
        found(&to(&[0]), &[0, 1, 2, 1, 0], &there_and_back, &[]),
        [again(1)]
    );
    assert_eq!(
        found(
            &to(&[0]),
            &[0, 1, 0, 1, 0],
            &[0.0, 150.0, 250.0, 350.0],
            &[]
        ),
        [again(0), again(1)]
    );
}

#[test]
fn legs_without_a_usable_edge_are_found() {
    let free = TimeModel {
        destinations: vec![NodeId(2)],
        ..TimeModel::default()
    };
    let missing = |from, to| V::MissingEdge {
        from: NodeId(from),
        to: NodeId(to),
    };
    // One way only, and none at all.
    assert_eq!(
        found(&free, &[0, 3, 2], &[0.0, 300.0], &[]),
        [missing(3, 2)]
    );
    let (report, none) = checked(&free, &[0, 2], &[0.0], &[]);
    assert_eq!(none, [missing(0, 2)]);
    assert_eq!(
        (report.time_s, report.distance_m, report.tasks),
        (0.0, 0.0, 0)
    );
    let network = network();
    let removed: EdgeSet = [EdgeId(1)].into_iter().collect();
    let problem = RouteProblem {
        removed: &removed,
        time_model: Some(&free),
        ..RouteProblem::new(&network, NodeId(0), NodeId(2), 1e3)
    };
    let timed = schedule(&[0.0, 150.0], &[]);
    let (_, taken) = verify_route_in_time(&problem, &route(&[0, 1, 2]), &timed);
    assert_eq!(taken, [missing(1, 2)]);
}

#[test]
fn a_departure_before_the_vehicle_is_ready_is_found() {
    let free = TimeModel::default();
    for (early_s, kept) in [(NEARLY_S, true), (BEYOND_S, false), (f64::NAN, false)] {
        let (report, found) = checked(&free, &[0, 1, 2, 3], &[0.0, 150.0 - early_s, 270.0], &[]);
        let told = matches!(found[..],
            [V::LeavesEarly { node: NodeId(1), departure_s, ready_s: 150.0 }] if departure_s.is_nan() || departure_s < 150.0);
        assert_eq!((found.is_empty(), told), (kept, !kept), "{found:?}");
        // The clock does not run back.
        assert_eq!(report.time_s, 370.0);
    }
}

#[test]
fn visits_come_in_time() {
    // Arrivals at node 2, at 270 s, and at the end, at 370 s.
    let every = |nodes: &[u32], every_s| TimeModel {
        visits: Some(Visits {
            nodes: nodes.iter().copied().map(NodeId).collect(),
            every_s,
        }),
        ..TimeModel::default()
    };
    let gaps = |nodes: &[u32], every_s: f64| -> Vec<f64> {
        let found = along(&every(nodes, every_s), &[]);
        let gap = |v: &V| match v {
            V::LateVisit { gap_s } => *gap_s,
            other => panic!("{other}"),
        };
        found.iter().map(gap).collect()
    };
    assert_eq!(gaps(&[2], 300.0), [0.0; 0]);
    assert_eq!(gaps(&[2], 270.0 - NEARLY_S), [0.0; 0]);
    assert_eq!(gaps(&[2], 270.0 - BEYOND_S), [270.0]);
    assert_eq!(gaps(&[2], 50.0), [270.0, 100.0]);
    assert_eq!(gaps(&[0, 1, 3], 50.0), [150.0, 220.0]);
    assert_eq!(gaps(&[], 300.0), [370.0]);
}

#[test]
fn the_time_available_is_kept() {
    let network = network();
    for (spare_s, kept) in [
        (0.0, true),
        (-NEARLY_S, true),
        (-BEYOND_S, false),
        (f64::NAN, false),
    ] {
        let available = 300.0 + spare_s;
        // Without a model there are travel and departures alone.
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(3), available);
        let timed = schedule(&[0.0], &[]);
        let (report, found) = verify_route_in_time(&problem, &route(&[0, 3]), &timed);
        let told = matches!(found[..],
            [V::TooLong { time_s: 300.0, available_s }] if available_s.to_bits() == available.to_bits());
        assert_eq!((found.is_empty(), told), (kept, !kept), "{found:?}");
        assert_eq!(report.time_s, 300.0);
    }
}
