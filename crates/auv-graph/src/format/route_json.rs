//! `auv-route-1`: an instance as JSON.
//!
//! ```json
//! {"format": "auv-route-1", "name": "two legs", "seed": 1, "directed": false, "speed": 3.0,
//!  "budget": 7200, "start": 0, "goal": 2, "nodes": [[0, 0, 10], [900, 0, 20], [1800, 0, 10]],
//!  "edge_fields": ["i", "j", "rho", "xi", "delta"], "edges": [[0, 1, 7, 2.5, 60], [1, 2, 3, 1, 0]]}
//! ```
//! `nodes` are `[x, y, z]` in metres; an edge leads from node `i` to node `j` (both ways unless
//! `directed`), with priority `rho`, risk `xi` and completion time `delta` in seconds; `speed` is in
//! m/s, `budget` in seconds. `name`, `seed` and `edge_fields` may be left out. A sixth edge field,
//! `length`, gives the way in metres where it is not the straight line.

use super::FormatError;
use crate::{Edge, Instance, Network, NodeId, Task, Waypoint};
use auv_types::{Point3, Violations};
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

const FORMAT: &str = "auv-route-1";
const EDGE_FIELDS: [&str; 6] = ["i", "j", "rho", "xi", "delta", "length"];

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: String,
    #[serde(default)]
    name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
    directed: bool,
    speed: f64,
    budget: f64,
    start: u32,
    goal: u32,
    nodes: Rows<{ Network::MAX_NODES }>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    edge_fields: Option<Vec<String>>,
    edges: Rows<{ Network::MAX_EDGES }>,
}

/// What is wrong, without serde_json's own " at line 1 column 2", and what to give instead.
fn explained(text: &str, error: &serde_json::Error) -> String {
    if text.contains("\"obstacles\"") {
        return format!("this is a scene for a path planner; {FORM}");
    }
    let message = error.to_string();
    let end = message.rfind(" at line ").unwrap_or(message.len());
    format!("{}; {FORM}", &message[..end])
}

/// What an instance looks like.
const FORM: &str = "give one complete JSON object with format `auv-route-1`, directed, speed, budget, start, goal, \
                    nodes [[x, y, z], ...] and edges [[i, j, priority, risk, completion time], ...]";

/// Reads an `auv-route-1` object.
///
/// # Errors
/// The first place where it is not JSON of that shape (unknown keys included); else every offender
/// among its values.
pub fn from_json(text: &str) -> Result<Instance, FormatError> {
    if text.len() > super::MAX_FILE_BYTES {
        return Err(FormatError::TooLarge { bytes: text.len() });
    }
    let file: File = serde_json::from_str(text).map_err(|error| FormatError::Syntax {
        line: error.line(),
        column: error.column(),
        message: explained(text, &error),
    })?;
    let mut violations = Violations::new();
    violations.require(file.format == FORMAT, "format", || {
        format!(
            "is `{}`; this version reads `{FORMAT}`",
            super::shortened(&file.format)
        )
    });
    let num_fields = file.edge_fields.as_ref().map_or(5, Vec::len);
    let known = file.edge_fields.as_ref().is_none_or(|given| {
        (5..=6).contains(&num_fields) && given[..] == EDGE_FIELDS[..num_fields]
    });
    violations.require(known, "edge_fields", || {
        format!("is not {:?}, with or without the last", EDGE_FIELDS)
    });
    let waypoints = file.waypoints(&mut violations);
    let edges = file.edges(if known { num_fields } else { 5 }, &mut violations);
    violations.into_result()?;
    let network = Network::new(&waypoints, &edges, file.speed)?;
    let ends = (NodeId(file.start), NodeId(file.goal));
    let mut instance = Instance::new(file.name, network, ends, file.budget)?;
    instance.seed = file.seed;
    Ok(instance)
}

/// Writes an instance as `auv-route-1`, so that [`from_json`] gives the same instance again; names
/// of waypoints are not kept.
///
/// # Errors
/// [`FormatError::NotExpressible`] where some edges are directed and others are not.
pub fn to_json(instance: &Instance) -> Result<String, FormatError> {
    let network = &instance.network;
    let directed = network.edges().first().is_some_and(|edge| edge.directed);
    if network.edges().iter().any(|edge| edge.directed != directed) {
        let both = "directed beside undirected edges; give each direction its own edge";
        return Err(FormatError::NotExpressible(both.into()));
    }
    let nodes = network
        .waypoints()
        .iter()
        .map(|w| Row::new(w.position.coords.as_slice()));
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
        Row::new(&fields[..num_fields])
    };
    let file = File {
        format: FORMAT.into(),
        name: instance.name.clone(),
        seed: instance.seed,
        directed,
        speed: network.speed_mps(),
        budget: instance.budget_s,
        start: instance.start.0,
        goal: instance.destination.0,
        nodes: Rows(nodes.collect()),
        edge_fields: Some(
            EDGE_FIELDS[..num_fields]
                .iter()
                .map(|&f| f.into())
                .collect(),
        ),
        edges: Rows(network.edges().iter().map(row).collect()),
    };
    serde_json::to_string(&file).map_err(|error| FormatError::NotExpressible(error.to_string()))
}

impl File {
    fn waypoints(&self, violations: &mut Violations) -> Vec<Waypoint> {
        let mut waypoints = Vec::with_capacity(self.nodes.0.len());
        for (i, row) in self.nodes.0.iter().enumerate() {
            violations.require(row.len == 3, &format!("nodes[{i}]"), || {
                format!("has {} entries; give [x, y, z] in metres", row.len)
            });
            let [x, y, z, ..] = row.values;
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
            let mut node = |value: f64| {
                let whole = value.fract() == 0.0 && (0.0..f64::from(u32::MAX)).contains(&value);
                violations.require(whole, &place, || {
                    format!("names node {value}; give the index of a node, from 0")
                });
                value as u32
            };
            edges.push(Edge {
                from: node(from),
                to: node(to),
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

/// A short array of numbers; of a longer one only the length is kept.
#[derive(Clone, Copy)]
struct Row {
    values: [f64; 6],
    len: usize,
}

impl Row {
    fn new(numbers: &[f64]) -> Self {
        let mut values = [0.0; 6];
        values[..numbers.len()].copy_from_slice(numbers);
        Self {
            values,
            len: numbers.len(),
        }
    }
}

impl Serialize for Row {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(&self.values[..self.len])
    }
}

impl<'de> Deserialize<'de> for Row {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Numbers;
        impl<'de> Visitor<'de> for Numbers {
            type Value = Row;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an array of numbers")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Row, A::Error> {
                let mut row = Row::new(&[]);
                while let Some(value) = seq.next_element::<f64>()? {
                    if let Some(slot) = row.values.get_mut(row.len) {
                        *slot = value;
                    }
                    row.len += 1;
                }
                Ok(row)
            }
        }
        deserializer.deserialize_seq(Numbers)
    }
}

/// An array of at most `MOST` rows; reading stops at the first beyond.
struct Rows<const MOST: usize>(Vec<Row>);

impl<const MOST: usize> Serialize for Rows<MOST> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(&self.0)
    }
}

impl<'de, const MOST: usize> Deserialize<'de> for Rows<MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Bounded<const MOST: usize>;
        impl<'de, const MOST: usize> Visitor<'de> for Bounded<MOST> {
            type Value = Rows<MOST>;

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
                Ok(Rows(rows))
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
    fn reads_what_it_writes() {
        let instance = from_json(SMALL).unwrap();
        assert_eq!(from_json(&to_json(&instance).unwrap()).unwrap(), instance);
    }

    #[test]
    fn names_every_offender() {
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
    fn says_where_it_is_no_json_of_the_shape() {
        let unknown = SMALL.replace("\"speed\"", "\"sped\":1,\"speed\"");
        assert!(refusal(&unknown).contains("line 1") && refusal(&unknown).contains("`sped`"));
        assert!(refusal(&SMALL.replace("2.5", "NaN")).contains("line 3, column"));
        assert!(refusal(&SMALL.replace("2.5", "1e999")).contains("line 3, column"));
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
