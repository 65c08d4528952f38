//! Properties of whole planning calls.

#![allow(
    clippy::float_cmp,
    clippy::unwrap_used,
    reason = "tests compare exact values on purpose and may panic"
)]

use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_ica_route::{Decoding, IcaRoute, IcaSettings};
use auv_planning::baseline::GreedyRoute;
use auv_planning::{Budget, Objective, RoutePlanner, RouteProblem, Run, StopReason};
use auv_population::Workers;
use auv_types::rand::RngExt;
use auv_types::{Point3, Seed};

fn network(nodes: u32, seed: u64) -> Network {
    let mut random = Seed(seed).stream(0);
    let mut metres = |high: f64| random.random_range(0.0..high);
    let waypoints: Vec<_> = (0..nodes)
        .map(|_| {
            Waypoint::at(Point3::new(
                metres(10_000.0),
                metres(10_000.0),
                metres(100.0),
            ))
        })
        .collect();
    let edges: Vec<_> = (0..nodes)
        .flat_map(|from| (from + 1..nodes).map(move |to| (from, to)))
        .map(|(from, to)| {
            let task = Task {
                priority: random.random_range(1.0..10.0),
                risk: random.random_range(1.0..10.0),
                completion_time_s: random.random_range(50.0..300.0),
            };
            Edge::undirected(from, to, task)
        })
        .collect();
    Network::new(&waypoints, &edges, 3.0).unwrap()
}

fn problem(network: &Network) -> RouteProblem<'_> {
    RouteProblem {
        objective: Objective::paper(),
        ..RouteProblem::new(
            network,
            NodeId(0),
            NodeId(network.num_nodes() as u32 - 1),
            15_000.0,
        )
    }
}

#[test]
fn more_iterations_give_less_cost_and_stay_in_time() {
    let network = network(30, 1);
    let problem = problem(&network);
    let cost = |iterations| {
        let settings = IcaSettings {
            iterations,
            ..IcaSettings::paper()
        };
        let mut run = Run::new(Seed(3), Budget::to_the_cap());
        let planned = IcaRoute::new(settings)
            .plan_route(&mut run, &problem)
            .unwrap();
        assert!(problem.check(&planned.best).is_ok() && planned.violation == 0.0);
        assert_eq!(planned.stats.stop, StopReason::Finished);
        assert_eq!(planned.stats.generations, iterations + 1);
        planned.cost
    };
    let (first, last) = (cost(0), cost(150));
    assert!(last < 0.9 * first, "{last} {first}");
}

#[test]
fn equal_seeds_give_equal_routes_at_any_number_of_threads() {
    let network = network(25, 2);
    let problem = problem(&network);
    let planned = |threads| {
        let planner =
            IcaRoute::new(IcaSettings::paper()).with_workers(Workers::new(threads).unwrap());
        let mut run = Run::new(Seed(5), Budget::evaluations(2_345));
        planner.plan_route(&mut run, &problem).unwrap()
    };
    let serial = planned(1);
    assert_eq!(serial, planned(2));
    assert_eq!(serial, planned(8));
    assert_eq!(serial.stats.evaluations, 2_345);
}

#[test]
fn every_variant_gives_feasible_routes() {
    let network = network(15, 4);
    for (decoding, uniting_distance) in
        [(Decoding::Plain, None), (Decoding::BudgetAware, Some(0.2))]
    {
        let settings = IcaSettings {
            decoding,
            uniting_distance,
            ..IcaSettings::paper()
        };
        for evaluations in [0, 1, 7, 150, 5_000] {
            let mut run = Run::new(Seed(1), Budget::evaluations(evaluations));
            let problem = problem(&network);
            let planned = IcaRoute::new(settings.clone())
                .plan_route(&mut run, &problem)
                .unwrap();
            assert!(problem.check(&planned.best).is_ok());
        }
    }
}

#[test]
fn a_search_cut_short_is_no_worse_than_the_greedy_route() {
    let network = network(40, 4);
    let problem = RouteProblem {
        objective: Objective::MostWeight,
        ..problem(&network)
    };
    let mut run = Run::new(Seed(0), Budget::to_the_cap());
    let greedy = GreedyRoute.plan_route(&mut run, &problem).unwrap();
    let stopped = std::sync::atomic::AtomicBool::new(true);
    let mut run = Run::new(Seed(0), Budget::to_the_cap()).with_cancel(&stopped);
    let planner = IcaRoute::new(IcaSettings::paper());
    let planned = planner.plan_route(&mut run, &problem).unwrap();
    assert_eq!(planned.stats.stop, StopReason::Cancelled);
    assert_eq!(planned.cost, greedy.cost);
}

#[test]
fn passes_the_conformance_kit() {
    use auv_verify::conformance;
    for settings in [IcaSettings::paper(), IcaSettings::default()] {
        let on =
            |threads| IcaRoute::new(settings.clone()).with_workers(Workers::new(threads).unwrap());
        if let Err(failures) = conformance::route_planner(&on(1)) {
            panic!("{failures}");
        }
        conformance::routes_on_threads(&[&on(1), &on(2), &on(8)]).unwrap();
    }
}
