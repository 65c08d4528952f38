//! Fixed-seed answers of both genetic algorithms, compared with the files in `golden/`.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use auv_ga_route::{Decoding, EvolutionSettings, GaRoute, GaSettings, InvalidOffspring};
use auv_graph::{EdgeId, EdgeSet, Network, RouteInstance, Terrain, Topology};
use auv_planning::{Budget, Objective, RouteCost, RoutePlanner, RouteProblem, Run, TaskCost};
use auv_population::Workers;
use auv_types::Seed;
use serde_json::{Value, json};

/// What one planning call answers; one and two threads must answer the same.
fn answer(
    settings: &GaSettings,
    problem: &RouteProblem<'_>,
    (seed, budget): (u64, Budget),
) -> Value {
    let [one, two] = [1, 2].map(|threads| {
        let planner = GaRoute::new(settings.clone()).with_workers(Workers::new(threads).unwrap());
        let mut run = Run::new(Seed(seed), budget);
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
    RouteProblem::new(&instance.network, start, destination, instance.budget_s)
}

/// Every arc 1.1 times as slow as it was, every seventh blocked.
fn slower(network: &Network) -> Vec<f64> {
    let arcs = network.arcs().iter().enumerate();
    arcs.map(|(i, arc)| match i % 7 {
        3 => f64::INFINITY,
        _ => arc.time_s * 1.1,
    })
    .collect()
}

/// Networks of the paper's sizes, a sparse one, a directed one, and one of several hundred nodes.
fn instances() -> [(&'static str, RouteInstance, u64); 5] {
    let sparse = Terrain {
        budget_s: 20_000.0,
        ..Terrain::benchmark(90, 420)
    };
    let directed = Terrain {
        topology: Topology::Directed,
        ..Terrain::benchmark(70, 3_000)
    };
    let large = Terrain {
        budget_s: 60_000.0,
        ..Terrain::benchmark(260, 20_000)
    };
    [
        ("figure12", Terrain::figure12(), 5_000),
        ("table2", Terrain::table2(), 5_000),
        ("sparse", sparse, 5_000),
        ("directed", directed, 5_000),
        ("large", large, 3_000),
    ]
    .map(|(name, terrain, evaluations)| (name, terrain.draw(Seed(1)).unwrap(), evaluations))
}

/// Answers on all instances, after few and after many evaluations, in a changed network and from
/// an incumbent.
fn answers(settings: &GaSettings) -> Value {
    let mut answers = serde_json::Map::new();
    for (name, instance, evaluations) in instances() {
        let problem = problem(&instance);
        let network = &instance.network;
        let mut record = |what: &str, problem: &RouteProblem<'_>, evaluations: u64| {
            let budget = Budget::evaluations(evaluations);
            answers.insert(
                format!("{name}_{what}"),
                answer(settings, problem, (7, budget)),
            );
        };
        record("short", &problem, 177);
        record("long", &problem, evaluations);
        if name == "large" {
            continue;
        }
        let times = slower(network);
        let removed: EdgeSet = (0..network.num_edges() as u32 / 5)
            .map(|i| EdgeId(5 * i))
            .collect();
        let changed = RouteProblem {
            times: Some(&times),
            removed: &removed,
            ..problem
        };
        record("changed", &changed, 1_000);
        let quickest = problem.quickest().unwrap().0;
        let warm = RouteProblem {
            objective: Objective::paper(),
            incumbent: Some(&quickest),
            ..problem
        };
        record("warm", &warm, 1_000);
    }
    Value::Object(answers)
}

#[test]
fn the_papers_algorithm_answers_as_recorded() {
    let golden = answers(&GaSettings::paper());
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), "paper", &golden).unwrap();
}

#[test]
fn the_memetic_algorithm_answers_as_recorded() {
    let golden = answers(&GaSettings::default());
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), "memetic", &golden).unwrap();
}

#[test]
fn runs_to_the_cap_and_other_settings_answer_as_recorded() {
    let instance = Terrain::figure12().draw(Seed(2)).unwrap();
    let most_weight = problem(&instance);
    let paper = RouteProblem {
        objective: Objective::paper(),
        ..most_weight
    };
    let ratio = RouteProblem {
        objective: Objective::RouteCost(RouteCost {
            task: TaskCost::RatioOfSums,
            ..RouteCost::paper()
        }),
        ..most_weight
    };
    let to_the_cap = (3, Budget::to_the_cap());
    let repaired = GaSettings::Evolution(EvolutionSettings {
        initialisation: Decoding::Plain,
        invalid_offspring: InvalidOffspring::Repair,
        ..EvolutionSettings::paper()
    });
    let golden = json!({
        "paper_to_the_cap": answer(&GaSettings::paper(), &paper, to_the_cap),
        "memetic_to_the_cap": answer(&GaSettings::default(), &most_weight, to_the_cap),
        "memetic_paper_cost": answer(&GaSettings::default(), &paper, to_the_cap),
        "memetic_ratio_of_sums": answer(&GaSettings::default(), &ratio, to_the_cap),
        "plain_and_repaired": answer(&repaired, &most_weight, (3, Budget::evaluations(4_000))),
    });
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), "other", &golden).unwrap();
}
