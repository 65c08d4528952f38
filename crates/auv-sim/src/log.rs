//! The mission log: one JSON object per line, and a hash of all lines.

use crate::{Entry, Recorder, Summary};
use auv_mission::{PathCall, RouteCall};
use serde::Serialize;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// Writes the log of a mission and hashes it as it grows.
///
/// The hash omits two objects of a line: `measured` (measured times) and `text` (texts for people).
/// Outcomes and reasons are hashed by their stable codes. Equal seeds give equal hashes on any machine
/// and at any number of threads.
#[derive(Clone, Debug, Default)]
pub struct Log {
    hash: Sha256,
    lines: Option<Vec<String>>,
}

impl Log {
    /// A log that keeps its lines.
    #[must_use]
    pub fn keeping_lines() -> Self {
        Self {
            hash: Sha256::new(),
            lines: Some(Vec::new()),
        }
    }

    /// A log that keeps only the hash.
    #[must_use]
    pub fn hash_only() -> Self {
        Self::default()
    }

    /// The lines so far; empty for a log that keeps only the hash.
    #[must_use]
    pub fn lines(&self) -> &[String] {
        self.lines.as_deref().unwrap_or_default()
    }

    /// SHA-256 of all lines without measured times and texts, in hexadecimal.
    #[must_use]
    pub fn sha256(&self) -> String {
        self.hash
            .clone()
            .finalize()
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect()
    }

    fn write(&mut self, event: &str, body: Value, unhashed: Option<(&str, Value)>) {
        let mut line = json!({ "event": event });
        if let (Some(line), Value::Object(body)) = (line.as_object_mut(), body) {
            line.extend(body);
        }
        self.hash.update(line.to_string().as_bytes());
        self.hash.update(b"\n");
        if let Some(lines) = &mut self.lines {
            if let (Some(line), Some((key, unhashed))) = (line.as_object_mut(), unhashed) {
                line.insert(key.into(), unhashed);
            }
            lines.push(line.to_string());
        }
    }
}

/// A table row as JSON, and its measured time.
fn row(call: &impl Serialize) -> (Value, Option<(&'static str, Value)>) {
    let mut body = serde_json::to_value(call).unwrap_or(Value::Null);
    let measured = body
        .as_object_mut()
        .and_then(|body| body.remove("compute_s"));
    (
        body,
        measured.map(|compute_s| ("measured", json!({ "compute_s": compute_s }))),
    )
}

impl Recorder for Log {
    fn record(&mut self, entry: Entry<'_>) {
        match entry {
            Entry::Started(scenario) => {
                let body = json!({
                    "mission": scenario.name,
                    "preset": scenario.preset,
                    "seed": scenario.seed,
                    "budget_s": scenario.mission.budget_s,
                    "reserve_s": scenario.mission.reserve_s,
                });
                self.write("started", body, None);
            }
            Entry::Route(call) => {
                let (body, measured) = row(call);
                self.write("route_call", body, measured);
            }
            Entry::Leg(call) => {
                let (body, measured) = row(call);
                self.write("path_call", body, measured);
            }
            Entry::Follow(time_s, trajectory) => {
                let points: Vec<[f64; 4]> = trajectory
                    .points()
                    .iter()
                    .map(|point| {
                        [
                            point.position.x,
                            point.position.y,
                            point.position.z,
                            point.time_s,
                        ]
                    })
                    .collect();
                self.write(
                    "follow",
                    json!({ "time_s": time_s, "points": points }),
                    None,
                );
            }
            Entry::Flown { .. } => {}
            Entry::Ended(summary) => {
                let text = json!({ "reason": summary.reason.to_string() });
                self.write("ended", outcome_json(summary), Some(("text", text)));
            }
        }
    }
}

/// A number as JSON; infinity becomes null.
fn finite(x: f64) -> Value {
    if x.is_finite() { json!(x) } else { Value::Null }
}

fn outcome_json(summary: &Summary) -> Value {
    let judgement = &summary.judgement;
    json!({
        "outcome": summary.outcome,
        "reason_code": summary.reason.code(),
        "contingency": summary.reason.contingency().map(auv_mission::Contingency::code),
        "visited": summary.visited,
        "mission_weight": summary.mission_weight,
        "tasks": summary.tasks,
        "time_s": summary.time_s,
        "remaining_s": summary.remaining_s,
        "min_true_clearance_m": finite(judgement.min_clearance_m),
        "collisions": judgement.collisions,
        "min_altitude_m": finite(judgement.min_altitude_m),
        "groundings": judgement.groundings,
        "ships": judgement.ships.len(),
        "min_ship_distance_m": finite(judgement.min_ship_distance_m),
    })
}

/// The `mission` command's object without the log's hash.
impl serde::Serialize for Summary {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.object().serialize(serializer)
    }
}

impl Summary {
    /// The whole summary as one JSON object (the `mission` command's contract), with the log's hash.
    #[must_use]
    pub fn to_json(&self, log_sha256: &str) -> Value {
        let mut object = self.object();
        if let Some(object) = object.as_object_mut() {
            object.insert("log_sha256".into(), json!(log_sha256));
        }
        object
    }

    fn object(&self) -> Value {
        let mut object = outcome_json(self);
        if let Some(object) = object.as_object_mut() {
            object.insert("reason".into(), json!(self.reason.to_string()));
            let table = |rows: Vec<Value>| Value::Array(rows);
            let rows = |calls: &[RouteCall]| calls.iter().map(|c| json!(c)).collect();
            let legs = |calls: &[PathCall]| calls.iter().map(|c| json!(c)).collect();
            object.insert("route_calls".into(), table(rows(&self.route_calls)));
            object.insert("path_calls".into(), table(legs(&self.path_calls)));
            let broken = &self.judgement.limits_broken;
            object.insert("limits_broken".into(), json!(broken));
            object.insert("dock_error_m".into(), json!(self.dock_error_m));
            let following =
                json!({ "p95": self.following.quantile_m(0.95), "most": self.following.most_m() });
            object.insert("off_timed_place_m".into(), following);
            // Only where the bed was measured shallower than charted.
            if self.climbs > 0 {
                object.insert("climbs".into(), json!(self.climbs));
            }
            if !self.raised.is_empty() {
                object.insert("raised".into(), json!(self.raised));
            }
        }
        object
    }
}
