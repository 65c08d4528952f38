//! Plans one route: `cargo run --release --example route -- INSTANCE`.

use auv_exact_route::ExactRoute;
use auv_examples::{
    Arguments, Clock, CommandLine, Failure, Operand, Opt, gap_percent, note, print, print_json,
    proven_bound, read_file,
};
use auv_ga_route::{GaRoute, GaSettings};
use auv_graph::{EdgeId, Route, RouteInstance, RouteTotals, TaskName, format};
use auv_ica_route::{IcaRoute, IcaSettings};
use auv_planning::baseline::GreedyRoute;
use auv_planning::timed::{LeftOut, left_out};
use auv_planning::{
    Budget, Objective, PlanError, Planned, Restarts, RoutePlanner, RouteProblem, Run,
    edges_left_out,
};
use auv_report::Table;
use auv_types::Seed;
use auv_verify::verify_route_in_time;
use serde::Serialize;
use std::path::Path;

pub(crate) const COMMAND: CommandLine = CommandLine {
    name: "route",
    about: "Plans the route that earns the most weight within the time available.",
    operands: &[Operand::required(
        "INSTANCE",
        "an auv-route-1 JSON, an OPLib file, a classic orienteering file or one with time windows (OPTW)",
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
        Opt::value(
            "bound-ms",
            "MS",
            "",
            "milliseconds for a proven bound of the weight, after the answer and not in its time (default: none)",
        ),
        Opt::value(
            "decimals",
            "N",
            "",
            "decimals that distances of an OPTW file are cut to (default: 2 if its name begins with pr, else 1)",
        ),
    ],
    notes: "Prints the route, its weight, time and legs. Node indices start at 0. In an OPLib file node k is\n\
            index k - 1; the depot is split, and its copy at the end has index DIMENSION: the route 0 7 4 51\n\
            on 51 nodes is the tour 1 8 5 1. Where ga stalls before its budget it starts again with other seeds, until eight\n\
            starts in a row bring nothing better. The exact planner starts from what ga finds in an eighth of its budget;\n\
            the gap is that of the weight to the proven bound, in percent of the weight. In an OPTW file node 0 is\n\
            the depot and node N + 1 its copy. A route in time has departures, and done: the tasks with their\n\
            starts; left_out says why the others are not done (no_way, window, order, time, weight); without times it lists edges, at most 100. A budget below the quickest way gives the quickest route, with\n\
            its violation, and a note on stderr.\n\n\
            Example: route network.json --planner greedy --budget-ms 100 --json",
};

/// The JSON of an answer.
#[derive(Serialize)]
pub(crate) struct Answer<'a> {
    instance: &'a str,
    planner: &'a str,
    seed: u64,
    route: &'a Route,
    weight: f64,
    time_s: f64,
    tasks: usize,
    violation: f64,
    /// When a route in time leaves its nodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    departures: Option<&'a [f64]>,
    /// The tasks that a route in time does.
    #[serde(skip_serializing_if = "Option::is_none")]
    done: Option<Vec<Done<'a>>>,
    /// The tasks that it does not do; of a route without times the edges, if they are not too many.
    #[serde(skip_serializing_if = "Option::is_none")]
    left_out: Option<Vec<LeftOutTask<'a>>>,
    /// An upper bound of the weight, where the planner proved one.
    #[serde(skip_serializing_if = "Option::is_none")]
    bound: Option<f64>,
    /// What the bound is above the weight, in percent of the weight.
    #[serde(skip_serializing_if = "Option::is_none")]
    gap_percent: Option<f64>,
    elapsed_ms: f64,
    evaluations: u64,
    generations: u64,
    stop: &'a str,
}

/// A task that a route in time does.
#[derive(Serialize)]
struct Done<'a> {
    id: &'a TaskName,
    start_s: f64,
}

/// A task that a route does not do.
#[derive(Serialize)]
struct LeftOutTask<'a> {
    #[serde(flatten)]
    task: LeftOutPlace<'a>,
    why: LeftOut,
}

#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum LeftOutPlace<'a> {
    /// A task of a route in time.
    Id(&'a TaskName),
    /// An edge's own task.
    Edge(u32),
}

/// Starts of ga in a row without a better route after which it ends before its budget.
const RESTARTS: u32 = 8;
/// The same before a proof: fewer, for the time is the proof's.
const RESTARTS_OF_PROOF: u32 = 2;
/// Most edges left out that are listed.
const MOST_LISTED: usize = 100;

fn main() -> std::process::ExitCode {
    COMMAND.run(|arguments| {
        let solved = plan(arguments)?;
        if arguments.json() {
            print_json(&solved.answer())
        } else {
            print(&solved.text())
        }
    })
}

/// A route with what is printed of it.
pub(crate) struct Solved {
    instance: RouteInstance,
    planner: Box<dyn RoutePlanner>,
    seed: Seed,
    planned: Planned<Route>,
    totals: RouteTotals,
    elapsed_ms: f64,
}

pub(crate) fn plan(arguments: &Arguments) -> Result<Solved, Failure> {
    let path = arguments.operand("INSTANCE").unwrap_or_default();
    let instance = read_instance(arguments, path)?;
    let is_paper = arguments.text("preset") == Some("paper");
    let planner = planner(arguments, is_paper)?;
    let is_exact = planner.name() == "exact";
    // The exact planner ends by itself.
    let budget = arguments.budget(!is_paper && !is_exact)?;
    let seed = arguments.seed()?;

    let clock = Clock::start();
    let ends = (instance.start, instance.destination);
    let mut problem = RouteProblem::new(&instance.network, ends.0, ends.1, instance.budget_s);
    problem.time_model = instance.time_model.as_ref();
    if is_paper && !is_exact {
        problem.objective = Objective::paper();
    }
    let failed = |error| Failure::planning(path, &error);
    let planned = if is_exact {
        let ga = GaRoute::default().with_workers(arguments.workers()?);
        let ga = Restarts::new(ga, RESTARTS_OF_PROOF);
        prove(&*planner, &ga, (seed, budget, &clock), &problem)
    } else {
        planner.plan_route(
            &mut Run::started_at(seed, budget, clock.started()),
            &problem,
        )
    };
    let mut planned = planned.map_err(failed)?;
    let elapsed_ms = clock.elapsed_ms();
    if let Some(more) = arguments.bound_time()? {
        planned.bound = proven_bound(&planned, &problem, (seed, more)).map_err(failed)?;
    }

    let totals = totals(&problem, &planned, planner.name())?;
    note_oddities(path, &instance, &planned, &totals);
    Ok(Solved {
        instance,
        planner,
        seed,
        planned,
        totals,
        elapsed_ms,
    })
}

/// The instance of a file; what is left out of it is noted.
fn read_instance(arguments: &Arguments, path: &str) -> Result<RouteInstance, Failure> {
    let name = Path::new(path)
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    let bytes = read_file(path, format::MAX_FILE_BYTES)?;
    let decimals = arguments.number("decimals")?;
    let instance = format::read_with_decimals(&bytes, &name, decimals)
        .map_err(|error| Failure::file(path, error))?;
    let num_nodes = instance.network.num_nodes();
    if !bytes.trim_ascii_start().starts_with(b"{")
        && let Some(nearest) = format::nearest_kept(num_nodes)
    {
        note(&format!(
            "{path}: each of the {num_nodes} nodes keeps the edges to at most {nearest} near neighbours and to the \
             ends of the route; the others are left out"
        ));
    }
    Ok(instance)
}

/// Notes what a user may not have meant: a route that goes nowhere, too little time.
fn note_oddities(
    path: &str,
    instance: &RouteInstance,
    planned: &Planned<Route>,
    totals: &RouteTotals,
) {
    if planned.best.nodes().len() < 2 {
        note(&format!(
            "{path}: start and goal are both node {}, the route goes nowhere: give another goal, for a round trip a \
             second node at the same place",
            instance.start.0
        ));
    }
    if planned.violation > 0.0 && totals.time_s > instance.budget_s {
        let shortfall_s = totals.time_s - instance.budget_s;
        note(&format!(
            "{path}: the quickest route takes {} s, {shortfall_s} s more than the budget of {} s: \
             give more time",
            totals.time_s, instance.budget_s
        ));
    }
}

/// The exact planner's answer with the GA's as incumbent, which an eighth of the budget is for.
fn prove(
    exact: &dyn RoutePlanner,
    ga: &dyn RoutePlanner,
    (seed, budget, clock): (Seed, Budget, &Clock),
    problem: &RouteProblem<'_>,
) -> Result<Planned<Route>, PlanError> {
    // Enough for a good route, on networks of hundreds of nodes for some starts: more would delay the proof.
    let most = 2_400 * problem.network.num_nodes() as u64;
    let first = Budget {
        evaluations: Some(budget.evaluations.map_or(most, |all| most.min(all / 8))),
        wall_time: budget.wall_time.map(|all| all / 8),
        target_cost: None,
    };
    let mut run = Run::started_at(seed, first, clock.started());
    let known = ga.plan_route(&mut run, problem)?;
    let spent = known.stats.evaluations;
    let rest = Budget {
        evaluations: budget.evaluations.map(|all| all - spent),
        ..budget
    };
    let problem = RouteProblem {
        incumbent: Some(&known.best),
        ..*problem
    };
    let mut run = Run::started_at(seed, rest, clock.started());
    let mut planned = exact.plan_route(&mut run, &problem)?;
    planned.stats.evaluations += spent;
    Ok(planned)
}

/// The sums of a route, added up again.
fn totals(
    problem: &RouteProblem<'_>,
    planned: &Planned<Route>,
    planner: &str,
) -> Result<RouteTotals, Failure> {
    let Some(schedule) = &planned.schedule else {
        let totals = problem
            .network
            .evaluate(&planned.best, problem.removed, problem.times);
        return totals
            .map_err(|error| Failure::Internal(format!("{planner} gave no route: {error}")));
    };
    let (report, broken) = verify_route_in_time(problem, &planned.best, schedule);
    match broken.first() {
        Some(broken) if planned.violation <= 0.0 => Err(Failure::Internal(format!(
            "{planner} gave no route in time: {broken}"
        ))),
        _ => Ok(RouteTotals {
            weight: report.weight,
            time_s: report.time_s,
            distance_m: report.distance_m,
            tasks: report.tasks,
            ..RouteTotals::default()
        }),
    }
}

fn planner(arguments: &Arguments, is_paper: bool) -> Result<Box<dyn RoutePlanner>, Failure> {
    // Greedy and exact use one thread, but a wrong number is bad input for them too.
    arguments.threads()?;
    Ok(match arguments.text("planner") {
        Some("exact") => Box::new(ExactRoute::default()),
        Some("greedy") => Box::new(GreedyRoute),
        Some("ica") => {
            let settings = if is_paper {
                IcaSettings::paper()
            } else {
                IcaSettings::default()
            };
            Box::new(IcaRoute::new(settings).with_workers(arguments.workers()?))
        }
        _ if is_paper => {
            Box::new(GaRoute::new(GaSettings::paper()).with_workers(arguments.workers()?))
        }
        _ => {
            let ga = GaRoute::default().with_workers(arguments.workers()?);
            Box::new(Restarts::new(ga, RESTARTS))
        }
    })
}

impl Solved {
    /// What the proven bound is above the weight, in percent of the weight.
    fn gap_percent(&self) -> Option<f64> {
        gap_percent(-self.planned.bound?, self.totals.weight)
    }

    pub(crate) fn answer(&self) -> Answer<'_> {
        Answer {
            instance: &self.instance.name,
            planner: self.planner.name(),
            seed: self.seed.0,
            route: &self.planned.best,
            weight: self.totals.weight,
            time_s: self.totals.time_s,
            tasks: self.totals.tasks,
            violation: self.planned.violation,
            departures: self
                .planned
                .schedule
                .as_ref()
                .map(|times| &times.departures_s[..]),
            done: self.done(),
            left_out: self.left_out(),
            bound: self.planned.bound.map(|cost| -cost),
            gap_percent: self.gap_percent(),
            elapsed_ms: self.elapsed_ms,
            evaluations: self.planned.stats.evaluations,
            generations: self.planned.stats.generations,
            stop: self.planned.stats.stop.as_str(),
        }
    }

    fn done(&self) -> Option<Vec<Done<'_>>> {
        let (times, model) = (
            self.planned.schedule.as_ref()?,
            self.instance.time_model.as_ref()?,
        );
        let done = times.done.iter().map(|done| Done {
            id: &model.tasks[done.task].name,
            start_s: done.start_s,
        });
        Some(done.collect())
    }

    fn left_out(&self) -> Option<Vec<LeftOutTask<'_>>> {
        let instance = &self.instance;
        let mut problem = RouteProblem::new(
            &instance.network,
            instance.start,
            instance.destination,
            instance.budget_s,
        );
        let Some(model) = &instance.time_model else {
            let edges = edges_left_out(&problem, &self.planned.best).into_iter();
            let edge = |(edge, why): (EdgeId, LeftOut)| LeftOutTask {
                task: LeftOutPlace::Edge(edge.0),
                why,
            };
            return Some(edges.map(edge).collect())
                .filter(|list: &Vec<_>| list.len() <= MOST_LISTED);
        };
        problem.time_model = Some(model);
        let left_out = left_out(&problem, model, self.planned.schedule.as_ref()?);
        let task = |(task, why): (usize, LeftOut)| LeftOutTask {
            task: LeftOutPlace::Id(&model.tasks[task].name),
            why,
        };
        Some(left_out.into_iter().map(task).collect())
    }

    fn text(&self) -> String {
        let Self {
            planned, totals, ..
        } = self;
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
            name = self.instance.name,
            n = self.instance.network.num_nodes(),
            m = self.instance.network.num_edges(),
            budget = self.instance.budget_s,
            route = nodes.join(" "),
            weight = totals.weight,
            time = totals.time_s,
            tasks = totals.tasks,
            violation = planned.violation,
            planner = self.planner.name(),
            elapsed_ms = self.elapsed_ms,
            evaluations = planned.stats.evaluations,
            stop = planned.stats.stop.as_str(),
            legs = self.legs(),
        )
    }

    fn legs(&self) -> Table {
        let network = &self.instance.network;
        let mut table = Table::new(["leg", "weight", "length (m)", "time (s)", "elapsed (s)"]);
        let mut elapsed_s = 0.0;
        for (from, to) in self.planned.best.legs() {
            let Some(id) = network.arc_between(from, to) else {
                continue;
            };
            let arc = &network.arcs()[id.index()];
            elapsed_s += arc.time_s;
            table.row([
                format!("{} - {}", from.0, to.0),
                format!("{:.4}", arc.weight),
                format!("{:.1}", arc.distance_m),
                format!("{:.1}", arc.time_s),
                format!("{elapsed_s:.1}"),
            ]);
        }
        table
    }
}
