//! A mission with faults, judged.

use crate::fleet::Fleet;
use crate::line::line;
use crate::run_list::FaultKind;
use auv_ga_route::{GaRoute, GaSettings};
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::faults::{FaultPlan, Trial, fly_with_faults};
use auv_sim::{Log, MissionOutcome, Recorder};
use serde_json::{Value, json};

/// Flies mission `k` with faults, twice with `doublecheck`, and gives its line.
pub(crate) fn fly(fleet: &Fleet, k: u64, kind: &FaultKind, doublecheck: bool) -> Value {
    let (mut trial, hash) = match fly_once(fleet, k, kind) {
        Ok(flown) => flown,
        Err(error) => return json!({ "mission": k, "error": error }),
    };
    if doublecheck {
        let again = fly_once(fleet, k, kind);
        if again.is_ok_and(|(_, other)| other != hash) {
            trial.failures.push("flown twice, the logs differ".into());
        }
    }
    let (names, seed) = (kind.names(), fleet.origin().seed_of(k));
    let mut flown = match &trial.summary {
        Some(summary) => line((k, seed), summary, &hash, &names),
        None => json!({
            "mission": k,
            "seed": seed,
            "outcome": MissionOutcome::Aborted,
            "reason": "refused before the start",
            "faults": names,
            "log_sha256": hash,
        }),
    };
    if let Some(line) = flown.as_object_mut() {
        line.insert("intensity".into(), json!(kind.intensity.degree()));
        line.insert("class".into(), json!(trial.response.letter()));
        line.insert("begun_s".into(), json!(trial.started_s));
        line.insert("failures".into(), json!(trial.failures));
        line.insert("unavoidable_by_s".into(), json!(trial.unavoidable_by_s));
    }
    flown
}

fn fly_once(fleet: &Fleet, k: u64, kind: &FaultKind) -> Result<(Trial, String), String> {
    let mut log = Log::hash_only();
    let trial = watch(fleet, k, kind, &mut log)?;
    Ok((trial, log.sha256()))
}

/// Flies mission `k` with faults before a recorder.
pub(crate) fn watch(
    fleet: &Fleet,
    k: u64,
    kind: &FaultKind,
    recorder: &mut dyn Recorder,
) -> Result<Trial, String> {
    let (routes, paths) = (
        GaRoute::new(GaSettings::default()),
        PsoPath::new(PathSearch::default()),
    );
    let scenario = fleet.scenario(k)?;
    let plan = FaultPlan {
        faults: kind.faults.clone(),
        intensity: kind.intensity,
        seed: scenario.seed.split(9),
    };
    fly_with_faults(&scenario, &routes, &paths, &plan, recorder).map_err(|error| error.to_string())
}
