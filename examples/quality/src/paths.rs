//! Paths: gaps above the best known, by family, size and time allowed.

use crate::machine::machine;
use auv_examples::{Arguments, Clock, Failure, read_file};
use auv_planning::format::{MAX_SCENE_BYTES, Scene};
use auv_planning::{Budget, PathPlanner, Run};
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::statistics::{median, quantile};
use auv_types::Seed;
use auv_verify::verify_trajectory;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

/// A folder of scenes, and the times allowed for them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scenes {
    folder: &'static str,
    /// Milliseconds.
    allowed_ms: [u64; 3],
}

/// Obstacles in still water.
pub(crate) const STILL: Scenes = Scenes {
    folder: "scenes",
    allowed_ms: [1, 10, 100],
};
/// Currents, tides, coasts, traffic, layers and turns.
pub(crate) const SEA: Scenes = Scenes {
    folder: "sea",
    allowed_ms: [10, 100, 1_000],
};

/// The results of one family of scenes at one time allowed.
#[derive(Default)]
struct Gaps {
    /// Percent above the best known; infinite where no clear path was found.
    gaps: Vec<f64>,
    /// Paths claimed to be clear that the verifier refuses.
    invalid: usize,
    late_ms: Vec<f64>,
}

/// The section: a row for every family and size.
pub(crate) fn measure(
    arguments: &Arguments,
    data: &Path,
    scenes: Scenes,
) -> Result<String, Failure> {
    let folder = data.join(scenes.folder);
    let seeds: u64 = arguments.number("seeds")?.unwrap_or(10);
    let first = arguments.seed()?.0;
    let planner = PsoPath::new(PathSearch::default()).with_workers(arguments.workers()?);
    let mut families: BTreeMap<String, [Gaps; 3]> = BTreeMap::new();
    let known = json(&folder.join("reference.json"))?;
    for (name, best) in known.as_object().into_iter().flatten() {
        let path = folder.join(format!("{name}.json"));
        let Some((family, _)) = name.rsplit_once('-') else {
            continue;
        };
        let scene = scene(&path)?;
        let straight_s = |best_m: f64| best_m / scene.vehicle.speed_mps;
        let best_s = best["duration"].as_f64();
        let Some(best_s) = best_s.or_else(|| best["length"].as_f64().map(straight_s)) else {
            continue;
        };
        let outcomes = families.entry(family.into()).or_default();
        for (outcome, allowed_ms) in outcomes.iter_mut().zip(scenes.allowed_ms) {
            for seed in first..first + seeds {
                let budget = Budget::wall_time(Duration::from_millis(allowed_ms));
                let clock = Clock::start();
                let problem = scene.problem();
                let mut run = Run::started_at(Seed(seed), budget, clock.started());
                let planned = planner
                    .plan_path(&mut run, &problem)
                    .map_err(|error| Failure::planning(name, &error))?;
                outcome.late_ms.push(clock.elapsed_ms() - allowed_ms as f64);
                if planned.violation > 0.0 {
                    outcome.gaps.push(f64::INFINITY);
                    continue;
                }
                outcome
                    .gaps
                    .push(100.0 * (planned.best.duration_s() / best_s - 1.0));
                let valid = verify_trajectory(&problem, &planned.best).is_valid();
                outcome.invalid += usize::from(!valid);
            }
        }
    }
    Ok(text(&families, scenes, seeds, &machine(arguments)?))
}

/// The scene in a file.
pub(crate) fn scene(path: &Path) -> Result<Scene, Failure> {
    Scene::from_json(&read(path)?)
        .map_err(|error| Failure::file(&path.display().to_string(), error))
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    read_file(&path.display().to_string(), MAX_SCENE_BYTES)
}

fn json(path: &Path) -> Result<Value, Failure> {
    serde_json::from_slice(&read(path)?)
        .map_err(|error| Failure::file(&path.display().to_string(), error))
}

fn text(
    families: &BTreeMap<String, [Gaps; 3]>,
    scenes: Scenes,
    seeds: u64,
    machine: &str,
) -> String {
    let [short, middle, long] = scenes.allowed_ms;
    let mut text = format!(
        "Arrival above the best known, percent: median (worst) over the scenes of a family and {seeds} seeds each.\n\
         `-` is no clear path in time. Measured on: {machine}.\n\n\
         | scenes | {short} ms | {middle} ms | {long} ms | invalid |\n|---|---|---|---|---|\n"
    );
    for (family, outcomes) in families {
        let _ = write!(text, "| {family}");
        for outcome in outcomes {
            let _ = write!(
                text,
                " | {} ({})",
                percent(median(&outcome.gaps)),
                percent(quantile(&outcome.gaps, 1.0))
            );
        }
        let invalid: usize = outcomes.iter().map(|outcome| outcome.invalid).sum();
        let _ = writeln!(text, " | {invalid} |");
    }
    text.push_str("\nTime beyond the deadline, ms, median (99th percentile):");
    for (k, allowed_ms) in scenes.allowed_ms.iter().enumerate() {
        let late: Vec<f64> = families
            .values()
            .flat_map(|outcomes| outcomes[k].late_ms.clone())
            .collect();
        let (middle, most) = (median(&late).max(0.0), quantile(&late, 0.99).max(0.0));
        let _ = write!(text, " at {allowed_ms} ms {middle:.2} ({most:.2});");
    }
    text.pop();
    text.push_str(".\n");
    text
}

fn percent(gap: f64) -> String {
    if gap.is_finite() {
        format!("{:.4}", gap.max(0.0))
    } else {
        "-".into()
    }
}
