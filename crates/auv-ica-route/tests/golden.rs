//! Fixed-seed answers, compared with the files in `golden/`.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use auv_graph::{EdgeId, EdgeSet, RouteInstance, Terrain};
use auv_ica_route::{Decoding, IcaRoute, IcaSettings, RouteRanking};
use auv_planning::{Budget, Objective, RoutePlanner, RouteProblem, Run};
use auv_population::Workers;
use auv_types::Seed;
use serde_json::{Value, json};

/// What one planning call answers; one and two threads must answer the same.
fn answer(settings: &IcaSettings, problem: &RouteProblem<'_>, budget: Budget) -> Value {
    let [one, two] = [1, 2].map(|threads| {
        let planner = IcaRoute::new(settings.clone()).with_workers(Workers::new(threads).unwrap());
        let mut run = Run::new(Seed(7), budget);
        planner.plan_route(&mut run, problem).unwrap()
    });
    assert_eq!(one, two, "one and two threads");
    let totals = problem
        .network
        .evaluate(&one.best, problem.removed, problem.times)
        .unwrap();
    let nodes: Vec<u32> = one.best.nodes().iter().map(|node| node.0).collect();
    json!({
        "route": nodes.iter().map(u32::to_string).collect::<Vec<_>>().join(" "),
        "weight": totals.weight,
        "time_s": totals.time_s,
        "cost": one.cost,
        "violation": one.violation,
        "evaluations": one.stats.evaluations,
        "generations": one.stats.generations,
        "stop": one.stats.stop.as_str(),
    })
}

fn problem(instance: &RouteInstance) -> RouteProblem<'_> {
    let (start, destination) = (instance.start, instance.destination);
    RouteProblem {
        objective: Objective::paper(),
        ..RouteProblem::new(&instance.network, start, destination, instance.budget_s)
    }
}

#[test]
fn answers_as_recorded() {
    let figure12 = Terrain::figure12().draw(Seed(1)).unwrap();
    let table2 = Terrain::table2().draw(Seed(1)).unwrap();
    let sparse = Terrain::benchmark(60, 300).draw(Seed(1)).unwrap();
    let figure12 = problem(&figure12);
    let table2 = problem(&table2);
    let sparse = problem(&sparse);
    let removed: EdgeSet = (0..60).map(|i| EdgeId(5 * i)).collect();
    let times: Vec<f64> = (0..)
        .zip(sparse.network.arcs())
        .map(|(i, arc)| match i % 7 {
            3 => f64::INFINITY,
            _ => arc.time_s * 1.1,
        })
        .collect();
    let changed = RouteProblem {
        objective: Objective::MostWeight,
        removed: &removed,
        times: Some(&times),
        ..sparse
    };
    let paper = IcaSettings::paper();
    let plain = IcaSettings {
        decoding: Decoding::Plain,
        ranking: RouteRanking::Cost,
        uniting_distance: Some(0.2),
        ..IcaSettings::paper()
    };
    let golden = json!({
        "figure12_short": answer(&paper, &figure12, Budget::evaluations(177)),
        "figure12_to_the_cap": answer(&paper, &figure12, Budget::to_the_cap()),
        "table2": answer(&paper, &table2, Budget::evaluations(5_000)),
        "sparse": answer(&paper, &sparse, Budget::evaluations(5_000)),
        "sparse_changed": answer(&paper, &changed, Budget::evaluations(5_000)),
        "plain_and_uniting": answer(&plain, &figure12, Budget::evaluations(5_000)),
    });
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), "paper", &golden).unwrap();
}
