//! E1 to E3: Table 1, Fig. 11 and Fig. 12, the two route planners of the paper.

use crate::output::{Output, Section, internal, spread};
use auv_examples::{Clock, Failure};
use auv_ga_route::{EvolutionSettings, GaRoute, GaSettings};
use auv_graph::Terrain;
use auv_ica_route::{IcaRoute, IcaSettings};
use auv_planning::{Budget, Generation, Objective, RoutePlanner, RouteProblem, Run};
use auv_report::{Axis, Chart, Colour, Dash, Figure, Mark, Style, Table, palette};
use auv_sim::statistics::{BoxStats, mean, median};
use auv_types::Seed;

/// Names and colours of the two algorithms, in the order of Table 1.
const ALGORITHMS: [(&str, Colour); 2] = [("ICA", palette::VERMILLION), ("GA", palette::BLUE)];

/// One planning call.
struct RouteRun {
    cpu_s: f64,
    cost: f64,
    time_s: f64,
    distance_m: f64,
    weight: f64,
    tasks: f64,
    violation: f64,
    /// Best cost and seconds so far, by iteration.
    trace: Vec<(f64, f64)>,
}

fn planner(algorithm: usize) -> Box<dyn RoutePlanner> {
    // All 150 iterations without early stop, so that both algorithms spend the same.
    let evolution = EvolutionSettings {
        uniform_patience: None,
        stall_patience: None,
        ..EvolutionSettings::paper()
    };
    match algorithm {
        0 => Box::new(IcaRoute::new(IcaSettings::paper())),
        _ => Box::new(GaRoute::new(GaSettings::Evolution(evolution))),
    }
}

fn plan(terrain: &Terrain, algorithm: usize, seed: Seed) -> Result<RouteRun, Failure> {
    let instance = terrain.draw(seed.split(0)).map_err(internal)?;
    let mut problem = RouteProblem::new(
        &instance.network,
        instance.start,
        instance.destination,
        instance.budget_s,
    );
    problem.objective = Objective::paper();
    let mut trace = Vec::new();
    let planner = planner(algorithm);
    let clock = Clock::start();
    let mut observer =
        |generation: &Generation<'_>| trace.push((generation.best.cost, clock.elapsed_ms() / 1e3));
    let mut run = Run::new(seed.split(1), Budget::to_the_cap()).with_observer(&mut observer);
    let planned = planner.plan_route(&mut run, &problem).map_err(internal)?;
    let cpu_s = clock.elapsed_ms() / 1e3;
    let totals = instance
        .network
        .evaluate(&planned.best, problem.removed, None)
        .map_err(internal)?;
    Ok(RouteRun {
        cpu_s,
        cost: problem.objective.cost(&totals, instance.budget_s),
        time_s: totals.time_s,
        distance_m: totals.distance_m,
        weight: totals.weight,
        tasks: totals.tasks as f64,
        violation: problem.violation(totals.time_s),
        trace,
    })
}

/// Both algorithms on the same networks: `[algorithm][run]`.
fn both(output: &Output, terrain: &Terrain, runs: usize) -> Result<[Vec<RouteRun>; 2], Failure> {
    let all = output.each(2 * runs, |i| {
        plan(terrain, i % 2, output.seed.split((i / 2) as u64))
    })?;
    let (mut ica, mut ga) = (Vec::new(), Vec::new());
    for (i, planned) in all.into_iter().enumerate() {
        if i % 2 == 0 {
            ica.push(planned)
        } else {
            ga.push(planned)
        }
    }
    Ok([ica, ga])
}

fn values(runs: &[RouteRun], what: impl Fn(&RouteRun) -> f64) -> Vec<f64> {
    runs.iter().map(what).collect()
}

type Value = fn(&RouteRun) -> f64;
/// Best cost and seconds so far at an iteration, and a choice of the two.
type OfTrace = fn(&(f64, f64)) -> f64;
type Metric = (&'static str, Value, usize, [&'static str; 4]);

/// Rows of Table 1 with the published values as printed: ICA50, GA50, ICA100, GA100.
const METRICS: [Metric; 7] = [
    (
        "CPU time (s)",
        |p| p.cpu_s,
        4,
        ["18.4", "9.5", "20.2", "17.53"],
    ),
    (
        "best cost",
        |p| p.cost,
        4,
        ["0.056", "0.034", "0.047", "0.029"],
    ),
    (
        "route time (s)",
        |p| p.time_s,
        0,
        ["22218", "23981", "25212", "23875"],
    ),
    (
        "total distance (m)",
        |p| p.distance_m,
        0,
        ["55329", "61812", "669857", "63417"],
    ),
    ("total weight", |p| p.weight, 1, ["45", "54", "47", "57"]),
    ("number of tasks", |p| p.tasks, 0, ["16", "19", "18", "23"]),
    (
        "violation",
        |p| p.violation,
        4,
        ["0.00", "0.00", "0.0043", "0.00"],
    ),
];

const TERRAINS: [(&str, Terrain); 2] = [
    ("50 nodes, 1197 edges", Terrain::table1_50()),
    ("100 nodes, 4886 edges", Terrain::table1_100()),
];

const CONFIGURATION: &str = "undirected networks drawn for every seed (waypoints U(0, 10000) m by U(0, 10000) m by U(0, 100) m, priorities and \
     risks U(1, 10), tasks U(50, 300) s, 3 m/s), 25200 s available, population 100, 150 iterations, cost of Eq. 19 to 21 with phi1 = 1, phi2 = 0.3; \
     both algorithms on the same networks";

pub(crate) fn table1(output: &Output) -> Result<Vec<Section>, Failure> {
    let mut groups = Vec::new();
    for (_, terrain) in &TERRAINS {
        groups.extend(both(output, terrain, output.runs)?);
    }
    output.draw("table1.svg", &table1_figure(output, &groups))?;
    let mut section = Section::new("Table 1: route planning on 50 and 100 nodes");
    section.show(
        "table1.svg",
        "Table 1 as box plots with the published values",
    );
    section.say(format!(
        "Configuration: {CONFIGURATION}. Paper: one run; ours: median (5 % to 95 %) of {} seeds.",
        output.runs
    ));
    section.table(&table1_rows(&groups));
    section.say("ICA on 100 nodes is printed with 25212 s of 25200 s as \"slightly late\" and violation 0.0043 (the excess is 0.000476), and with distance \
                 669857, which would need 26.6 m/s: read 66985.7.");
    for (k, (name, _)) in TERRAINS.iter().enumerate() {
        compare(&mut section, name, &groups[2 * k], &groups[2 * k + 1]);
    }
    let late: usize = [1, 3]
        .iter()
        .map(|&k: &usize| groups[k].iter().filter(|p| p.violation > 0.0).count())
        .sum();
    section.claim(
        "GA's routes keep the time available",
        late == 0,
        format!("{late} of {} GA routes exceed it", 2 * output.runs),
    );
    let by_size = |k: usize, what: fn(&RouteRun) -> f64| {
        median(&values(&groups[k + 2], what)) / median(&values(&groups[k], what))
    };
    let (growth, dearer) = (by_size(1, |p| p.cpu_s), by_size(1, |p| p.cost));
    section.claim(
        "performance is relatively independent of the size of the graph",
        dearer < 1.25 && growth < 2.5,
        format!("from 50 to 100 nodes GA's median cost becomes {dearer:.2} times, its computing time {growth:.2} times (published: 0.85 and 1.85 times); ICA's {:.2} and {:.2} times (published: 0.84 and 1.10)",
            by_size(0, |p| p.cost), by_size(0, |p| p.cpu_s)),
    );
    Ok(vec![section])
}

fn table1_rows(groups: &[Vec<RouteRun>]) -> Table {
    let mut headings = vec!["metric".to_owned()];
    for nodes in [50, 100] {
        for (name, _) in ALGORITHMS {
            headings.extend([
                format!("{name} {nodes}, paper"),
                format!("{name} {nodes}, ours"),
            ]);
        }
    }
    let mut table = Table::new(headings);
    for (name, by_size) in [
        ("number of edges", ["1197", "4886"]),
        ("available time (s)", ["25200", "25200"]),
    ] {
        let mut row = vec![name.to_owned()];
        row.extend(
            by_size
                .iter()
                .flat_map(|text| [text; 4].map(|text| text.to_string())),
        );
        table.row(row);
    }
    for (name, what, decimals, published) in METRICS {
        let mut row = vec![name.to_owned()];
        for (group, published) in groups.iter().zip(published) {
            row.extend([published.to_owned(), spread(&values(group, what), decimals)]);
        }
        table.row(row);
    }
    let mut row = vec!["feasible".to_owned()];
    for (group, published) in groups.iter().zip(["Yes", "Yes", "Slightly late", "Yes"]) {
        let on_time = group.iter().filter(|p| p.violation <= 0.0).count();
        row.extend([
            published.to_owned(),
            format!("{on_time} of {}", group.len()),
        ]);
    }
    table.row(row);
    table
}

fn table1_figure(output: &Output, groups: &[Vec<RouteRun>]) -> Figure {
    let mut figure = Figure::new(
        "Table 1: routes of two algorithms on two networks",
        &format!(
            "{} seeds each; boxes: quartiles, whiskers 5 to 95 %, cross: mean; diamond: published (one run).",
            output.runs
        ),
    );
    figure.columns = 2;
    for metric in METRICS.into_iter().filter(|m| m.0 != "violation") {
        figure.charts.push(table1_chart(metric, groups));
    }
    figure.notes = vec!["Published CPU times are of MATLAB and off the axis. The published distance 669857 of ICA on 100 nodes would need 26.6 m/s; it is drawn as 66985.7.".into()];
    figure
}

fn table1_chart((name, what, _, published): Metric, groups: &[Vec<RouteRun>]) -> Chart {
    let names = ["ICA 50", "GA 50", "ICA 100", "GA 100"];
    let mut chart = Chart::new(name, Axis::new("").names(names), Axis::new(name), 190.0);
    for (k, group) in groups.iter().enumerate() {
        if let Some(stats) = BoxStats::of(&values(group, what)) {
            chart.add(Mark::Box {
                at: k as f64,
                half_width: 0.26,
                stats,
                colour: ALGORITHMS[k % 2].1,
                legend: String::new(),
            });
        }
    }
    let printed = published
        .iter()
        .enumerate()
        .filter_map(|(k, text)| Some((k as f64, text.parse().ok()?)));
    // 669857 m would need 26.6 m/s: the table prints it, the figure shows the likely 66985.7 m.
    let drawn = printed.map(|(k, value): (f64, f64)| {
        (
            k,
            if value > 600_000.0 {
                value / 10.0
            } else {
                value
            },
        )
    });
    // The published times are hundreds of times longer; on their axis ours would be one line.
    if name == "CPU time (s)" {
        chart.title = "CPU time (s), published: 18.4, 9.5, 20.2, 17.53".into();
    } else {
        chart.add(Mark::published(drawn.collect(), "published"));
    }
    chart
}

/// The claims about one network: GA against ICA.
fn compare(section: &mut Section, name: &str, ica: &[RouteRun], ga: &[RouteRun]) {
    let wins = |what: fn(&RouteRun) -> f64| {
        ga.iter()
            .zip(ica)
            .filter(|(g, i)| what(g) <= what(i))
            .count()
    };
    let (cost, cpu) = (wins(|p| p.cost), wins(|p| p.cpu_s));
    section.claim(
        &format!("GA finds less cost than ICA ({name})"),
        2 * cost > ga.len(),
        format!(
            "GA's cost is at most ICA's on {cost} of {} networks, medians {:.4} and {:.4}",
            ga.len(),
            median(&values(ga, |p| p.cost)),
            median(&values(ica, |p| p.cost))
        ),
    );
    for (name_of, what) in [
        ("weight", (|p: &RouteRun| p.weight) as fn(&RouteRun) -> f64),
        ("number of tasks", |p| p.tasks),
    ] {
        let (ours, theirs) = (median(&values(ga, what)), median(&values(ica, what)));
        section.claim(
            &format!("GA's routes have the greater {name_of} ({name})"),
            ours > theirs,
            format!(
                "medians {ours:.1} (GA) and {theirs:.1} (ICA){}",
                if ours > theirs {
                    ""
                } else {
                    ": the cost of Eq. 19 to 21 rewards weight, not number, and GA finds fewer tasks that weigh more"
                }
            ),
        );
    }
    section.claim(
        &format!("GA needs less computing time than ICA ({name})"),
        2 * cpu > ga.len(),
        format!(
            "GA is quicker on {cpu} of {} networks, medians {:.4} s and {:.4} s",
            ga.len(),
            median(&values(ga, |p| p.cpu_s)),
            median(&values(ica, |p| p.cpu_s))
        ),
    );
}

/// Best cost and computing time on a network over 150 iterations.
fn convergence_charts(network: &str) -> [Chart; 2] {
    let chart = |what: &str, unit: &str| {
        Chart::new(
            &format!("{what}, {network}"),
            Axis::new("iteration").range(0.0, 155.0),
            Axis::new(unit).from_zero(),
            210.0,
        )
    };
    [
        chart("(a) best cost", "best cost"),
        chart("(b) computing time", "seconds so far"),
    ]
}

pub(crate) fn figure11(output: &Output) -> Result<Vec<Section>, Failure> {
    let mut figure = Figure::new(
        "Fig. 11: cost and computing time over 150 iterations",
        &format!(
            "Median and 5 to 95 % of {} seeds; diamonds: the published final values of Table 1 (times are of MATLAB: not comparable, not drawn).",
            output.runs
        ),
    );
    figure.columns = 2;
    let mut section = Section::new("Fig. 11: convergence of GA and ICA");
    section.show(
        "fig11.svg",
        "Best cost and cumulative computing time by iteration",
    );
    section.say(format!(
        "Configuration: {CONFIGURATION}; {} seeds.",
        output.runs
    ));
    let mut table = Table::new([
        "network",
        "algorithm",
        "cost at 1",
        "at 50",
        "at 150",
        "published at 150",
        "CPU at 150 (s)",
        "published CPU (s)",
    ]);
    for (k, (name, terrain)) in TERRAINS.iter().enumerate() {
        let groups = both(output, terrain, output.runs)?;
        let [mut cost, mut cpu] = convergence_charts(name);
        let mut finals = Vec::new();
        for (a, group) in groups.iter().enumerate() {
            let traces = Traces { group, a };
            traces.draw(&mut cost, |t| t.0);
            traces.draw(&mut cpu, |t| t.1);
            cost.add(published_cost(2 * k + a, a)?);
            let cost_at = |i| median(&traces.column(i, |t| t.0));
            table.row([
                (*name).into(),
                ALGORITHMS[a].0.into(),
                format!("{:.4}", cost_at(0)),
                format!("{:.4}", cost_at(49)),
                format!("{:.4}", cost_at(149)),
                METRICS[1].3[2 * k + a].into(),
                format!("{:.4}", median(&traces.column(usize::MAX, |t| t.1))),
                METRICS[0].3[2 * k + a].into(),
            ]);
            finals.push(cost_at(usize::MAX));
        }
        figure.charts.extend([cost, cpu]);
        section.claim(
            &format!("GA's cost falls below ICA's within 150 iterations ({name})"),
            finals[1] < finals[0],
            format!(
                "median best costs {:.4} (GA) and {:.4} (ICA) at iteration 150",
                finals[1], finals[0]
            ),
        );
    }
    output.draw("fig11.svg", &figure)?;
    section.table(&table);
    Ok(vec![section])
}

/// The traces of an algorithm's runs on one network, by iteration.
struct Traces<'a> {
    group: &'a [RouteRun],
    /// Which algorithm of [`ALGORITHMS`].
    a: usize,
}

impl Traces<'_> {
    fn length(&self) -> usize {
        let lengths = self.group.iter().map(|p| p.trace.len());
        lengths.max().unwrap_or(0)
    }

    /// The values at an iteration, or at the last one where there are fewer.
    fn column(&self, i: usize, what: OfTrace) -> Vec<f64> {
        let runs = self.group.iter();
        runs.filter_map(|p| p.trace.get(i).or(p.trace.last()).map(what))
            .collect()
    }

    fn draw(&self, chart: &mut Chart, what: OfTrace) {
        let (algorithm, colour) = ALGORITHMS[self.a];
        let stats: Vec<(f64, BoxStats)> = (0..self.length())
            .filter_map(|i| Some(((i + 1) as f64, BoxStats::of(&self.column(i, what))?)))
            .collect();
        chart.add(Mark::Band {
            points: stats.iter().map(|(x, s)| (*x, s.low, s.high)).collect(),
            style: Style::fill(colour, 0.18),
            legend: String::new(),
        });
        let dash = if self.a == 0 {
            Dash::Dashed
        } else {
            Dash::Solid
        };
        chart.add(Mark::line(
            stats.iter().map(|(x, s)| (*x, s.median)).collect(),
            Style::line(colour, 2.2).dash(dash),
            algorithm,
        ));
    }
}

/// The published final cost, by its column of Table 1.
fn published_cost(column: usize, a: usize) -> Result<Mark, Failure> {
    let (algorithm, colour) = ALGORITHMS[a];
    let published: f64 = METRICS[1].3[column].parse().map_err(internal)?;
    let mut mark = Mark::published(vec![(150.0, published)], &format!("published {algorithm}"));
    if let Mark::Points { style, .. } = &mut mark {
        style.stroke = Some(colour);
    }
    Ok(mark)
}

pub(crate) fn figure12(output: &Output) -> Result<Vec<Section>, Failure> {
    const RUNS: usize = 100;
    let groups = both(output, &Terrain::figure12(), RUNS)?;
    let metrics: [(&str, Value, usize); 4] = [
        ("route time (s)", |p| p.time_s, 0),
        ("CPU time (s)", |p| p.cpu_s, 4),
        ("total weight", |p| p.weight, 1),
        ("total distance (m)", |p| p.distance_m, 0),
    ];
    let mut figure = Figure::new(
        "Fig. 12: 100 random topologies of 20 waypoints",
        "One dot a run, both algorithms on the same topologies; boxes: quartiles, whiskers 5 to 95 %, cross: mean.",
    );
    figure.columns = 2;
    let mut table = Table::new([
        "metric",
        "ICA, ours",
        "GA, ours",
        "ICA: 95 % less 5 %",
        "GA: 95 % less 5 %",
    ]);
    let mut tighter = 0;
    for (name, what, decimals) in metrics {
        let chart = figure12_chart(name, what, &groups);
        let widths: Vec<f64> = groups
            .iter()
            .filter_map(|group| BoxStats::of(&values(group, what)))
            .map(|stats| stats.high - stats.low)
            .collect();
        figure.charts.push(chart);
        tighter += usize::from(widths[1] <= widths[0]);
        table.row([
            name.into(),
            spread(&values(&groups[0], what), decimals),
            spread(&values(&groups[1], what), decimals),
            format!("{:.decimals$}", widths[0]),
            format!("{:.decimals$}", widths[1]),
        ]);
    }
    output.draw("fig12.svg", &figure)?;
    let mut section = Section::new("Fig. 12: stability over 100 random topologies");
    section.show("fig12.svg", "Four metrics over 100 topologies");
    section.say("Configuration: 20 waypoints, 152 of 190 undirected edges (the paper gives no density), 25200 s, population 100, 150 iterations; uniform positions \
                 as everywhere else in the paper (its text calls this topology Gaussian). The paper prints no numbers for this figure. Ours: median (5 % to 95 %).");
    section.table(&table);
    figure12_claims(&mut section, &groups, tighter);
    Ok(vec![section])
}

fn figure12_chart(name: &str, what: Value, groups: &[Vec<RouteRun>]) -> Chart {
    let mut chart = Chart::new(
        name,
        Axis::new("topology").range(-1.0, 118.0),
        Axis::new(name),
        200.0,
    );
    for (a, (algorithm, colour)) in ALGORITHMS.into_iter().enumerate() {
        let values = values(&groups[a], what);
        chart.add(Mark::Points {
            points: values
                .iter()
                .enumerate()
                .map(|(i, v)| (i as f64, *v))
                .collect(),
            shape: if a == 0 {
                auv_report::PointShape::Triangle
            } else {
                auv_report::PointShape::Disc
            },
            size: 2.2,
            style: Style::fill(colour, 0.75),
            legend: algorithm.into(),
        });
        if let Some(stats) = BoxStats::of(&values) {
            chart.add(Mark::Box {
                at: 106.0 + 7.0 * a as f64,
                half_width: 2.6,
                stats,
                colour,
                legend: String::new(),
            });
        }
    }
    if name == "route time (s)" {
        chart.add(Mark::Level {
            value: 25_200.0,
            style: Style::line(palette::BLACK, 1.0).dash(Dash::Dashed),
            label: "25200 s available".into(),
        });
    }
    chart
}

fn figure12_claims(section: &mut Section, groups: &[Vec<RouteRun>], tighter: usize) {
    let (ica, ga) = (
        values(&groups[0], |p| p.weight),
        values(&groups[1], |p| p.weight),
    );
    section.claim(
        "GA is superior to ICA in the weight obtained",
        mean(&ga) >= mean(&ica),
        format!(
            "mean weights {:.2} (GA) and {:.2} (ICA)",
            mean(&ga),
            mean(&ica)
        ),
    );
    section.claim(
        "GA is more consistent: its results spread less",
        tighter >= 3,
        format!("its 5 to 95 % range is the narrower one in {tighter} of 4 metrics"),
    );
    let late = groups[1].iter().filter(|p| p.violation > 0.0).count();
    section.claim(
        "GA meets the time available on every topology",
        late == 0,
        format!("{late} of {} GA routes exceed it", groups[1].len()),
    );
}
