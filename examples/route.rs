//! Plans one route: `cargo run --release --example route -- INSTANCE`.

use auv_exact_route::ExactRoute;
use auv_examples::{
    Clock, Command, Failure, Operand, Opt, Table, note, print, print_json, read_file,
};
use auv_ga_route::{GaRoute, GaSettings};
use auv_graph::{Instance, Route, RouteTotals, format};
use auv_ica_route::{IcaRoute, IcaSettings};
use auv_planning::baseline::GreedyRoute;
use auv_planning::{Objective, Planned, RoutePlanner, RouteProblem, Run};
use serde::Serialize;
use std::path::Path;

const COMMAND: Command = Command {
    name: "route",
    about: "Plans the route that earns the most weight within the time available.",
    operands: &[Operand::required(
        "INSTANCE",
        "an auv-route-1 JSON, an OPLib file or a classic orienteering file",
    )],
    options: &[
        Opt::choice(
            "planner",
            &["ga", "ica", "exact", "greedy"],
            "ga",
            "which planner",
        ),
        Opt::choice(
            "preset",
            &["paper", "default"],
            "default",
            "the settings of ga and ica; paper also minimises the paper's cost",
        ),
        Opt::value(
            "budget-ms",
            "MS",
            "",
            "deadline in milliseconds (default: 100 for preset default; none for paper and exact, which end by themselves)",
        ),
        Opt::value(
            "evaluations",
            "N",
            "",
            "most evaluations, exact and reproducible (default: no limit)",
        ),
    ],
    notes: "Prints the route, its weight, time and legs. Node indices start at 0. In an OPLib file node k is\n\
            index k - 1; the depot is split, and its copy at the end has index DIMENSION: the route 0 7 4 51\n\
            on 51 nodes is the tour 1 8 5 1. A budget below the quickest way gives the quickest route, with\n\
            its violation, and a note on stderr.\n\n\
            Example: route network.json --planner greedy --budget-ms 100 --json",
};

/// The JSON of an answer.
#[derive(Serialize)]
struct Answer<'a> {
    instance: &'a str,
    planner: &'a str,
    seed: u64,
    route: &'a Route,
    weight: f64,
    time_s: f64,
    tasks: usize,
    violation: f64,
    /// An upper bound of the weight, where the planner proved one.
    #[serde(skip_serializing_if = "Option::is_none")]
    bound: Option<f64>,
    elapsed_ms: f64,
    evaluations: u64,
    generations: u64,
    stop: &'a str,
}

fn main() -> std::process::ExitCode {
    COMMAND.run(|arguments| {
        let path = arguments.operand("INSTANCE").unwrap_or_default();
        let name = Path::new(path).file_stem().unwrap_or_default().to_string_lossy();
        let bytes = read_file(path, format::MAX_FILE_BYTES)?;
        let instance = format::read(&bytes, &name).map_err(|error| Failure::file(path, error))?;
        let is_paper = arguments.text("preset") == Some("paper");
        let settings = if is_paper { GaSettings::paper() } else { GaSettings::default() };
        let planner: Box<dyn RoutePlanner> = match arguments.text("planner") {
            Some("exact") => Box::new(ExactRoute::default()),
            Some("greedy") => Box::new(GreedyRoute),
            Some("ica") => {
                let settings = if is_paper { IcaSettings::paper() } else { IcaSettings::default() };
                Box::new(IcaRoute::new(settings).with_workers(arguments.workers()?))
            }
            _ => Box::new(GaRoute::new(settings).with_workers(arguments.workers()?)),
        };
        // Greedy and exact use one thread; a wrong number is bad input all the same.
        arguments.threads()?;
        // A proof takes the time it takes.
        let proves = arguments.text("planner") == Some("exact");
        let at_ease = arguments.text("preset") == Some("default");
        let budget = arguments.budget(at_ease && !proves)?;
        let seed = arguments.seed()?;

        let clock = Clock::start();
        let ends = (instance.start, instance.destination);
        let mut problem = RouteProblem::new(&instance.network, ends.0, ends.1, instance.budget_s);
        if is_paper && planner.name() != "exact" {
            problem.objective = Objective::paper();
        }
        let mut run = Run::started_at(seed, budget, clock.started());
        let planned = planner
            .plan_route(&mut run, &problem)
            .map_err(|error| Failure::planning(path, &error))?;
        let elapsed_ms = clock.elapsed_ms();

        let totals = instance
            .network
            .evaluate(&planned.best, problem.removed, problem.times)
            .map_err(|error| Failure::Internal(format!("{} gave no route: {error}", planner.name())))?;
        if totals.time_s > instance.budget_s {
            let shortfall_s = totals.time_s - instance.budget_s;
            note(&format!(
                "{path}: the quickest route takes {} s, {shortfall_s} s more than the budget of {} s: \
                 give more time",
                totals.time_s, instance.budget_s
            ));
        }
        if !arguments.json() {
            return print(&text(&instance, planner.as_ref(), &planned, &totals, elapsed_ms));
        }
        print_json(&Answer {
            instance: &instance.name,
            planner: planner.name(),
            seed: seed.0,
            route: &planned.best,
            weight: totals.weight,
            time_s: totals.time_s,
            tasks: totals.tasks,
            violation: planned.violation,
            bound: planned.bound.map(|cost| -cost),
            elapsed_ms,
            evaluations: planned.stats.evaluations,
            generations: planned.stats.generations,
            stop: planned.stats.stop.as_str(),
        })
    })
}

fn text(
    instance: &Instance,
    planner: &dyn RoutePlanner,
    planned: &Planned<Route>,
    totals: &RouteTotals,
    elapsed_ms: f64,
) -> String {
    let network = &instance.network;
    let mut legs = Table::new(&["leg", "weight", "length (m)", "time (s)", "elapsed (s)"]);
    let mut elapsed_s = 0.0;
    for (from, to) in planned.best.legs() {
        let Some(id) = network.arc_between(from, to) else {
            continue;
        };
        let arc = &network.arcs()[id.index()];
        elapsed_s += arc.time_s;
        legs.row([
            format!("{} - {}", from.0, to.0),
            format!("{:.4}", arc.weight),
            format!("{:.1}", arc.distance_m),
            format!("{:.1}", arc.time_s),
            format!("{elapsed_s:.1}"),
        ]);
    }
    let nodes: Vec<_> = planned
        .best
        .nodes()
        .iter()
        .map(|node| node.0.to_string())
        .collect();
    let bound = planned.bound.map_or(String::new(), |cost| {
        format!(", proven to be at most {:.6}", -cost)
    });
    format!(
        "{name}: {n} nodes, {m} edges, {budget} s available\n\nroute      {route}\n\
         weight     {weight:.6}{bound}\ntime       {time:.3} s of {budget} s\ntasks      {tasks}\n\
         violation  {violation}\nplanner    {planner}, {elapsed_ms:.1} ms, {evaluations} evaluations, {stop}\n\n{legs}",
        name = instance.name,
        n = network.num_nodes(),
        m = network.num_edges(),
        budget = instance.budget_s,
        route = nodes.join(" "),
        weight = totals.weight,
        time = totals.time_s,
        tasks = totals.tasks,
        violation = planned.violation,
        planner = planner.name(),
        evaluations = planned.stats.evaluations,
        stop = planned.stats.stop.as_str(),
    )
}
