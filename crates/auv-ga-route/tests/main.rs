//! Properties of whole planning calls.

#![allow(
    clippy::float_cmp,
    clippy::unwrap_used,
    reason = "tests compare exact values on purpose and may panic"
)]

use auv_ga_route::{
    Decoding, EvolutionSettings, GaRoute, GaSettings, InvalidOffspring, MemeticSettings,
    RouteRanking,
};
use auv_graph::{Edge, EdgeId, EdgeSet, Network, NodeId, Route, Task, Waypoint};
use auv_planning::baseline::GreedyRoute;
use auv_planning::{
    Budget, Generation, Objective, PlanError, RouteCost, RoutePlanner, RouteProblem, Run,
    StopReason, TaskCost,
};
use auv_population::Workers;
use auv_types::rand::RngExt;
use auv_types::{Point3, Seed};

/// A random network; each pair is an edge with the given probability.
fn network(nodes: u32, density: f64, directed: bool, seed: u64) -> Network {
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
    let mut edges = Vec::new();
    for from in 0..nodes {
        for to in 0..nodes {
            let is_new = if directed { from != to } else { from < to };
            if is_new && random.random_range(0.0..1.0) < density {
                let task = Task {
                    priority: f64::from(random.random_range(0..=10_u32)),
                    risk: random.random_range(1.0..10.0),
                    completion_time_s: random.random_range(50.0..300.0),
                };
                edges.push(Edge {
                    directed,
                    ..Edge::undirected(from, to, task)
                });
            }
        }
    }
    Network::new(&waypoints, &edges, 3.0).unwrap()
}

/// The most weight of any route in time, by enumeration of all routes.
fn most_weight(problem: &RouteProblem<'_>) -> Option<f64> {
    fn extend(
        problem: &RouteProblem<'_>,
        nodes: &mut Vec<NodeId>,
        time_s: f64,
        weight: f64,
        best: &mut Option<f64>,
    ) {
        let at = nodes[nodes.len() - 1];
        if at == problem.destination {
            *best = Some(best.map_or(weight, |most: f64| most.max(weight)));
            return;
        }
        for (id, arc) in problem.network.arcs_from(at) {
            let there_s = time_s + problem.network.arc_time_s(id, problem.times);
            let is_free = !nodes.contains(&arc.head) && !problem.removed.contains(arc.edge);
            if is_free && there_s <= problem.time_available_s {
                nodes.push(arc.head);
                extend(problem, nodes, there_s, weight + arc.weight, best);
                nodes.pop();
            }
        }
    }
    let mut best = None;
    extend(problem, &mut vec![problem.start], 0.0, 0.0, &mut best);
    best
}

fn plan(
    settings: GaSettings,
    problem: &RouteProblem<'_>,
    evaluations: u64,
    seed: u64,
) -> auv_planning::Planned<Route> {
    let mut run = Run::new(Seed(seed), Budget::evaluations(evaluations));
    GaRoute::new(settings)
        .plan_route(&mut run, problem)
        .unwrap()
}

fn presets() -> [GaSettings; 2] {
    [GaSettings::paper(), GaSettings::default()]
}

#[test]
fn the_optimum_of_small_networks_is_found() {
    let (mut solved, mut equal) = (0, 0);
    for seed in 0..1_000 {
        let nodes = 3 + (seed % 7) as u32;
        let network = network(nodes, 0.75, seed % 3 == 0, seed);
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(nodes - 1), 9_000.0);
        let Some(most) = most_weight(&problem) else {
            continue;
        };
        let planned = plan(GaSettings::default(), &problem, 1_500, seed);
        let totals = problem.check(&planned.best).unwrap();
        assert!(totals.weight <= most + 1e-9, "above the optimum");
        assert_eq!(planned.cost, -totals.weight);
        solved += 1;
        equal += usize::from(totals.weight >= most - 1e-9);
    }
    assert!(
        solved > 700 && equal * 100 >= solved * 99,
        "{equal} of {solved}"
    );
}

#[test]
fn equal_seeds_give_equal_routes_at_any_number_of_threads() {
    for (directed, seed) in [(false, 1), (true, 2)] {
        let network = network(30, 0.6, directed, seed);
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(29), 15_000.0);
        for settings in presets() {
            let planned = |threads| {
                let workers = Workers::new(threads).unwrap();
                let planner = GaRoute::new(settings.clone()).with_workers(workers);
                let mut run = Run::new(Seed(7), Budget::evaluations(3_000));
                planner.plan_route(&mut run, &problem).unwrap()
            };
            let serial = planned(1);
            assert_eq!(serial, planned(2));
            assert_eq!(serial, planned(8));
            assert_eq!(serial.stats.evaluations, 3_000);
        }
    }
}

#[test]
fn no_insertion_replacement_or_swap_improves_the_answer() {
    for seed in 0..20 {
        let network = network(18, 0.7, seed % 3 == 0, seed);
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(17), 12_000.0);
        let planned = plan(GaSettings::default(), &problem, 300, seed);
        if planned.violation == 0.0 {
            assert_no_near_route_is_better(&problem, planned.best.nodes(), -planned.cost);
        }
    }
}

/// Tries every insertion, every removal with an insertion and every swap.
fn assert_no_near_route_is_better(problem: &RouteProblem<'_>, nodes: &[NodeId], weight: f64) {
    let not_better = |nodes: Vec<NodeId>| {
        // Among routes of equal weight the quicker one wins, by a price of 1e-9 a second.
        let tie = 1e-9 * problem.time_available_s;
        let changed = problem.check(&Route::new(nodes));
        assert!(changed.map_or(0.0, |totals| totals.weight) <= weight + tie);
    };
    let all: Vec<_> = (0..problem.network.num_nodes() as u32)
        .map(NodeId)
        .collect();
    for out in 0..nodes.len() - 1 {
        let mut shorter = nodes.to_vec();
        if out > 0 {
            shorter.remove(out);
        }
        for &node in all.iter().filter(|node| !shorter.contains(node)) {
            for at in 1..shorter.len() {
                let mut changed = shorter.clone();
                changed.insert(at, node);
                not_better(changed);
            }
        }
        for other in 1..nodes.len() - 1 {
            let mut swapped = nodes.to_vec();
            swapped.swap(out.max(1), other);
            not_better(swapped);
        }
    }
}

#[test]
fn changed_times_replace_those_of_the_network() {
    let network = network(15, 0.9, false, 3);
    let quiet = RouteProblem::new(&network, NodeId(0), NodeId(14), 12_000.0);
    let before = plan(GaSettings::default(), &quiet, 2_000, 1);
    // The first leg of the plan is blocked; all others take a fifth longer one way.
    let (from, to) = before.best.legs().next().unwrap();
    let blocked = network.arc_between(from, to).unwrap().index();
    let times: Vec<f64> = (0..)
        .zip(network.arcs())
        .map(|(i, arc)| match i {
            _ if i == blocked => f64::INFINITY,
            _ if i % 2 == 0 => arc.time_s * 1.2,
            _ => arc.time_s,
        })
        .collect();
    let now = RouteProblem {
        times: Some(&times),
        ..quiet
    };
    for settings in presets() {
        let after = plan(settings, &now, 2_000, 1);
        assert!(now.check(&after.best).is_ok() && now.check(&before.best).is_err());
        assert!(after.best.legs().next() != Some((from, to)));
    }
    assert_eq!(plan(GaSettings::default(), &quiet, 2_000, 1), before);
}

#[test]
fn more_evaluations_and_a_warm_start_never_make_it_worse() {
    let network = network(40, 0.8, false, 9);
    let problem = RouteProblem::new(&network, NodeId(0), NodeId(39), 20_000.0);
    let greedy = GreedyRoute
        .plan_route(&mut Run::new(Seed(0), Budget::evaluations(1)), &problem)
        .unwrap();
    assert!(plan(GaSettings::default(), &problem, 1, 3).cost <= greedy.cost);
    let mut last = greedy.cost;
    for evaluations in [100, 1_000, 10_000] {
        let planned = plan(GaSettings::default(), &problem, evaluations, 3);
        assert!(planned.cost <= last && problem.check(&planned.best).is_ok());
        last = planned.cost;
        for settings in presets() {
            let warm = RouteProblem {
                incumbent: Some(&planned.best),
                ..problem
            };
            assert!(plan(settings, &warm, 50, 4).cost <= planned.cost);
        }
    }
    assert!(last < greedy.cost);
}

#[test]
fn the_greedy_route_is_reported_at_once_under_any_budget() {
    let network = network(80, 0.9, false, 9);
    let problem = RouteProblem::new(&network, NodeId(0), NodeId(79), 20_000.0);
    let greedy = GreedyRoute
        .plan_route(&mut Run::new(Seed(0), Budget::evaluations(1)), &problem)
        .unwrap();
    let planner = GaRoute::new(GaSettings::default());
    for budget in [
        Budget::wall_time(std::time::Duration::ZERO),
        Budget::evaluations(500),
    ] {
        let mut reported = Vec::new();
        let mut observe = |generation: &Generation<'_>| reported.push(generation.best.cost);
        let mut run = Run::new(Seed(0), budget).with_observer(&mut observe);
        let planned = planner.plan_route(&mut run, &problem).unwrap();
        assert!(planned.cost <= greedy.cost && problem.check(&planned.best).is_ok());
        assert_eq!(reported[0], greedy.cost);
        assert_eq!(budget.evaluations.is_some(), reported.len() > 1);
    }
}

#[test]
fn removed_edges_and_changed_times_are_respected() {
    let network = network(12, 1.0, false, 11);
    let removed: EdgeSet = (0..30).map(|i| EdgeId(2 * i)).collect();
    let times: Vec<f64> = network
        .arcs()
        .iter()
        .enumerate()
        .map(|(i, arc)| {
            if i % 7 == 3 {
                f64::INFINITY
            } else {
                arc.time_s * 1.3
            }
        })
        .collect();
    let problem = RouteProblem {
        removed: &removed,
        times: Some(&times),
        ..RouteProblem::new(&network, NodeId(0), NodeId(11), 12_000.0)
    };
    for settings in presets() {
        let planned = plan(settings, &problem, 2_000, 0);
        assert!(problem.check(&planned.best).is_ok() && planned.violation == 0.0);
    }
}

#[test]
fn small_and_impossible_problems_have_answers() {
    let network = network(6, 1.0, false, 2);
    for settings in presets() {
        let stay = RouteProblem::new(&network, NodeId(3), NodeId(3), 100.0);
        assert_eq!(
            plan(settings.clone(), &stay, 10, 0).best.nodes(),
            [NodeId(3)]
        );
        let short = RouteProblem::new(&network, NodeId(0), NodeId(5), 1.0);
        let planned = plan(settings.clone(), &short, 10, 0);
        let (quickest, totals) = short.quickest().unwrap();
        assert_eq!(planned.best, quickest);
        assert_eq!(planned.violation, short.violation(totals.time_s));
        let unlimited = RouteProblem::new(&network, NodeId(0), NodeId(5), f64::INFINITY);
        assert!(plan(settings.clone(), &unlimited, 500, 0).cost.is_finite());
        let nothing = plan(settings.clone(), &unlimited, 0, 0);
        assert!(unlimited.check(&nothing.best).is_ok());
        let alone = Network::new(&network.waypoints()[..2], &[], 3.0).unwrap();
        let cut_off = RouteProblem::new(&alone, NodeId(0), NodeId(1), 1e6);
        let mut run = Run::new(Seed(0), Budget::evaluations(10));
        let error = GaRoute::new(settings).plan_route(&mut run, &cut_off);
        assert!(matches!(error, Err(PlanError::Unreachable { .. })));
    }
}

#[test]
fn every_objective_is_minimised() {
    let network = network(20, 0.8, false, 4);
    for task in [
        TaskCost::InverseWeight,
        TaskCost::SumInverse,
        TaskCost::RatioOfSums,
    ] {
        let objective = Objective::RouteCost(RouteCost {
            task,
            ..RouteCost::paper()
        });
        let problem = RouteProblem {
            objective,
            ..RouteProblem::new(&network, NodeId(0), NodeId(19), 12_000.0)
        };
        let quickest = problem.quickest().unwrap().1;
        for settings in presets() {
            let planned = plan(settings, &problem, 5_000, 1);
            let totals = problem.check(&planned.best).unwrap();
            assert_eq!(planned.cost, objective.cost(&totals, 12_000.0));
            assert!(planned.cost < objective.cost(&quickest, 12_000.0));
        }
    }
}

#[test]
fn the_papers_algorithm_ends_by_its_three_criteria() {
    let network = network(15, 0.9, false, 6);
    let problem = RouteProblem::new(&network, NodeId(0), NodeId(14), 12_000.0);
    let stop = |change: &dyn Fn(&mut EvolutionSettings)| {
        let mut settings = EvolutionSettings {
            uniform_patience: None,
            stall_patience: None,
            iterations: 400,
            ..EvolutionSettings::paper()
        };
        change(&mut settings);
        let mut run = Run::new(Seed(1), Budget::to_the_cap());
        let planner = GaRoute::new(GaSettings::Evolution(settings));
        let stats = planner.plan_route(&mut run, &problem).unwrap().stats;
        (stats.stop, stats.generations)
    };
    // The generation that draws the initial routes counts too.
    assert_eq!(stop(&|s| s.iterations = 20), (StopReason::Finished, 21));
    let stalled = stop(&|s| s.stall_patience = Some(30));
    assert!(stalled.0 == StopReason::Stalled && stalled.1 < 400);
    let uniform = stop(&|s| (s.uniform_patience, s.uniform_tolerance) = (Some(5), 0.9));
    assert!(uniform.0 == StopReason::Stalled && uniform.1 < 400);
}

#[test]
fn every_variant_of_the_papers_algorithm_gives_feasible_routes() {
    let network = network(20, 0.7, true, 8);
    let problem = RouteProblem {
        objective: Objective::paper(),
        ..RouteProblem::new(&network, NodeId(0), NodeId(19), 9_000.0)
    };
    for initialisation in [Decoding::Plain, Decoding::BudgetAware] {
        for invalid_offspring in [InvalidOffspring::Discard, InvalidOffspring::Repair] {
            for ranking in [RouteRanking::Deb, RouteRanking::Cost] {
                let settings = EvolutionSettings {
                    initialisation,
                    invalid_offspring,
                    ranking,
                    ..EvolutionSettings::paper()
                };
                for evaluations in [1, 99, 177, 4_000] {
                    let settings = GaSettings::Evolution(settings.clone());
                    let planned = plan(settings, &problem, evaluations, 2);
                    assert!(problem.check(&planned.best).is_ok());
                    assert!(planned.stats.evaluations <= evaluations);
                }
            }
        }
    }
}

#[test]
fn every_invalid_setting_is_reported() {
    let evolution = EvolutionSettings {
        population: 0,
        selection_pressure: f64::NAN,
        ..EvolutionSettings::paper()
    };
    assert_eq!(GaSettings::Evolution(evolution).validate().total(), 2);
    let memetic = MemeticSettings {
        offspring: 0,
        price: -1.0,
        ..MemeticSettings::default()
    };
    assert_eq!(GaSettings::Memetic(memetic).validate().total(), 2);
    assert!(presets().iter().all(|preset| preset.validate().is_empty()));
}

#[test]
fn a_search_cut_short_is_no_worse_than_the_greedy_route() {
    let network = network(40, 1.0, false, 4);
    let problem = RouteProblem::new(&network, NodeId(0), NodeId(39), 15_000.0);
    let mut run = Run::new(Seed(0), Budget::to_the_cap());
    let greedy = GreedyRoute.plan_route(&mut run, &problem).unwrap();
    let stopped = std::sync::atomic::AtomicBool::new(true);
    for settings in presets() {
        let mut run = Run::new(Seed(0), Budget::to_the_cap()).with_cancel(&stopped);
        let planner = GaRoute::new(settings);
        let planned = planner.plan_route(&mut run, &problem).unwrap();
        assert_eq!(planned.stats.stop, StopReason::Cancelled);
        assert_eq!(planned.cost, greedy.cost);
    }
}

#[test]
fn passes_the_conformance_kit() {
    use auv_verify::conformance;
    for settings in presets() {
        let on =
            |threads| GaRoute::new(settings.clone()).with_workers(Workers::new(threads).unwrap());
        if let Err(failures) = conformance::route_planner(&on(1)) {
            panic!("{failures}");
        }
        conformance::routes_on_threads(&[&on(1), &on(2), &on(8)]).unwrap();
    }
}

/// 40 by 40 waypoints, each connected to its neighbours, from one corner to the opposite one.
fn large_network() -> Network {
    const SIDE: u32 = 40;
    let mut random = Seed(3).stream(0);
    let places = (0..SIDE * SIDE).map(|i| {
        let [x, y] = [i % SIDE, i / SIDE].map(|k| 100.0 * f64::from(k));
        Waypoint::at(Point3::new(x, y, 20.0))
    });
    let waypoints: Vec<_> = places.collect();
    let mut edges = Vec::new();
    for i in 0..SIDE * SIDE {
        for (is_inside, to) in [
            (i % SIDE + 1 < SIDE, i + 1),
            (i / SIDE + 1 < SIDE, i + SIDE),
        ] {
            let task = Task {
                priority: f64::from(random.random_range(1..=10_u32)),
                risk: random.random_range(1.0..10.0),
                completion_time_s: random.random_range(0.0..30.0),
            };
            edges.extend(is_inside.then(|| Edge::undirected(i, to, task)));
        }
    }
    Network::new(&waypoints, &edges, 3.0).unwrap()
}

#[test]
fn in_a_large_network_one_tour_is_annealed() {
    let network = large_network();
    let removed: EdgeSet = (0..200).map(|edge| EdgeId(edge * 7 + 1)).collect();
    let problem = RouteProblem {
        removed: &removed,
        ..RouteProblem::new(&network, NodeId(0), NodeId(1_599), 6_000.0)
    };
    let greedy = GreedyRoute
        .plan_route(&mut Run::new(Seed(1), Budget::to_the_cap()), &problem)
        .unwrap();
    let plan = |seed| plan(GaSettings::default(), &problem, 5_000, seed);
    let annealed = plan(1);
    let totals = problem.check(&annealed.best).unwrap();
    assert_eq!(annealed.violation, 0.0);
    assert!((annealed.cost + totals.weight).abs() < 1e-9 * totals.weight);
    assert!(
        annealed.cost < greedy.cost,
        "{} of {}",
        annealed.cost,
        greedy.cost
    );
    assert_eq!(annealed.stats.stop, StopReason::EvaluationsSpent);
    assert_eq!(annealed, plan(1));
}

#[test]
fn settings_out_of_range_are_named_with_what_to_give() {
    let settings = EvolutionSettings {
        population: 0,
        parent_pairs: 0,
        mutants: 0,
        initial_tries: 0,
        selection_pressure: -1.0,
        ..EvolutionSettings::default()
    };
    let message = settings.validate().to_string();
    for part in [
        "population is 0; give 1 to 1,000,000 routes",
        "mutants and parent_pairs add up to 0; give 1 to 1,000,000 offspring",
        "initial_tries is 0; give at least 1",
        "selection_pressure is -1; give a finite value of at least 0",
    ] {
        assert!(message.contains(part), "{part}: {message}");
    }
    let settings = MemeticSettings {
        noise: 1.5,
        ..MemeticSettings::default()
    };
    let message = settings.validate().to_string();
    assert!(
        message.contains("is 1.5; give a share from 0 to 1"),
        "{message}"
    );
}
