//! The line that a mission leaves.

use auv_sim::Summary;
use serde_json::{Value, json};

/// A mission's line as JSON: number, seed, how it went, and the faults injected.
pub(crate) fn line(
    (k, seed): (u64, u64),
    summary: &Summary,
    log_sha256: &str,
    faults: &[&str],
) -> Value {
    let judgement = &summary.judgement;
    let clearance_m = judgement.min_clearance_m;
    json!({
        "mission": k,
        "seed": seed,
        "outcome": summary.outcome,
        "reason": summary.reason.to_string(),
        "reason_code": summary.reason.code(),
        "contingency": summary.reason.contingency().map(auv_mission::Contingency::code),
        "collisions": judgement.collisions,
        "groundings": judgement.groundings,
        "limits_broken": judgement.limits_broken,
        "min_true_clearance_m": if clearance_m.is_finite() { json!(clearance_m) } else { Value::Null },
        "time_s": summary.time_s,
        "remaining_s": summary.remaining_s,
        "mission_weight": summary.mission_weight,
        "tasks": summary.tasks,
        "route_calls": summary.route_calls.len(),
        "path_calls": summary.path_calls.len(),
        "replans": summary.path_calls.iter().filter(|leg| leg.replan).count(),
        "faults": faults,
        "log_sha256": log_sha256,
    })
}
