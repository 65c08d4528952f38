//! Threads: the speed-up of a search by a second thread.

use crate::machine::machine;
use crate::{paths, routes};
use auv_examples::{Arguments, Clock, Failure};
use auv_ga_route::{GaRoute, GaSettings, MemeticSettings};
use auv_graph::RouteInstance;
use auv_ica_route::{IcaRoute, IcaSettings};
use auv_planning::{Budget, Objective, PathPlanner, RoutePlanner, RouteProblem, Run};
use auv_population::Workers;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::statistics::{median, quantile};
use auv_types::Seed;
use std::fmt::Write;
use std::path::Path;

/// Repetitions of each search on one thread and on two, alternately: other load on the machine then
/// affects both equally.
const ROUNDS: usize = 61;

/// Evaluations of the memetic search, which does not end by itself.
const MEMETIC_EVALUATIONS: u64 = 20_000;

/// A search with a seed and a thread pool; returns the cost of its plan.
type Search = Box<dyn Fn(Seed, Workers) -> Result<f64, Failure>>;

/// The section: a row for every search.
pub(crate) fn measure(arguments: &Arguments, data: &Path) -> Result<String, Failure> {
    let mut text = format!(
        "Measured on: {}. Each search {ROUNDS} times on one thread and on two in turns; their answers cost the same, to the bit. \
         Milliseconds, median (least); the last column is the median of what the two calls of a turn came to.\n\n\
         | search | one thread | two threads | times as fast |\n|---|--:|--:|--:|\n",
        machine(arguments)?
    );
    let first = arguments.seed()?.0;
    let workers = [1, 2].map(Workers::new);
    let [Ok(one), Ok(two)] = workers else {
        return Err(Failure::Internal("could not start two threads".into()));
    };
    for (name, search) in searches(data)? {
        let mut took_ms = [const { Vec::new() }; 2];
        let mut ratios = Vec::new();
        for round in 0..ROUNDS {
            let (mut pair, mut costs) = ([0.0; 2], [0.0; 2]);
            for (k, workers) in [&one, &two].into_iter().enumerate() {
                let clock = Clock::start();
                costs[k] = search(Seed(first + round as u64), workers.clone())?;
                pair[k] = clock.elapsed_ms();
            }
            if costs[0].total_cmp(&costs[1]).is_ne() {
                return Err(Failure::Internal(format!(
                    "{name}: cost {} on one thread, {} on two",
                    costs[0], costs[1]
                )));
            }
            ratios.push(pair[0] / pair[1]);
            for (all, ms) in took_ms.iter_mut().zip(pair) {
                all.push(ms);
            }
        }
        let [one, two] = took_ms.map(|ms| (median(&ms), quantile(&ms, 0.0)));
        let _ = writeln!(
            text,
            "| {name} | {:.1} ({:.1}) | {:.1} ({:.1}) | {:.2} |",
            one.0,
            one.1,
            two.0,
            two.1,
            median(&ratios),
        );
    }
    Ok(text)
}

/// The searches measured: routes over 100 nodes, and the three of the paper at its sizes.
fn searches(data: &Path) -> Result<Vec<(&'static str, Search)>, Failure> {
    let instance = |name: &str| routes::read(data, &format!("routes/{name}.json"));
    let scene = paths::scene(&data.join("scenes/static-006-1.json"))?;
    let memetic = route(
        instance("auv-100-4886u-T25200-s1")?,
        Objective::default(),
        Budget::evaluations(MEMETIC_EVALUATIONS),
        |workers| {
            let settings = MemeticSettings {
                first_population: 100,
                ..MemeticSettings::default()
            };
            Box::new(GaRoute::new(GaSettings::Memetic(settings)).with_workers(workers))
        },
    );
    let paper = |planner| {
        let instance = instance("auv-50-1197u-T25200-s1")?;
        let cap = Budget::to_the_cap();
        Ok::<_, Failure>(route(instance, Objective::paper(), cap, planner))
    };
    let ga = paper(|workers| Box::new(GaRoute::new(GaSettings::paper()).with_workers(workers)))?;
    let ica = paper(|workers| Box::new(IcaRoute::new(IcaSettings::paper()).with_workers(workers)))?;
    let swarm: Search = Box::new(move |seed, workers| {
        let planner = PsoPath::new(PathSearch::paper()).with_workers(workers);
        let planned =
            planner.plan_path(&mut Run::new(seed, Budget::to_the_cap()), &scene.problem());
        planned
            .map(|planned| planned.cost)
            .map_err(|error| Failure::planning("static-006-1", &error))
    });
    Ok(vec![
        (
            "GA, default, 100 individuals, 100 nodes, 20,000 evaluations",
            memetic,
        ),
        ("GA, `paper()`, 100 x 150, 50 nodes", ga),
        ("ICA, `paper()`, 50 nodes", ica),
        ("PSO, `paper()`, 150 x 100, static-006-1", swarm),
    ])
}

fn route(
    instance: RouteInstance,
    objective: Objective,
    budget: Budget,
    planner: fn(Workers) -> Box<dyn RoutePlanner>,
) -> Search {
    Box::new(move |seed, workers| {
        let ends = (instance.start, instance.destination);
        let problem = RouteProblem {
            objective,
            ..RouteProblem::new(&instance.network, ends.0, ends.1, instance.budget_s)
        };
        let planned = planner(workers).plan_route(&mut Run::new(seed, budget), &problem);
        planned
            .map(|planned| planned.cost)
            .map_err(|error| Failure::planning(&instance.name, &error))
    })
}
