//! One path on a scene file: `cargo run --release --example path -- SCENE.json`.

use auv_planning::format::Scene;
use auv_planning::{Budget, PathPlanner, Planned, Run, Trajectory};
use auv_population::Workers;
use auv_pso_path::{PsoPath, PsoSettings};
use auv_types::Seed;
use std::io::Write;
use std::process::ExitCode;
use std::time::{Duration, Instant};

const HELP: &str = "\
Plans one path on a scene file: clearance 0, no turn or pitch limit, no sea bed.

path SCENE.json [options]

  --planner pso          planner (default pso)
  --preset PRESET        paper, standard or default (default: default)
  --budget-ms MS         deadline of the planning call in milliseconds; the answer is the best found by then
  --evaluations N        exact, reproducible budget: curves costed against all regions
                         (without either, paper and standard stop at their iteration cap, default after 100 ms)
  --seed N               seed (default 0)
  --threads N            threads (default: all cores)
  --json                 print one JSON object
  --help                 this text
";

struct Arguments {
    scene: String,
    preset: String,
    budget: Option<Budget>,
    seed: u64,
    threads: usize,
    json: bool,
}

fn main() -> ExitCode {
    match run(std::env::args().skip(1)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

#[allow(
    clippy::disallowed_methods,
    reason = "the command line measures the call"
)]
fn run(arguments: impl Iterator<Item = String>) -> Result<(), String> {
    let Some(arguments) = parse(arguments)? else {
        print(HELP);
        return Ok(());
    };
    let settings = match arguments.preset.as_str() {
        "paper" => PsoSettings::paper(),
        "standard" => PsoSettings::standard(),
        "default" => PsoSettings::default(),
        other => return Err(format!("--preset {other}: give paper, standard or default")),
    };
    let file = &arguments.scene;
    let bytes = std::fs::read(file).map_err(|error| format!("{file}: {error}"))?;
    let scene = Scene::from_json(&bytes).map_err(|error| format!("{file}: {error}"))?;
    let workers = Workers::new(arguments.threads).map_err(|error| error.to_string())?;
    let planner = PsoPath::new(settings).with_workers(workers);
    let otherwise = match arguments.preset.as_str() {
        "default" => Budget::wall_time(Duration::from_millis(100)),
        _ => Budget::to_the_cap(),
    };
    let budget = arguments.budget.unwrap_or(otherwise);

    let started = Instant::now();
    let mut run = Run::started_at(Seed(arguments.seed), budget, started);
    let planned = planner
        .plan_path(&mut run, &scene.problem())
        .map_err(|error| format!("{file}: {error}"))?;
    let elapsed_ms = started.elapsed().as_secs_f64() * 1e3;
    if arguments.json {
        print_json(&arguments, planner.name(), &scene, &planned, elapsed_ms);
    } else {
        print_text(&scene, &planned, elapsed_ms);
    }
    Ok(())
}

fn parse(mut words: impl Iterator<Item = String>) -> Result<Option<Arguments>, String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut arguments = Arguments {
        scene: String::new(),
        preset: "default".into(),
        budget: None,
        seed: 0,
        threads: cores,
        json: false,
    };
    while let Some(word) = words.next() {
        let mut value = || {
            words
                .next()
                .ok_or_else(|| format!("{word}: give a value after it"))
        };
        match word.as_str() {
            "--help" | "-h" => return Ok(None),
            "--json" => arguments.json = true,
            "--preset" => arguments.preset = value()?,
            "--planner" => {
                let planner = value()?;
                if planner != "pso" {
                    return Err(format!("--planner {planner}: give pso"));
                }
            }
            "--seed" => arguments.seed = number(&word, &value()?)?,
            "--threads" => arguments.threads = number(&word, &value()?)?,
            "--evaluations" => {
                arguments.budget = Some(Budget::evaluations(number(&word, &value()?)?));
            }
            "--budget-ms" => {
                let ms: f64 = number(&word, &value()?)?;
                let time = Duration::try_from_secs_f64(ms / 1e3)
                    .map_err(|error| format!("--budget-ms {ms}: {error}"))?;
                arguments.budget = Some(Budget::wall_time(time));
            }
            _ if word.starts_with("--") => {
                return Err(format!("{word}: unknown option; see --help"));
            }
            _ if arguments.scene.is_empty() => arguments.scene = word,
            _ => return Err(format!("{word}: give one scene file only")),
        }
    }
    if arguments.scene.is_empty() {
        return Err("give a scene file; see --help".into());
    }
    Ok(Some(arguments))
}

fn number<T: std::str::FromStr>(option: &str, text: &str) -> Result<T, String> {
    text.parse()
        .map_err(|_| format!("{option} {text}: give a number"))
}

/// Least exact clearance of a trajectory to the scene's obstacles; infinite without any.
fn min_clearance_m(scene: &Scene, trajectory: &Trajectory) -> f64 {
    let regions = scene.regions.iter();
    let each = regions.flat_map(|region| {
        let segments = trajectory.segments();
        segments.map(move |(from, to)| region.clearance(from, to).clearance_m)
    });
    each.fold(f64::INFINITY, f64::min)
}

fn print_json(
    arguments: &Arguments,
    planner: &str,
    scene: &Scene,
    planned: &Planned<Trajectory>,
    elapsed_ms: f64,
) {
    let points = planned.best.points().iter();
    let path: Vec<[f64; 4]> = points
        .map(|p| [p.position.x, p.position.y, p.position.z, p.time_s])
        .collect();
    let clearance_m = min_clearance_m(scene, &planned.best);
    let answer = serde_json::json!({
        "scene": if scene.id.is_empty() { &arguments.scene } else { &scene.id },
        "planner": planner,
        "seed": arguments.seed,
        "path": path,
        "length_m": planned.best.length_m(),
        "duration_s": planned.best.duration_s(),
        "min_clearance_m": clearance_m.is_finite().then_some(clearance_m),
        "violation": planned.violation,
        "elapsed_ms": elapsed_ms,
        "evaluations": planned.stats.evaluations,
        "stop": planned.stats.stop.as_str(),
    });
    print(&format!("{answer}\n"));
}

fn print_text(scene: &Scene, planned: &Planned<Trajectory>, elapsed_ms: f64) {
    let best = &planned.best;
    let straight_m = (scene.target - scene.start).norm();
    let clear = match (planned.violation > 0.0, planned.blocked_by) {
        (false, _) => format!("clear of all {} obstacles", scene.regions.len()),
        (true, Some(obstacle)) => format!(
            "not clear: violation {:.6}, blocked by obstacle {}",
            planned.violation, obstacle.0
        ),
        (true, None) => format!("not clear: violation {:.6}", planned.violation),
    };
    print(&format!(
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
    ));
}

/// Prints; a reader that has gone away is no error.
fn print(text: &str) {
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
}
