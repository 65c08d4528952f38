//! `auv-route-1`: an instance as JSON.
//!
//! ```json
//! {"format": "auv-route-1", "name": "two legs", "seed": 1, "directed": false, "speed": 3.0,
//!  "budget": 7200, "start": 0, "goal": 2, "nodes": [[0, 0, 10], [900, 0, 20], [1800, 0, 10]],
//!  "edge_fields": ["i", "j", "rho", "xi", "delta"], "edges": [[0, 1, 7, 2.5, 60], [1, 2, 3, 1, 0]]}
//! ```
//! `nodes` are `[x, y, z]` in metres; an edge leads from node `i` to node `j` (both ways unless
//! `directed`), with priority `rho`, risk `xi` and completion time `delta` in seconds; `speed` is in
//! m/s, `budget` in seconds. `name`, `seed` and `edge_fields` are optional. A sixth edge field,
//! `length`, gives the length in metres if it is not that of the straight line. `NaN`, `Infinity` and the
//! like, which JSON does not have, are refused with a list of all their places.

use super::error::{FormatError, MAX_FILE_BYTES};
use super::number::{JsonNumber, quoted};
use super::text::{shortened, without_mark};
use super::time_keys::{ChainRow, ProfileRows, TaskRow, TimeKeys, VisitsRow};
use crate::ids::NodeId;
use crate::instance::RouteInstance;
use crate::network::Network;
use crate::time_model::Passing;
use crate::waypoint::{Edge, Task, Waypoint};
use auv_types::{Point3, Violations};
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

const FORMAT: &str = "auv-route-1";
const EDGE_FIELDS: [&str; 6] = ["i", "j", "rho", "xi", "delta", "length"];
/// The names that the network gives to the last four.
const TASK_FIELDS: [&str; 4] = ["priority", "risk", "completion_time", "distance"];

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RouteFile {
    format: String,
    #[serde(default)]
    name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
    directed: bool,
    speed: JsonNumber,
    budget: JsonNumber,
    start: JsonIndex,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    goal: Option<JsonIndex>,
    nodes: NumberRows<{ Network::MAX_NODES }>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    edge_fields: Option<Vec<String>>,
    edges: NumberRows<{ Network::MAX_EDGES }>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tasks: Option<Vec<TaskRow>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    chains: Option<BTreeMap<String, ChainRow>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    profiles: Option<ProfileRows>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    visits: Option<VisitsRow>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    destinations: Option<Vec<u32>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    may_wait: Option<bool>,
}

/// A node's index, read as any number and written as a whole one.
#[derive(Clone, Copy, Deserialize)]
#[serde(transparent)]
struct JsonIndex(JsonNumber);

impl Serialize for JsonIndex {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u32(self.0.0 as u32)
    }
}

/// The message of a JSON error, without serde_json's " at line 1 column 2", and the remedy.
fn explained(text: &str, error: &serde_json::Error) -> String {
    if text.contains("\"obstacles\"") {
        return format!("this is a scene for a path planner; {FORM}");
    }
    let message = error.to_string();
    let end = message.rfind(" at line ").unwrap_or(message.len());
    format!("{}; {FORM}", &message[..end])
}

/// The form of an instance, for messages.
const FORM: &str = "give one complete JSON object with format `auv-route-1`, directed, speed, budget, start, goal, \
                    nodes [[x, y, z], ...] and edges [[i, j, priority, risk, completion time], ...]";

/// Reads an `auv-route-1` object.
///
/// # Errors
/// The first place where the text is not JSON of that form (unknown keys included). Otherwise all
/// invalid values: if any is not a finite number or not a node index, these; else those out of range.
pub fn from_json(text: &str) -> Result<RouteInstance, FormatError> {
    if text.len() > MAX_FILE_BYTES {
        return Err(FormatError::TooLarge { bytes: text.len() });
    }
    let text = without_mark(text);
    let file: RouteFile = serde_json::from_str(text).or_else(|error| {
        let named = quoted(text).and_then(|text| serde_json::from_str(&text).ok());
        named.ok_or_else(|| FormatError::Syntax {
            line: error.line(),
            column: error.column(),
            message: explained(text, &error),
        })
    })?;
    let mut violations = Violations::new();
    violations.require(file.format == FORMAT, "format", || {
        format!(
            "is `{}`; this version reads `{FORMAT}`",
            shortened(&file.format)
        )
    });
    let num_fields = file.edge_fields.as_ref().map_or(5, Vec::len);
    let known = file.edge_fields.as_ref().is_none_or(|given| {
        (5..=6).contains(&num_fields) && given[..] == EDGE_FIELDS[..num_fields]
    });
    violations.require(known, "edge_fields", || {
        format!("is not {:?}, with or without the last", EDGE_FIELDS)
    });
    require_finite(&[file.speed.0, file.budget.0], &mut violations, |field| {
        ["speed", "budget"][field].into()
    });
    let start = NodeId(node(file.start.0.0, "start", &mut violations));
    let destination = file.destination(&mut violations);
    let waypoints = file.waypoints(&mut violations);
    let edges = file.edges(if known { num_fields } else { 5 }, &mut violations);
    violations.into_result()?;
    let network = Network::new(&waypoints, &edges, file.speed.0)?;
    let keys = TimeKeys {
        tasks: file.tasks,
        chains: file.chains,
        profiles: file.profiles,
        visits: file.visits,
        destinations: file.destinations,
        may_wait: file.may_wait,
    };
    let time_model = keys.model(&network)?;
    let ends = (start, destination);
    let mut instance = RouteInstance::new(file.name, network, ends, file.budget.0)?;
    instance.seed = file.seed;
    instance.time_model = time_model;
    Ok(instance)
}

/// Writes an instance as `auv-route-1`. [`from_json`] gives the same instance again, without the names
/// of its waypoints.
///
/// # Errors
/// [`FormatError::NotExpressible`] if some edges are directed and others are not, or if passing a node
/// does its tasks ([`Passing::DoesTasks`]).
pub fn to_json(instance: &RouteInstance) -> Result<String, FormatError> {
    let network = &instance.network;
    let model = instance.time_model.as_ref();
    if model.is_some_and(|model| model.passing == Passing::DoesTasks) {
        let both = "nodes whose tasks are done by passing; write it as an OPTW file";
        return Err(FormatError::NotExpressible(both.into()));
    }
    let directed = network.edges().first().is_some_and(|edge| edge.directed);
    if network.edges().iter().any(|edge| edge.directed != directed) {
        let both = "directed beside undirected edges; give each direction its own edge";
        return Err(FormatError::NotExpressible(both.into()));
    }
    let nodes = network
        .waypoints()
        .iter()
        .map(|w| NumberRow::new(w.position.coords.as_slice()));
    let has_lengths = network.edges().iter().any(|edge| edge.distance_m.is_some());
    let num_fields = if has_lengths { 6 } else { 5 };
    let row = |edge: &Edge| {
        let straight_m = || {
            let [from, to] = [edge.from, edge.to].map(|i| network.waypoints()[i as usize].position);
            (to - from).norm()
        };
        let task = edge.task;
        let fields = [
            f64::from(edge.from),
            f64::from(edge.to),
            task.priority,
            task.risk,
            task.completion_time_s,
            edge.distance_m.unwrap_or_else(straight_m),
        ];
        NumberRow::new(&fields[..num_fields])
    };
    let index = |node: NodeId| JsonIndex(JsonNumber(node.0.into()));
    let keys = TimeKeys::of(model, network);
    let file = RouteFile {
        format: FORMAT.into(),
        name: instance.name.clone(),
        seed: instance.seed,
        directed,
        speed: JsonNumber(network.speed_mps()),
        budget: JsonNumber(instance.budget_s),
        start: index(instance.start),
        goal: Some(index(instance.destination)),
        nodes: NumberRows(nodes.collect()),
        edge_fields: Some(
            EDGE_FIELDS[..num_fields]
                .iter()
                .map(|&f| f.into())
                .collect(),
        ),
        edges: NumberRows(network.edges().iter().map(row).collect()),
        tasks: keys.tasks,
        chains: keys.chains,
        profiles: keys.profiles,
        visits: keys.visits,
        destinations: keys.destinations,
        may_wait: keys.may_wait,
    };
    serde_json::to_string(&file).map_err(|error| FormatError::NotExpressible(error.to_string()))
}

impl RouteFile {
    /// The goal; in a file with `destinations` it may be absent and is the first of them.
    fn destination(&self, violations: &mut Violations) -> NodeId {
        let first = self.destinations.as_deref().and_then(<[u32]>::first);
        match (self.goal, first) {
            (Some(goal), _) => NodeId(node(goal.0.0, "goal", violations)),
            (None, Some(&first)) => NodeId(first),
            (None, None) => {
                violations.push("goal", "is missing; give it, or `destinations`");
                NodeId(0)
            }
        }
    }

    fn waypoints(&self, violations: &mut Violations) -> Vec<Waypoint> {
        let mut waypoints = Vec::with_capacity(self.nodes.0.len());
        for (i, row) in self.nodes.0.iter().enumerate() {
            violations.require(row.len == 3, &format!("nodes[{i}]"), || {
                format!("has {} entries; give [x, y, z] in metres", row.len)
            });
            let [x, y, z, ..] = row.values;
            require_finite(&[x, y, z], violations, |axis| {
                format!("nodes[{i}].{}", ["x", "y", "z"][axis])
            });
            waypoints.push(Waypoint::at(Point3::new(x, y, z)));
        }
        waypoints
    }

    fn edges(&self, num_fields: usize, violations: &mut Violations) -> Vec<Edge> {
        let mut edges = Vec::with_capacity(self.edges.0.len());
        for (i, row) in self.edges.0.iter().enumerate() {
            let place = format!("edges[{i}]");
            violations.require(row.len == num_fields, &place, || {
                let fields = EDGE_FIELDS[..num_fields].join(", ");
                format!("has {} entries; give [{fields}]", row.len)
            });
            let [from, to, priority, risk, completion_time_s, length_m] = row.values;
            let task = [priority, risk, completion_time_s, length_m];
            require_finite(&task, violations, |field| {
                format!("{place}.{}", TASK_FIELDS[field])
            });
            edges.push(Edge {
                from: node(from, &place, violations),
                to: node(to, &place, violations),
                directed: self.directed,
                task: Task {
                    priority,
                    risk,
                    completion_time_s,
                },
                distance_m: (num_fields == 6).then_some(length_m),
            });
        }
        edges
    }
}

/// Adds a violation for each value that is not finite.
fn require_finite(values: &[f64], violations: &mut Violations, place: impl Fn(usize) -> String) {
    for (i, value) in values.iter().enumerate() {
        if !value.is_finite() {
            violations.push(place(i), format!("is {value}; give a finite number"));
        }
    }
}

/// The index of a node; a violation if the value is not one.
fn node(value: f64, place: &str, violations: &mut Violations) -> u32 {
    let whole = value.fract() == 0.0 && (0.0..f64::from(u32::MAX)).contains(&value);
    violations.require(whole, place, || {
        format!("names node {value}; give the index of a node, from 0")
    });
    value as u32
}

/// An array of at most six numbers. Of a longer array the length is kept.
#[derive(Clone, Copy)]
struct NumberRow {
    values: [f64; 6],
    len: usize,
}

impl NumberRow {
    fn new(numbers: &[f64]) -> Self {
        let mut values = [0.0; 6];
        values[..numbers.len()].copy_from_slice(numbers);
        Self {
            values,
            len: numbers.len(),
        }
    }
}

impl Serialize for NumberRow {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(&self.values[..self.len])
    }
}

impl<'de> Deserialize<'de> for NumberRow {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct RowVisitor;
        impl<'de> Visitor<'de> for RowVisitor {
            type Value = NumberRow;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an array of numbers")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<NumberRow, A::Error> {
                let mut row = NumberRow::new(&[]);
                while let Some(value) = seq.next_element::<JsonNumber>()? {
                    if let Some(slot) = row.values.get_mut(row.len) {
                        *slot = value.0;
                    }
                    row.len += 1;
                }
                Ok(row)
            }
        }
        deserializer.deserialize_seq(RowVisitor)
    }
}

/// An array of at most `MOST` rows; reading stops at the first row beyond.
struct NumberRows<const MOST: usize>(Vec<NumberRow>);

impl<const MOST: usize> Serialize for NumberRows<MOST> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(&self.0)
    }
}

impl<'de, const MOST: usize> Deserialize<'de> for NumberRows<MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Bounded<const MOST: usize>;
        impl<'de, const MOST: usize> Visitor<'de> for Bounded<MOST> {
            type Value = NumberRows<MOST>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "an array of at most {MOST} arrays of numbers")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
                let mut rows = Vec::new();
                while let Some(row) = seq.next_element()? {
                    if rows.len() == MOST {
                        return Err(A::Error::invalid_length(MOST + 1, &self));
                    }
                    rows.push(row);
                }
                Ok(NumberRows(rows))
            }
        }
        deserializer.deserialize_seq(Bounded::<MOST>)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SMALL: &str = r#"{"format":"auv-route-1","name":"t","directed":false,"speed":3,
        "budget":7200,"start":0,"goal":2,"nodes":[[0,0,10],[900,0,20],[1800,0,10]],
        "edges":[[0,1,7,2.5,60],[1,2,3,1,0]]}"#;

    fn refusal(text: &str) -> String {
        from_json(text).unwrap_err().to_string()
    }

    #[test]
    fn a_written_instance_is_read_again() {
        let instance = from_json(SMALL).unwrap();
        assert_eq!(from_json(&to_json(&instance).unwrap()).unwrap(), instance);
    }

    #[test]
    fn every_invalid_value_is_reported() {
        let bad = SMALL.replace(
            "[[0,1,7,2.5,60],[1,2,3,1,0]]",
            "[[0,1,7,0,60],[1,1,3,1,0],[0,9,1,1,1],[0,2,-1,1,-1],[1,0,1,1,1]]",
        );
        let message = refusal(&bad);
        for place in [
            "edges[0].risk",
            "edges[1]",
            "edges[2]",
            "edges[3].priority",
            "edges[3].completion_time",
            "edges[4]",
        ] {
            assert!(message.contains(place), "{place}: {message}");
        }
        let message = refusal(&SMALL.replace("[0,1,7,2.5,60]", "[0,1.5,7,2.5]"));
        assert!(message.contains("has 4 entries") && message.contains("names node 1.5"));
    }

    #[test]
    fn every_value_that_is_not_finite_is_reported() {
        let bad = SMALL
            .replace("[0,0,10],[900,0,20]", "[0,NaN,10],[Infinity,0,null]")
            .replace(
                "[0,1,7,2.5,60],[1,2,3,1,0]",
                "[0,NaN,7,2.5,-Infinity],[1,2,1e999,nan,0]",
            )
            .replace("7200", "-inf")
            .replace("\"goal\":2", "\"goal\":NaN");
        let Err(FormatError::Invalid(violations)) = from_json(&bad) else {
            panic!("{bad}");
        };
        let all: Vec<_> = violations
            .list()
            .iter()
            .map(|v| format!("{} {}", v.place, v.message))
            .collect();
        let finite = |place: &str, value: &str| format!("{place} is {value}; give a finite number");
        let node =
            |place: &str| format!("{place} names node NaN; give the index of a node, from 0");
        let expected = [
            finite("budget", "-inf"),
            node("goal"),
            finite("nodes[0].y", "NaN"),
            finite("nodes[1].x", "inf"),
            finite("nodes[1].z", "NaN"),
            finite("edges[0].completion_time", "-inf"),
            node("edges[0]"),
            finite("edges[1].priority", "inf"),
            finite("edges[1].risk", "NaN"),
        ];
        assert_eq!(all, expected);
    }

    #[test]
    fn text_of_another_form_is_refused_with_the_place() {
        let unknown = SMALL.replace("\"speed\"", "\"sped\":1,\"speed\"");
        assert!(refusal(&unknown).contains("line 1") && refusal(&unknown).contains("`sped`"));
        assert!(refusal(&SMALL.replace("2.5", "nought")).contains("line 3, column"));
        assert!(refusal(&SMALL.replace("7,2.5", "NaN,\"2.5\"")).contains("line 3, column"));
        assert!(refusal(&SMALL[..60]).contains("EOF"));
        let nested = SMALL.replace("[0,0,10]", &"[".repeat(10_000));
        assert!(refusal(&nested).contains("line 2"));
        assert!(refusal(&SMALL.replace("auv-route-1", "auv-route-2")).contains("auv-route-2"));
        assert!(refusal(&SMALL.replace("7200", "-1")).contains("budget"));
        let nodes = "[0,0,0],".repeat(Network::MAX_NODES + 1);
        assert!(refusal(&SMALL.replace("[0,0,10],", &nodes)).contains("10000"));
    }

    proptest! {
        #[test]
        fn never_panics_on_a_damaged_file(at in 0_usize..SMALL.len(), byte in 32_u8..127) {
            let mut bytes = SMALL.as_bytes().to_vec();
            bytes[at] = byte;
            let _ = crate::format::read(&bytes, "t");
            let _ = crate::format::read(&bytes[..at], "t");
        }
    }
}
