//! E4 and E5: Fig. 13 to 16, the path planner among 3 to 6 obstacles of each kind.

use crate::output::{Output, Section, spread};
use crate::scenario_charts::{boxes, oblique, plan_view};
use crate::swarm_run::{CURRENT_MPS, Chosen, SwarmRun, fly};
use auv_examples::Failure;
use auv_obstacles::truth::LegScenario;
use auv_report::{Figure, Table};
use auv_sim::statistics::{mean, median};

const COUNTS: [usize; 4] = [3, 4, 5, 6];
struct Figured {
    number: u32,
    scenario: LegScenario,
    what: &'static str,
}

pub(crate) fn figures13_to_16(output: &Output) -> Result<Vec<Section>, Failure> {
    [
        Figured {
            number: 13,
            scenario: LegScenario::Fixed,
            what: "scenario 1, static known and uncertain obstacles",
        },
        Figured {
            number: 14,
            scenario: LegScenario::Moving,
            what: "scenario 2, moving obstacles that appear one after another",
        },
        Figured {
            number: 15,
            scenario: LegScenario::Drifting,
            what: "scenario 3, obstacles that drift and grow with the current",
        },
        Figured {
            number: 16,
            scenario: LegScenario::Mixed,
            what: "scenario 4, all classes",
        },
    ]
    .iter()
    .map(|figured| one_figure(output, figured))
    .collect()
}

/// The seed at the third quartile of path length. In most seas the straight line is nearly free, and
/// the pictures would show straight lines only.
fn turned_aside(runs: &[SwarmRun], seeds: usize) -> usize {
    let length_m = |seed: &usize| {
        let of_seed = runs.iter().skip(*seed).step_by(seeds);
        of_seed.map(|run| run.path.length_m()).sum::<f64>()
    };
    let mut by_length: Vec<usize> = (0..seeds).collect();
    by_length.sort_by(|a, b| length_m(a).total_cmp(&length_m(b)));
    by_length.get(3 * seeds / 4).copied().unwrap_or(0)
}

fn one_figure(output: &Output, figured: &Figured) -> Result<Section, Failure> {
    let (number, what) = (figured.number, figured.what);
    let seed = output.seed.split(u64::from(number));
    let runs = output.each(COUNTS.len() * output.runs, |i| {
        fly(
            figured.scenario,
            COUNTS[i / output.runs],
            seed.split((i % output.runs) as u64),
        )
    })?;
    let shown = turned_aside(&runs, output.runs);
    let shown: Vec<&SwarmRun> = runs.iter().skip(shown).step_by(output.runs).collect();

    let mut section = Section::new(&format!("Fig. {number}: {what}"));
    draw_paths(output, &mut section, figured, &shown)?;
    draw_convergence(output, &mut section, figured, &shown)?;
    section.say(format!(
        "Configuration: {CONFIGURATION}; obstacles as the paper draws them (radius |N(0, 100)| m, at least 10 m), current {CURRENT_MPS} m/s, movers up to 0.5 m/s; \
         {} seeds a count, each with its own obstacles and swarm. The paper prints no numbers for this figure.",
        output.runs
    ));
    let mut table = Table::new(HEADINGS);
    let mut found = Found::default();
    for (k, count) in COUNTS.into_iter().enumerate() {
        let runs = &runs[k * output.runs..(k + 1) * output.runs];
        table.row(found.count(count, runs));
    }
    section.table(&table);
    found.claims(&mut section, number, &runs);
    Ok(section)
}

const CONFIGURATION: &str = "leg (0, 0, 20) to (3000, 1500, 60) m (north, east, depth), 3 m/s, 150 particles, 100 iterations, 8 control points, K = 4, c1 2.5 to 2.0 \
         and c2 2.0 to 2.5 constricted";

const HEADINGS: [&str; 8] = [
    "obstacles",
    "runs without violation",
    "path length (m)",
    "cost",
    "mean cost of the swarm at 100 / its best",
    "mean violation at 1",
    "mean violation at 100",
    "CPU (s)",
];

fn draw_paths(
    output: &Output,
    section: &mut Section,
    figured: &Figured,
    shown: &[&SwarmRun],
) -> Result<(), Failure> {
    let (number, what) = (figured.number, figured.what);
    let mut paths = Figure::new(
        &format!("Fig. {number}(a): {what}"),
        "The best path of one run for 3 to 6 obstacles: the seed with longer paths than three of four.",
    );
    paths.columns = 2;
    for (run, count) in shown.iter().zip(COUNTS) {
        paths.charts.push(plan_view(run, count));
    }
    paths.notes = vec![
        "Filled: as the planner was told the obstacle is when the vehicle comes closest. Dotted: at departure (or when it appears), dashed: at arrival.".into(),
        "Seen from above: a path that crosses a filled disc passes above or below the obstacle.".into(),
    ];
    output.draw(&format!("fig{number}a.svg"), &paths)?;
    section.show(&format!("fig{number}a.svg"), "Paths among 3 to 6 obstacles");
    if let (LegScenario::Mixed, Some(run)) = (figured.scenario, shown.last()) {
        let mut figure = Figure::new(
            "Fig. 16: the path among all classes, in three dimensions",
            "Seen from the south-west and above; depth drawn three times larger. Grey: the path's shadow at the surface.",
        );
        figure.charts.push(oblique(run));
        output.draw("fig16.svg", &figure)?;
        section.show(
            "fig16.svg",
            "A path among six obstacles of all classes in three dimensions",
        );
    }
    Ok(())
}

fn draw_convergence(
    output: &Output,
    section: &mut Section,
    figured: &Figured,
    shown: &[&SwarmRun],
) -> Result<(), Failure> {
    let (number, what) = (figured.number, figured.what);
    let mut convergence = Figure::new(
        &format!("Fig. {number}(b, c): cost and violation of the swarm, {what}"),
        "All 150 particles of the runs above at every fifth iteration: quartiles, whiskers 5 to 95 % (those of the first iteration reach beyond the frame), red cross: mean.",
    );
    convergence.columns = 2;
    for (run, count) in shown.iter().zip(COUNTS) {
        convergence
            .charts
            .push(boxes(&format!("(b) {count} obstacles"), "cost", run, |g| {
                &g.0
            }));
        convergence.charts.push(boxes(
            &format!("(c) {count} obstacles"),
            "violation",
            run,
            |g| &g.1,
        ));
    }
    output.draw(&format!("fig{number}bc.svg"), &convergence)?;
    section.show(
        &format!("fig{number}bc.svg"),
        "Cost and violation of the swarm by iteration",
    );
    Ok(())
}

/// Counts over all runs of a figure.
#[derive(Default)]
struct Found {
    /// Runs without violation.
    clear: usize,
    /// Runs whose mean cost ends within 5 % of the swarm's best.
    settled: usize,
    /// Runs whose mean violation ends at most at 0.001.
    emptied: usize,
    /// Median costs by number of obstacles.
    medians: Vec<f64>,
}

/// The mean over all particles at an iteration; NaN without one.
fn mean_of(iteration: Option<&(Vec<f64>, Vec<f64>)>, what: Chosen) -> f64 {
    iteration.map_or(f64::NAN, |iteration| mean(what(iteration)))
}

impl Found {
    /// Counts the runs with `count` obstacles and returns their row of the table.
    fn count(&mut self, count: usize, runs: &[SwarmRun]) -> [String; 8] {
        let of = |what: fn(&SwarmRun) -> f64| runs.iter().map(what).collect::<Vec<f64>>();
        let free = runs.iter().filter(|r| r.violation <= 0.0).count();
        let ratio = of(|r| {
            let best = r.history.last().map_or(f64::NAN, |g| {
                g.0.iter().copied().fold(f64::INFINITY, f64::min)
            });
            mean_of(r.history.last(), |g| &g.0) / best
        });
        let ends = of(|r| mean_of(r.history.last(), |g| &g.1));
        let costs = of(|r| r.cost);
        self.clear += free;
        self.settled += ratio.iter().filter(|x| **x <= 1.05).count();
        self.emptied += ends.iter().filter(|x| **x <= 1e-3).count();
        self.medians.push(median(&costs));
        [
            count.to_string(),
            format!("{free} of {}", runs.len()),
            spread(&of(|r| r.path.length_m()), 1),
            spread(&costs, 4),
            spread(&ratio, 3),
            spread(&of(|r| mean_of(r.history.first(), |g| &g.1)), 4),
            spread(&ends, 4),
            spread(&of(|r| r.cpu_s), 4),
        ]
    }

    fn claims(&self, section: &mut Section, number: u32, runs: &[SwarmRun]) {
        let Self {
            clear,
            settled,
            emptied,
            ref medians,
        } = *self;
        let all = runs.len();
        section.claim(
            &format!("the path is free of collisions (Fig. {number})"),
            clear == all,
            if clear == all {
                format!("{clear} of {all} runs end without violation")
            } else {
                let covered = runs.iter().filter(|r| r.violation > 0.0 && r.end_covered());
                format!(
                    "{clear} of {all} runs end without violation; runs without a free path, since an obstacle drawn at random covers the target on arrival: {}",
                    covered.count()
                )
            },
        );
        section.claim(
            &format!(
                "the swarm's mean cost converges to the minimum within 100 iterations (Fig. {number})"
            ),
            10 * settled >= 9 * all,
            format!("in {settled} of {all} runs the mean cost ends within 5 % of the swarm's best"),
        );
        section.claim(
            &format!(
                "the swarm's mean violation is eliminated within 100 iterations (Fig. {number})"
            ),
            10 * emptied >= 9 * all,
            format!("in {emptied} of {all} runs it ends at most at 0.001"),
        );
        let growth = medians[3] / medians[0] - 1.0;
        section.claim(
            &format!(
                "performance is almost stable against the number of obstacles (Fig. {number})"
            ),
            growth.abs() < 0.05,
            format!(
                "from 3 to 6 obstacles the median cost changes by {:+.2} %",
                100.0 * growth
            ),
        );
    }
}
