//! Plans one path: `cargo run --release --example path -- SCENE.json`.

mod isochrones;
mod scene_picture;

use auv_examples::{
    Arguments, Clock, CommandLine, Failure, Operand, Opt, note, print, print_json, read_file,
    write_file,
};
use auv_planning::format::{MAX_SCENE_BYTES, Scene};
use auv_planning::motion::{ALWAYS, least_clearance};
use auv_planning::{PathPlanner, Planned, Run, Trajectory};
use auv_pso_path::{PathSearch, PsoPath};
use auv_types::Seed;
use serde::Serialize;
use std::path::Path;

pub(crate) const COMMAND: CommandLine = CommandLine {
    name: "path",
    about: "Plans the quickest path of a scene among its static and moving obstacles.",
    operands: &[Operand::required(
        "SCENE",
        "a scene JSON: start, target, speed, bounds, obstacles, current and bed, in metres and m/s",
    )],
    options: &[
        Opt::choice("planner", &["pso"], "pso", "which planner"),
        Opt::choice(
            "preset",
            &["paper", "standard", "default"],
            "default",
            "the planner's settings: the paper's swarm, the same with common coefficients, or the time-optimal planner",
        ),
        Opt::value(
            "budget-ms",
            "MS",
            "",
            "deadline in milliseconds (default: 100 for preset default; none for paper and standard, which stop at their iteration cap)",
        ),
        Opt::value(
            "evaluations",
            "N",
            "",
            "most curves costed, exact and reproducible (default: no limit)",
        ),
        Opt::value(
            "svg",
            "FILE",
            "",
            "draw the path with shore, current, isochrones and obstacles as SVG (default: none)",
        ),
    ],
    notes: "Unless the scene says otherwise, the vehicle is a point that leaves at t = 0 with constant speed:\n\
            clearance 0, no turn or pitch limit, no sea bed, still water. The times of the path are mission\n\
            time. A violation of 0 means that the printed path passed the exact check.\n\n\
            Example: path scene.json --budget-ms 10 --json",
};

/// The JSON of an answer.
#[derive(Serialize)]
pub(crate) struct Answer<'a> {
    scene: &'a str,
    planner: &'a str,
    seed: u64,
    path: Vec<[f64; 4]>,
    length_m: f64,
    duration_s: f64,
    /// `None` without obstacles.
    min_clearance_m: Option<f64>,
    violation: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    blocked_by: Option<u32>,
    elapsed_ms: f64,
    evaluations: u64,
    stop: &'a str,
}

fn main() -> std::process::ExitCode {
    COMMAND.run(|arguments| {
        let solved = plan(arguments)?;
        if let Some(file) = arguments.text("svg") {
            let picture = scene_picture::svg(&solved.scene, &solved.planned.best);
            write_file(Path::new(file), picture.as_bytes())?;
        }
        if arguments.json() {
            if let Some(reason) = end_inside(&solved.scene, &solved.planned.best) {
                note(&format!("{}: {reason}", solved.scene.id));
            }
            print_json(&solved.answer())
        } else {
            print(&text(&solved.scene, &solved.planned, solved.elapsed_ms))
        }
    })
}

/// A path with what is printed of it.
pub(crate) struct Solved {
    scene: Scene,
    planner: PsoPath,
    seed: Seed,
    planned: Planned<Trajectory>,
    elapsed_ms: f64,
}

pub(crate) fn plan(arguments: &Arguments) -> Result<Solved, Failure> {
    let path = arguments.operand("SCENE").unwrap_or_default();
    let bytes = read_file(path, MAX_SCENE_BYTES)?;
    let mut scene = Scene::from_json(&bytes).map_err(|error| Failure::file(path, error))?;
    if scene.id.is_empty() {
        let stem = Path::new(path).file_stem().unwrap_or_default();
        scene.id = stem.to_string_lossy().into_owned();
    }
    let settings = match arguments.text("preset") {
        Some("paper") => PathSearch::paper(),
        Some("standard") => PathSearch::standard(),
        _ => PathSearch::default(),
    };
    let planner = PsoPath::new(settings).with_workers(arguments.workers()?);
    let budget = arguments.budget(arguments.text("preset") == Some("default"))?;
    let seed = arguments.seed()?;

    let clock = Clock::start();
    let mut run = Run::started_at(seed, budget, clock.started());
    let planned = planner
        .plan_path(&mut run, &scene.problem())
        .map_err(|error| Failure::planning(path, &error))?;
    let elapsed_ms = clock.elapsed_ms();
    Ok(Solved {
        scene,
        planner,
        seed,
        planned,
        elapsed_ms,
    })
}

impl Solved {
    pub(crate) fn answer(&self) -> Answer<'_> {
        let best = &self.planned.best;
        let points = best.points().iter();
        Answer {
            scene: &self.scene.id,
            planner: self.planner.name(),
            seed: self.seed.0,
            path: points
                .map(|p| [p.position.x, p.position.y, p.position.z, p.time_s])
                .collect(),
            length_m: best.length_m(),
            duration_s: best.duration_s(),
            min_clearance_m: Some(min_clearance_m(&self.scene, best)).filter(|m| m.is_finite()),
            violation: self.planned.violation,
            blocked_by: self.planned.blocked_by.map(|obstacle| obstacle.0),
            elapsed_ms: self.elapsed_ms,
            evaluations: self.planned.stats.evaluations,
            stop: self.planned.stats.stop.as_str(),
        }
    }
}

/// Least exact clearance of a trajectory to the scene's obstacles; infinite without any.
fn min_clearance_m(scene: &Scene, trajectory: &Trajectory) -> f64 {
    least_clearance(trajectory, &scene.regions, ALWAYS, f64::INFINITY).clearance_m
}

/// Which end of the leg lies inside an obstacle, when the vehicle is there, and how far.
fn end_inside(scene: &Scene, best: &Trajectory) -> Option<String> {
    let ends = [
        ("start", best.points().first()),
        ("target", best.points().last()),
    ];
    ends.into_iter().find_map(|(name, end)| {
        let inside = scene.regions.iter().filter_map(|region| {
            let within_m = -region.distance_m(end?);
            (within_m > 0.0).then_some((region.obstacle.0, within_m))
        });
        let (obstacle, within_m) = inside.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(format!(
            "the {name} lies {within_m:.3} m inside obstacle {obstacle}; move one of them"
        ))
    })
}

/// Which end of the leg lies outside the box, and how far.
fn end_outside(scene: &Scene) -> Option<String> {
    let bounds = scene.bounds?;
    let ends = [("start", scene.start), ("target", scene.target)];
    let mut outside = ends.iter().filter(|(_, end)| !bounds.contains(end));
    let (name, end) = outside.next()?;
    let excess_m = bounds.excess_m(end);
    Some(format!(
        "the {name} lies {excess_m:.3} m outside the bounds"
    ))
}

fn text(scene: &Scene, planned: &Planned<Trajectory>, elapsed_ms: f64) -> String {
    let best = &planned.best;
    let straight_m = (scene.target - scene.start).norm();
    let clear = match (planned.violation > 0.0, planned.blocked_by) {
        (false, _) => format!("clear of all {} obstacles", scene.regions.len()),
        (true, Some(obstacle)) => format!(
            "not clear: violation {:.6}, blocked by obstacle {}{}",
            planned.violation,
            obstacle.0,
            end_inside(scene, best).map_or(String::new(), |reason| format!("; {reason}"))
        ),
        (true, None) => format!(
            "not clear: violation {:.6}{}",
            planned.violation,
            end_outside(scene).map_or(String::new(), |reason| format!(", {reason}"))
        ),
    };
    if straight_m <= 1e-9 {
        return format!(
            "{}: start and target are the same place, there is nothing to fly\n{clear}\n",
            scene.id
        );
    }
    format!(
        "{}: {:.2} m, {:.2} s ({:+.3} % over the straight line), least clearance {:.3} m, {} points\n\
         {clear}\n{} evaluations in {elapsed_ms:.2} ms, stop: {}\n",
        scene.id,
        best.length_m(),
        best.duration_s(),
        100.0 * (best.length_m() / straight_m.max(1e-9) - 1.0),
        min_clearance_m(scene, best),
        best.points().len(),
        planned.stats.evaluations,
        planned.stats.stop.as_str()
    )
}
