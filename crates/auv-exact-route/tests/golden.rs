//! Fixed answers, compared with the files in `golden/`.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use auv_exact_route::{ExactRoute, ExactSettings};
use auv_graph::{EdgeId, EdgeSet, RouteInstance, Terrain};
use auv_planning::{Budget, RoutePlanner, RouteProblem, Run};
use auv_types::Seed;
use serde_json::{Value, json};

fn answer(problem: &RouteProblem<'_>, settings: &ExactSettings, budget: Budget) -> Value {
    let mut run = Run::new(Seed(7), budget);
    let planner = ExactRoute::new(settings.clone());
    let planned = planner.plan_route(&mut run, problem).unwrap();
    let totals = problem
        .network
        .evaluate(&planned.best, problem.removed, problem.times)
        .unwrap();
    let nodes: Vec<u32> = planned.best.nodes().iter().map(|node| node.0).collect();
    json!({
        "route": nodes.iter().map(u32::to_string).collect::<Vec<_>>().join(" "),
        "weight": totals.weight,
        "time_s": totals.time_s,
        "cost": planned.cost,
        "violation": planned.violation,
        "bound": planned.bound,
        "evaluations": planned.stats.evaluations,
        "generations": planned.stats.generations,
        "stop": planned.stats.stop.as_str(),
    })
}

fn problem(instance: &RouteInstance) -> RouteProblem<'_> {
    let (start, destination) = (instance.start, instance.destination);
    RouteProblem::new(&instance.network, start, destination, instance.budget_s)
}

#[test]
fn answers_as_recorded() {
    let draw = |terrain: Terrain| terrain.draw(Seed(1)).unwrap();
    let [small, table2, sparse, long] = [
        draw(Terrain::paper(12, 50)),
        draw(Terrain::table2()),
        draw(Terrain::benchmark(40, 160)),
        draw(Terrain::benchmark(60, 900)),
    ];
    let [small, table2, sparse, long] = [&small, &table2, &sparse, &long].map(problem);
    let tight = RouteProblem {
        time_available_s: 9_000.0,
        ..small
    };
    let late = RouteProblem {
        time_available_s: 100.0,
        ..small
    };
    let removed: EdgeSet = (0..32).map(|i| EdgeId(5 * i)).collect();
    let times: Vec<f64> = (0..)
        .zip(sparse.network.arcs())
        .map(|(i, arc)| match i % 7 {
            3 => f64::INFINITY,
            _ => arc.time_s * 1.1,
        })
        .collect();
    let changed = RouteProblem {
        removed: &removed,
        times: Some(&times),
        ..sparse
    };
    let default = ExactSettings::default();
    let narrow = ExactSettings {
        most_parts: 2,
        ..ExactSettings::default()
    };
    let after = Budget::evaluations;
    let golden = json!({
        "tight": answer(&tight, &default, Budget::to_the_cap()),
        "late": answer(&late, &default, Budget::to_the_cap()),
        "table2": answer(&table2, &default, Budget::to_the_cap()),
        "table2_narrow": answer(&table2, &narrow, Budget::to_the_cap()),
        "sparse_1": answer(&sparse, &default, after(1)),
        "sparse_30000": answer(&sparse, &default, after(30_000)),
        "sparse_changed": answer(&changed, &default, after(60_000)),
        "long_2000": answer(&long, &default, after(2_000)),
        "long_narrow": answer(&long, &narrow, after(2_000)),
    });
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), "answers", &golden).unwrap();
}
