//! The route planners: generations of the memetic algorithm against nodes and threads, whole calls
//! of the paper's algorithms.

use auv_ga_route::{GaRoute, GaSettings, MemeticSettings};
use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_ica_route::{IcaRoute, IcaSettings};
use auv_planning::{Budget, Objective, RoutePlanner, RouteProblem, Run};
use auv_population::Workers;
use auv_types::rand::RngExt;
use auv_types::{Point3, Seed};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;

/// The paper's terrain: waypoints in 10 km x 10 km x 100 m, nearly every pair an edge.
fn network(nodes: u32) -> Network {
    let mut random = Seed(nodes.into()).stream(0);
    let mut draw = |low: f64, high: f64| random.random_range(low..high);
    let waypoints: Vec<_> = (0..nodes)
        .map(|_| {
            Waypoint::at(Point3::new(
                draw(0.0, 1e4),
                draw(0.0, 1e4),
                draw(0.0, 100.0),
            ))
        })
        .collect();
    let mut edges = Vec::new();
    for from in 0..nodes {
        for to in from + 1..nodes {
            let task = Task {
                priority: draw(1.0, 10.0),
                risk: draw(1.0, 10.0),
                completion_time_s: draw(50.0, 300.0),
            };
            edges.push(Edge::undirected(from, to, task));
        }
    }
    Network::new(&waypoints, &edges, 3.0).unwrap_or_else(|error| unreachable!("{error}"))
}

fn problem(network: &Network) -> RouteProblem<'_> {
    let destination = NodeId(network.num_nodes() as u32 - 1);
    RouteProblem::new(network, NodeId(0), destination, 25_200.0)
}

fn call(planner: &dyn RoutePlanner, problem: &RouteProblem<'_>, budget: Budget) {
    let mut run = Run::new(Seed(1), budget);
    let _ = black_box(planner.plan_route(&mut run, problem));
}

/// 20,000 evaluations with an initial population of 100, on 1 and 2 threads.
fn memetic(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("memetic_20000_evaluations");
    group.sample_size(10);
    let settings = MemeticSettings {
        first_population: 100,
        ..MemeticSettings::default()
    };
    for nodes in [20, 50, 100, 200] {
        let network = network(nodes);
        let problem = problem(&network);
        for threads in [1, 2] {
            let Ok(workers) = Workers::new(threads) else {
                continue;
            };
            let settings = GaSettings::Memetic(settings.clone());
            let planner = GaRoute::new(settings).with_workers(workers);
            let name = BenchmarkId::new(format!("{nodes}_nodes"), format!("{threads}_threads"));
            group.bench_function(name, |bencher| {
                bencher.iter(|| call(&planner, &problem, Budget::evaluations(20_000)));
            });
        }
    }
}

/// One evaluation: setting up and the greedy route.
fn set_up(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("set_up");
    for nodes in [50, 100, 200, 500] {
        let network = network(nodes);
        let problem = problem(&network);
        let planner = GaRoute::new(GaSettings::default());
        group.bench_function(BenchmarkId::from_parameter(nodes), |bencher| {
            bencher.iter(|| call(&planner, &problem, Budget::evaluations(1)));
        });
    }
}

/// Whole calls of the paper's two algorithms under its cost.
fn paper(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("paper");
    group.sample_size(20);
    for nodes in [50, 100] {
        let network = network(nodes);
        let problem = RouteProblem {
            objective: Objective::paper(),
            ..problem(&network)
        };
        let planners: [Box<dyn RoutePlanner>; 2] = [
            Box::new(GaRoute::new(GaSettings::paper())),
            Box::new(IcaRoute::new(IcaSettings::paper())),
        ];
        for planner in &planners {
            group.bench_function(BenchmarkId::new(planner.name(), nodes), |bencher| {
                bencher.iter(|| call(planner, &problem, Budget::to_the_cap()));
            });
        }
    }
}

criterion_group!(benches, memetic, set_up, paper);
criterion_main!(benches);
