//! Routes: gaps below the best known, by instance and time allowed.

use crate::machine::machine;
use auv_examples::{Arguments, Clock, Failure, read_file};
use auv_ga_route::{GaRoute, GaSettings};
use auv_graph::{RouteInstance, Terrain, format};
use auv_planning::{Budget, RoutePlanner, RouteProblem, Run};
use auv_sim::statistics::{mean, median, quantile};
use auv_types::Seed;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

/// Times allowed, milliseconds.
const ALLOWED_MS: [u64; 4] = [1, 10, 100, 1000];

/// Best known scores of OPLib's instances of the second generation (Kobeaga, Merino and Lozano 2018).
const OPLIB: [(&str, f64); 5] = [
    ("eil51-gen2-50", 1674.0),
    ("st70-gen2-50", 2286.0),
    ("kroA100-gen2-50", 3212.0),
    ("kroA150-gen2-50", 4918.0),
    ("gil262-gen2-50", 8321.0),
];

/// Larger networks of the paper's kind, drawn from seeds: nodes, edges, seed, and the best weight of
/// a run of 20 s (200 nodes) and of three of 60 s (500).
const DRAWN: [(usize, usize, u64, f64); 3] = [
    (200, 19_700, 1, 278.829_152),
    (200, 19_700, 2, 272.680_234),
    (500, 123_500, 1, 380.233_862),
];

/// The section: a row for every instance.
pub(crate) fn measure(arguments: &Arguments, data: &Path) -> Result<String, Failure> {
    let seeds: u64 = arguments.number("seeds")?.unwrap_or(10);
    let first = arguments.seed()?.0;
    let planner = GaRoute::new(GaSettings::default()).with_workers(arguments.workers()?);
    let mut text = format!(
        "Weight below the best known, percent: mean (worst) over {seeds} seeds. Measured on: {}.\n\n\
         | instance | best known | 1 ms | 10 ms | 100 ms | 1 s |\n|---|---|---|---|---|---|\n",
        machine(arguments)?
    );
    let mut late_ms = ALLOWED_MS.map(|_| Vec::new());
    for (instance, best) in instances(data)? {
        let _ = write!(text, "| {} | {best}", instance.name);
        for (late_ms, allowed_ms) in late_ms.iter_mut().zip(ALLOWED_MS) {
            let mut gaps = Vec::new();
            for seed in first..first + seeds {
                let budget = Budget::wall_time(Duration::from_millis(allowed_ms));
                let clock = Clock::start();
                let ends = (instance.start, instance.destination);
                let problem =
                    RouteProblem::new(&instance.network, ends.0, ends.1, instance.budget_s);
                let mut run = Run::started_at(Seed(seed), budget, clock.started());
                let planned = planner
                    .plan_route(&mut run, &problem)
                    .map_err(|error| Failure::planning(&instance.name, &error))?;
                late_ms.push(clock.elapsed_ms() - allowed_ms as f64);
                let weight = problem
                    .check(&planned.best)
                    .map_or(0.0, |totals| totals.weight);
                gaps.push(100.0 * (1.0 - weight / best));
            }
            let (mean, worst) = (mean(&gaps).max(0.0), quantile(&gaps, 1.0).max(0.0));
            let _ = write!(text, " | {mean:.3} ({worst:.3})");
        }
        text.push_str(" |\n");
    }
    text.push_str("\nTime beyond the deadline, ms, median (99th percentile):");
    for (late_ms, allowed_ms) in late_ms.iter().zip(ALLOWED_MS) {
        let (middle, most) = (median(late_ms).max(0.0), quantile(late_ms, 0.99).max(0.0));
        let _ = write!(text, " at {allowed_ms} ms {middle:.2} ({most:.2});");
    }
    text.pop();
    text.push_str(".\n");
    Ok(text)
}

/// The instances with a best known weight: those of the paper's kind with a proven optimum, larger
/// ones, and OPLib's.
fn instances(data: &Path) -> Result<Vec<(RouteInstance, f64)>, Failure> {
    let path = data.join("routes/optimal.json").display().to_string();
    let optimal: Value = serde_json::from_slice(&read_file(&path, format::MAX_FILE_BYTES)?)
        .map_err(|error| Failure::file(&path, error))?;
    let proven = optimal.as_object().into_iter().flatten();
    let proven = proven
        .filter_map(|(name, best)| Some((format!("routes/{name}.json"), best["weight"].as_f64()?)));
    let oplib = OPLIB
        .iter()
        .map(|&(name, best)| (format!("oplib/{name}.oplib"), best));
    let drawn = DRAWN.iter().map(|&(nodes, edges, seed, best)| {
        let instance = Terrain::benchmark(nodes, edges).draw(Seed(seed));
        let internal = |error| Failure::Internal(format!("{nodes} nodes: {error}"));
        Ok((instance.map_err(internal)?, best))
    });
    let read = |(name, best): (String, f64)| Ok((read(data, &name)?, best));
    proven
        .map(read)
        .chain(drawn)
        .chain(oplib.map(read))
        .collect()
}

/// The instance in a file below the data folder.
pub(crate) fn read(data: &Path, name: &str) -> Result<RouteInstance, Failure> {
    let path = data.join(name);
    let shown = path.display().to_string();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let bytes = read_file(&shown, format::MAX_FILE_BYTES)?;
    format::read(&bytes, &stem).map_err(|error| Failure::file(&shown, error))
}
