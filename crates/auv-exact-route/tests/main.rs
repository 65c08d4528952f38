//! The planner against an enumeration of all routes, against known optima, and against the conformance
//! kit.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests fail by panicking and say when they are skipped"
)]

use auv_exact_route::ExactRoute;
use auv_graph::{
    Edge, EdgeId, EdgeSet, Network, NodeId, Profiles, Route, Task, TaskName, TaskPlace, Terrain,
    TimeModel, TimedTask, Topology, Visits, Waypoint, format,
};
use auv_planning::baseline::GreedyRoute;
use auv_planning::timed::{LeftOut, left_out};
use auv_planning::{Budget, PlanError, RoutePlanner, RouteProblem, Run, StopReason};
use auv_types::{Point3, Seed};
use proptest::prelude::*;

/// The most weight of all simple routes within the budget.
fn by_enumeration(problem: &RouteProblem<'_>, nodes: &mut Vec<NodeId>, best: &mut f64) {
    let at = nodes[nodes.len() - 1];
    if at == problem.destination {
        if let Ok(totals) = problem.check(&Route::new(nodes.clone())) {
            *best = best.max(totals.weight);
        }
        return;
    }
    let heads: Vec<_> = problem
        .network
        .arcs_from(at)
        .map(|(_, arc)| arc.head)
        .collect();
    for head in heads {
        if !nodes.contains(&head) {
            nodes.push(head);
            by_enumeration(problem, nodes, best);
            nodes.pop();
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn earns_as_much_as_the_best_of_all_routes(
        seed in 0_u64..1_000_000,
        nodes in 2_usize..=8,
        density in 0.3_f64..1.0,
        directed in any::<bool>(),
        budget_s in 2000.0_f64..16_000.0,
        removed in prop::collection::vec(0_u32..20, 0..4),
        slower in prop::bool::ANY,
    ) {
        let pairs = nodes * (nodes - 1) / if directed { 1 } else { 2 };
        let terrain = Terrain {
            topology: if directed { Topology::Directed } else { Topology::Undirected },
            ..Terrain::paper(nodes, ((pairs as f64 * density) as usize).max(1))
        };
        let Ok(instance) = terrain.draw(Seed(seed)) else { return Ok(()) };
        let removed: EdgeSet = removed.into_iter().map(EdgeId).collect();
        let times: Vec<f64> = instance.network.arcs().iter().enumerate()
            .map(|(i, arc)| if i % 7 == 3 { f64::INFINITY } else { arc.time_s * 1.1 })
            .collect();
        let problem = RouteProblem {
            removed: &removed,
            times: slower.then_some(&times),
            ..RouteProblem::new(&instance.network, instance.start, instance.destination, budget_s)
        };
        let mut run = Run::new(Seed(0), Budget::to_the_cap());
        let Ok(planned) = ExactRoute::default().plan_route(&mut run, &problem) else {
            prop_assert!(problem.quickest().is_err());
            return Ok(());
        };
        let mut best = f64::NEG_INFINITY;
        by_enumeration(&problem, &mut vec![problem.start], &mut best);
        if planned.violation > 0.0 {
            prop_assert!(best.is_infinite());
            return Ok(());
        }
        let totals = problem.check(&planned.best).unwrap();
        prop_assert_eq!(planned.stats.stop, StopReason::Optimal);
        prop_assert!((totals.weight - best).abs() <= 1e-9 * best.max(1.0), "{} {}", totals.weight, best);

        // Stopped early, the bound holds, and so does the budget; the result is reproducible.
        let stopped = |evaluations| {
            let mut run = Run::new(Seed(0), Budget::evaluations(evaluations));
            ExactRoute::default().plan_route(&mut run, &problem).unwrap()
        };
        for evaluations in [1, 30, 200] {
            let early = stopped(evaluations);
            prop_assert!(early.bound.unwrap() <= -best + 1e-9 * best.max(1.0));
            prop_assert!(early.stats.evaluations <= evaluations);
            prop_assert_eq!(&early, &stopped(evaluations));
        }
    }
}

#[test]
fn passes_the_conformance_kit() {
    auv_verify::conformance::route_planner(&ExactRoute::default()).unwrap();
}

/// Five nodes on a line of 900 m at 2 m/s, all joined. Tasks that weigh 1 to 3 at the inner ones; the first
/// opens at 400 s only.
fn line() -> (Network, TimeModel) {
    let waypoints: Vec<_> = (0..5)
        .map(|i| Waypoint::at(Point3::new(f64::from(i) * 225.0, 0.0, 0.0)))
        .collect();
    let pairs = (0..5).flat_map(|a| (a + 1..5).map(move |b| (a, b)));
    let edges: Vec<_> = pairs
        .map(|(a, b)| Edge::undirected(a, b, Task::TRANSIT))
        .collect();
    let task = |node: u32| TimedTask {
        name: TaskName::Number(node.into()),
        place: TaskPlace::Node(NodeId(node)),
        task: Task {
            priority: node.into(),
            risk: 1.0,
            completion_time_s: 0.0,
        },
        windows: if node == 1 {
            vec![[400.0, 450.0]]
        } else {
            Vec::new()
        },
        after: Vec::new(),
        chain: None,
        mandatory: false,
    };
    let model = TimeModel {
        tasks: (1..4).map(task).collect(),
        ..TimeModel::default()
    };
    (Network::new(&waypoints, &edges, 2.0).unwrap(), model)
}

#[test]
fn proves_routes_that_meet_a_place_again_and_again() {
    let (network, mut model) = line();
    // All three tasks end at 737 s, long after node 2; without the first it is 225 s before and after it.
    for (every_s, most) in [(None, 6.0), (Some(250.0), 5.0)] {
        model.visits = every_s.map(|every_s| Visits {
            nodes: vec![NodeId(2)],
            every_s,
        });
        let mut problem = RouteProblem::new(&network, NodeId(0), NodeId(4), 850.0);
        problem.time_model = Some(&model);
        let mut run = Run::new(Seed(0), Budget::to_the_cap());
        let proven = ExactRoute::default()
            .plan_route(&mut run, &problem)
            .unwrap();
        assert_eq!((proven.cost, proven.violation), (-most, 0.0));
        assert_eq!(proven.stats.stop, StopReason::Optimal);
    }
}

#[test]
fn a_window_that_closes_before_what_comes_first_is_told() {
    let (network, mut model) = line();
    // The task at node 1 opens at 400 s, long after the one at node 2 closes.
    model.tasks[1].windows = vec![[0.0, 300.0]];
    let told = |model: &TimeModel| {
        let mut problem = RouteProblem::new(&network, NodeId(0), NodeId(4), 1500.0);
        problem.time_model = Some(model);
        let mut run = Run::new(Seed(0), Budget::to_the_cap());
        let planned = ExactRoute::default().plan_route(&mut run, &problem);
        left_out(&problem, model, &planned.unwrap().schedule.unwrap())
    };
    assert_eq!(told(&model), vec![]);
    model.tasks[1].after = vec![0];
    assert_eq!(told(&model), vec![(1, LeftOut::Window)]);
}

#[test]
fn waits_first_where_a_place_is_met_in_time_only_so() {
    let at = |north_m| Waypoint::at(Point3::new(north_m, 0.0, 0.0));
    let edges = [(0, 1), (1, 2)].map(|(a, b)| Edge::undirected(a, b, Task::TRANSIT));
    let network = Network::new(&[at(0.0), at(200.0), at(400.0)], &edges, 2.0).unwrap();
    // The tide lets nothing leave node 1 for node 2 before 800 s; both ways take 100 s.
    let onwards = network.arc_between(NodeId(1), NodeId(2)).unwrap();
    let travel_s = [(onwards, vec![900.0, 100.0])].into();
    let profiles = Profiles::new(vec![0.0, 800.0], travel_s, |arc| arc.0.to_string()).unwrap();
    for (every_s, is_possible) in [(600.0, true), (400.0, false)] {
        let model = TimeModel {
            profiles: profiles.clone(),
            visits: Some(Visits {
                nodes: vec![NodeId(1)],
                every_s,
            }),
            ..TimeModel::default()
        };
        let mut problem = RouteProblem::new(&network, NodeId(0), NodeId(2), 1200.0);
        problem.time_model = Some(&model);
        let mut run = Run::new(Seed(0), Budget::to_the_cap());
        let planned = ExactRoute::default().plan_route(&mut run, &problem);
        if is_possible {
            // It is at node 1 after 300 s at the earliest, and at the end after 900 s.
            let schedule = planned.unwrap().schedule.unwrap();
            assert_eq!(schedule.departures_s.len(), 2);
            assert!((schedule.end_s - 900.0).abs() < 1e-6, "{schedule:?}");
        } else {
            let error = planned.unwrap_err();
            assert!(matches!(error, PlanError::Impossible { .. }), "{error}");
        }
    }
}

#[test]
fn proves_a_network_of_the_papers_size() {
    let instance = Terrain::table2().draw(Seed(1)).unwrap();
    let ends = (instance.start, instance.destination);
    let problem = RouteProblem::new(&instance.network, ends.0, ends.1, instance.budget_s);
    let mut run = Run::new(Seed(0), Budget::to_the_cap());
    let proven = ExactRoute::default()
        .plan_route(&mut run, &problem)
        .unwrap();
    assert_eq!(proven.stats.stop, StopReason::Optimal);

    // With the answer as incumbent, it proves the same cost.
    let with_incumbent = RouteProblem {
        incumbent: Some(&proven.best),
        ..problem
    };
    let mut run = Run::new(Seed(0), Budget::to_the_cap());
    let again = ExactRoute::default()
        .plan_route(&mut run, &with_incumbent)
        .unwrap();
    assert!((again.cost - proven.cost).abs() < 1e-9);
    assert_eq!(again.stats.stop, StopReason::Optimal);
}

#[test]
fn proves_the_known_optima() {
    let Ok(root) = std::env::var("AUV_DATA_DIR") else {
        println!("skipped: set AUV_DATA_DIR");
        return;
    };
    for (name, optimum) in [
        ("auv-20-186u-T25200-s1", 82.301_096),
        ("auv-20-186u-T25200-s2", 84.231_642),
        ("auv-20-186u-T25200-s3", 80.944_436),
        ("auv-20-186u-T25200-s4", 74.960_190),
        ("auv-20-186u-T25200-s5", 85.577_969),
        ("auv-50-1470d-T10800-s1", 53.542_520),
    ] {
        let bytes = std::fs::read(format!("{root}/routes/{name}.json")).unwrap();
        let instance = format::read(&bytes, name).unwrap();
        let ends = (instance.start, instance.destination);
        let problem = RouteProblem::new(&instance.network, ends.0, ends.1, instance.budget_s);
        let mut run = Run::new(Seed(0), Budget::to_the_cap());
        let planned = ExactRoute::default()
            .plan_route(&mut run, &problem)
            .unwrap();
        assert_eq!(planned.stats.stop, StopReason::Optimal);
        assert!(
            (-planned.cost - optimum).abs() < 1e-6,
            "{name}: {}",
            planned.cost
        );
    }
}

#[test]
fn cut_short_it_gives_the_greedy_route_and_no_bound() {
    let terrain = auv_graph::Terrain::benchmark(40, 600);
    let instance = terrain.draw(Seed(4)).unwrap();
    let ends = (instance.start, instance.destination);
    let problem = RouteProblem::new(&instance.network, ends.0, ends.1, instance.budget_s);
    let mut run = Run::new(Seed(0), Budget::to_the_cap());
    let greedy = GreedyRoute.plan_route(&mut run, &problem).unwrap();
    let stopped = std::sync::atomic::AtomicBool::new(true);
    let mut run = Run::new(Seed(0), Budget::to_the_cap()).with_cancel(&stopped);
    let planned = ExactRoute::default()
        .plan_route(&mut run, &problem)
        .unwrap();
    assert_eq!(planned.stats.stop, StopReason::Cancelled);
    assert_eq!((planned.cost, planned.bound), (greedy.cost, None));
}
