//! E4 and E5: Fig. 13 to 16, the path planner among 3 to 6 obstacles of each kind.

use crate::output::{Output, Section, internal, spread};
use crate::scenario_charts::{boxes, oblique, plan_view};
use auv_examples::{Clock, Failure};
use auv_obstacles::truth::{Birth, LegObstacles, LegScenario, Obstacle, ObstacleClass};
use auv_obstacles::{ObstacleId, Region};
use auv_planning::{Budget, Generation, PathPlanner, PathProblem, Run, Trajectory, Vehicle};
use auv_pso_path::{PathSearch, PsoPath};
use auv_report::{Figure, Table};
use auv_sim::statistics::{mean, median};
use auv_types::{Bounds, Point3, Seed, Vector3, libm};

const COUNTS: [usize; 4] = [3, 4, 5, 6];
/// The current of class 4, m/s: the paper's spread of 0.3 m/s, towards the north-east.
const CURRENT_MPS: f64 = 0.3;

struct Figured {
    number: u32,
    scenario: LegScenario,
    what: &'static str,
}

impl Flown {
    /// Whether the target lies within an obstacle when the path arrives there.
    fn end_covered(&self) -> bool {
        let at_s = self.path.end().time_s;
        self.regions
            .iter()
            .any(|region| (region.centre_at(at_s) - ends().1).norm() < region.radius_at(at_s))
    }
}

/// Costs and violations of all particles at an iteration.
pub(crate) type Iteration = (Vec<f64>, Vec<f64>);
/// One of the two.
pub(crate) type Chosen = fn(&Iteration) -> &Vec<f64>;

/// One planning call.
pub(crate) struct Flown {
    pub(crate) obstacles: Vec<Obstacle>,
    pub(crate) regions: Vec<Region>,
    pub(crate) path: Trajectory,
    violation: f64,
    cost: f64,
    cpu_s: f64,
    /// Costs and violations of all particles, by iteration.
    pub(crate) history: Vec<Iteration>,
}

pub(crate) fn ends() -> (Point3<f64>, Point3<f64>) {
    (
        Point3::new(0.0, 0.0, 20.0),
        Point3::new(3000.0, 1500.0, 60.0),
    )
}

fn current() -> Vector3<f64> {
    let side = CURRENT_MPS * libm::sqrt(0.5);
    Vector3::new(side, side, 0.0)
}

/// What the planner is told of an obstacle: a region that moves as it does and whose radius grows
/// linearly with time (class 3 by its jitter of 0.1 m/s, class 4 by the current's speed); class 2 at
/// two standard deviations (0.2 r) above its mean.
fn region(i: usize, obstacle: &Obstacle) -> Region {
    let (radius_m, velocity_mps, growth_mps) = match obstacle.class {
        ObstacleClass::Static => (obstacle.radius_m, Vector3::zeros(), 0.0),
        ObstacleClass::Uncertain => (1.4 * obstacle.radius_m, Vector3::zeros(), 0.0),
        ObstacleClass::Moving => (obstacle.radius_m, obstacle.velocity_mps, 0.1),
        ObstacleClass::Drifting => (
            obstacle.radius_m,
            obstacle.velocity_mps + current(),
            CURRENT_MPS,
        ),
    };
    Region {
        obstacle: ObstacleId(i as u32),
        at_s: obstacle.appears_s,
        from_s: obstacle.appears_s,
        velocity_mps,
        growth_mps,
        ..Region::ball(obstacle.centre, radius_m)
    }
}

fn fly(scenario: LegScenario, count: usize, seed: Seed) -> Result<Flown, Failure> {
    let (from, to) = ends();
    let vehicle = Vehicle::paper();
    let drawn = LegObstacles {
        scenario,
        count,
        from,
        to,
        speed_mps: vehicle.speed_mps,
        current_mps: current(),
        birth: Birth::paper(),
    };
    let obstacles = drawn.generate(seed.split(0));
    let regions: Vec<Region> = obstacles
        .iter()
        .enumerate()
        .map(|(i, o)| region(i, o))
        .collect();
    let problem = PathProblem {
        regions: &regions,
        bounds: Some(Bounds::new(
            Point3::new(-1000.0, -1000.0, 0.0),
            Point3::new(4000.0, 2500.0, 1000.0),
        )),
        ..PathProblem::new(from, to, &vehicle)
    };
    let mut history = Vec::new();
    let mut observer = |generation: &Generation<'_>| {
        history.push((generation.costs.to_vec(), generation.violations.to_vec()))
    };
    let clock = Clock::start();
    let mut run = Run::new(seed.split(1), Budget::to_the_cap()).with_observer(&mut observer);
    let planned = PsoPath::new(PathSearch::paper())
        .plan_path(&mut run, &problem)
        .map_err(internal)?;
    let cpu_s = clock.elapsed_ms() / 1e3;
    Ok(Flown {
        path: planned.best,
        violation: planned.violation,
        cost: planned.cost,
        cpu_s,
        history,
        obstacles,
        regions,
    })
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

/// The seed with longer paths than three of four: in most seas hardly an obstacle is in the way and
/// the pictures would show straight lines.
fn turned_aside(runs: &[Flown], seeds: usize) -> usize {
    let length_m = |seed: &usize| {
        let of_seed = runs.iter().skip(*seed).step_by(seeds);
        of_seed.map(|run| run.path.length_m()).sum::<f64>()
    };
    let mut by_length: Vec<usize> = (0..seeds).collect();
    by_length.sort_by(|a, b| length_m(a).total_cmp(&length_m(b)));
    by_length.get(3 * seeds / 4).copied().unwrap_or(0)
}

fn one_figure(output: &Output, figured: &Figured) -> Result<Section, Failure> {
    let &Figured {
        number,
        scenario,
        what,
    } = figured;
    let seed = output.seed.split(u64::from(number));
    let runs = output.each(COUNTS.len() * output.runs, |i| {
        fly(
            scenario,
            COUNTS[i / output.runs],
            seed.split((i % output.runs) as u64),
        )
    })?;
    let of = |k: usize| &runs[k * output.runs..(k + 1) * output.runs];
    let shown = turned_aside(&runs, output.runs);

    let configuration = "leg (0, 0, 20) to (3000, 1500, 60) m (north, east, depth), 3 m/s, 150 particles, 100 iterations, 8 control points, K = 4, c1 2.5 to 2.0 \
         and c2 2.0 to 2.5 constricted";
    let mut section = Section::new(&format!("Fig. {number}: {what}"));
    let mut paths = Figure::new(
        &format!("Fig. {number}(a): {what}"),
        "The best path of one run for 3 to 6 obstacles: the seed with longer paths than three of four.",
    );
    paths.columns = 2;
    for (k, count) in COUNTS.into_iter().enumerate() {
        paths.charts.push(plan_view(&of(k)[shown], count));
    }
    paths.notes = vec![
        "Filled: as the planner was told the obstacle is when the vehicle comes closest. Dotted: at departure (or when it appears), dashed: at arrival.".into(),
        "Seen from above: a path that crosses a filled disc passes above or below the obstacle.".into(),
    ];
    output.draw(&format!("fig{number}a.svg"), &paths)?;
    section.show(&format!("fig{number}a.svg"), "Paths among 3 to 6 obstacles");
    if scenario == LegScenario::Mixed {
        let mut figure = Figure::new(
            "Fig. 16: the path among all classes, in three dimensions",
            "Seen from the south-west and above; depth drawn three times larger. Grey: the path's shadow at the surface.",
        );
        figure.charts.push(oblique(&of(3)[shown]));
        output.draw("fig16.svg", &figure)?;
        section.show(
            "fig16.svg",
            "A path among six obstacles of all classes in three dimensions",
        );
    }
    let mut convergence = Figure::new(
        &format!("Fig. {number}(b, c): cost and violation of the swarm, {what}"),
        "All 150 particles of the runs above at every fifth iteration: quartiles, whiskers 5 to 95 % (those of the first iteration reach beyond the frame), red cross: mean.",
    );
    convergence.columns = 2;
    for (k, count) in COUNTS.into_iter().enumerate() {
        let run = &of(k)[shown];
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

    section.say(format!(
        "Configuration: {configuration}; obstacles as the paper draws them (radius |N(0, 100)| m, at least 10 m), current {CURRENT_MPS} m/s, movers up to 0.5 m/s; \
         {} seeds a count, each with its own obstacles and swarm. The paper prints no numbers for this figure.",
        output.runs
    ));
    let mut table = Table::new([
        "obstacles",
        "runs without violation",
        "path length (m)",
        "cost",
        "mean cost of the swarm at 100 / its best",
        "mean violation at 1",
        "mean violation at 100",
        "CPU (s)",
    ]);
    let (mut clear, mut settled, mut emptied, mut medians) = (0, 0, 0, Vec::new());
    for (k, count) in COUNTS.into_iter().enumerate() {
        let runs = of(k);
        let free = runs.iter().filter(|r| r.violation <= 0.0).count();
        let at = |r: &Flown, last: bool, what: Chosen| {
            let generation = if last {
                r.history.last()
            } else {
                r.history.first()
            };
            generation.map_or(f64::NAN, |g| mean(what(g)))
        };
        let ratio: Vec<f64> = runs
            .iter()
            .map(|r| {
                let best = r.history.last().map_or(f64::NAN, |g| {
                    g.0.iter().copied().fold(f64::INFINITY, f64::min)
                });
                at(r, true, |g| &g.0) / best
            })
            .collect();
        let ends: Vec<f64> = runs.iter().map(|r| at(r, true, |g| &g.1)).collect();
        clear += free;
        settled += ratio.iter().filter(|x| **x <= 1.05).count();
        emptied += ends.iter().filter(|x| **x <= 1e-3).count();
        let costs: Vec<f64> = runs.iter().map(|r| r.cost).collect();
        medians.push(median(&costs));
        table.row([
            count.to_string(),
            format!("{free} of {}", runs.len()),
            spread(
                &runs.iter().map(|r| r.path.length_m()).collect::<Vec<_>>(),
                1,
            ),
            spread(&costs, 4),
            spread(&ratio, 3),
            spread(
                &runs
                    .iter()
                    .map(|r| at(r, false, |g| &g.1))
                    .collect::<Vec<_>>(),
                4,
            ),
            spread(&ends, 4),
            spread(&runs.iter().map(|r| r.cpu_s).collect::<Vec<_>>(), 4),
        ]);
    }
    section.table(&table);
    let all = COUNTS.len() * output.runs;
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
        &format!("the swarm's mean violation is eliminated within 100 iterations (Fig. {number})"),
        10 * emptied >= 9 * all,
        format!("in {emptied} of {all} runs it ends at most at 0.001"),
    );
    let growth = medians[3] / medians[0] - 1.0;
    section.claim(
        &format!("performance is almost stable against the number of obstacles (Fig. {number})"),
        growth.abs() < 0.05,
        format!(
            "from 3 to 6 obstacles the median cost changes by {:+.2} %",
            100.0 * growth
        ),
    );
    Ok(section)
}
