//! The optional keys of `auv-route-1` for routes in time.
//!
//! ```json
//! "tasks": [{"id": "cast 1", "node": 3, "rho": 8, "xi": 2, "delta": 600, "windows": [[0, 3600]],
//!            "mandatory": true, "after": ["line 1"], "chain": "box"}],
//! "chains": {"box": {"split": false}},
//! "profiles": {"times": [0, 1800], "travel": {"0": [300, 420], "0-": [300, 250]}},
//! "visits": {"nodes": [4], "every_s": 3600}, "destinations": [0, 9], "may_wait": true
//! ```
//! The book's page on routes in time gives their meaning.

use super::number::JsonNumber;
use super::text::shortened;
use crate::ids::{ArcId, EdgeId, NodeId};
use crate::network::Network;
use crate::profile::Profiles;
use crate::time_model::{Chain, Passing, TimeModel, Visits};
use crate::timed_task::{TaskName, TaskPlace, TimedTask};
use crate::waypoint::Task;
use auv_types::Violations;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Most tasks a file may list.
const MAX_TASKS: usize = 10_000;

/// The keys, each absent in files without time.
#[derive(Default)]
pub(super) struct TimeKeys {
    pub(super) tasks: Option<Vec<TaskRow>>,
    pub(super) chains: Option<BTreeMap<String, ChainRow>>,
    pub(super) profiles: Option<ProfileRows>,
    pub(super) visits: Option<VisitsRow>,
    pub(super) destinations: Option<Vec<u32>>,
    pub(super) may_wait: Option<bool>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TaskRow {
    id: TaskName,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    node: Option<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    edge: Option<u32>,
    rho: JsonNumber,
    xi: JsonNumber,
    #[serde(default = "zero")]
    delta: JsonNumber,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    windows: Vec<[JsonNumber; 2]>,
    #[serde(default)]
    mandatory: bool,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    after: Vec<TaskName>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    chain: Option<String>,
}

fn zero() -> JsonNumber {
    JsonNumber(0.0)
}

#[derive(Serialize, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct ChainRow {
    #[serde(default)]
    split: bool,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ProfileRows {
    times: Vec<JsonNumber>,
    travel: BTreeMap<String, Vec<JsonNumber>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct VisitsRow {
    nodes: Vec<u32>,
    every_s: JsonNumber,
}

impl TimeKeys {
    fn is_absent(&self) -> bool {
        self.tasks.is_none()
            && self.chains.is_none()
            && self.profiles.is_none()
            && self.visits.is_none()
            && self.destinations.is_none()
            && self.may_wait.is_none()
    }

    /// The model that the keys describe; none if the file has none of them.
    pub(super) fn model(self, network: &Network) -> Result<Option<TimeModel>, Violations> {
        if self.is_absent() {
            return Ok(None);
        }
        let mut violations = Violations::new();
        let rows = self.tasks.unwrap_or_default();
        violations.require(rows.len() <= MAX_TASKS, "tasks", || {
            format!("has {} entries; at most {MAX_TASKS} are read", rows.len())
        });
        violations.into_result()?;
        let mut violations = Violations::new();
        let (tasks, chains) = tasks(&rows, self.chains.unwrap_or_default(), &mut violations);
        let profiles = self.profiles.map(|rows| rows.profiles(network));
        let profiles = profiles.unwrap_or_else(|| Ok(Profiles::default()));
        let profiles = profiles.unwrap_or_else(|found| {
            violations.absorb("", found);
            Profiles::default()
        });
        let model = TimeModel {
            tasks,
            chains,
            profiles,
            visits: self.visits.map(|row| Visits {
                nodes: row.nodes.into_iter().map(NodeId).collect(),
                every_s: row.every_s.0,
            }),
            destinations: self
                .destinations
                .unwrap_or_default()
                .into_iter()
                .map(NodeId)
                .collect(),
            may_wait: self.may_wait.unwrap_or(true),
            passing: Passing::Free,
        };
        violations.absorb("", model.validate(network));
        violations.into_result()?;
        Ok(Some(model))
    }

    /// The keys that describe a model.
    pub(super) fn of(model: Option<&TimeModel>, network: &Network) -> Self {
        let Some(model) = model else {
            return Self::default();
        };
        let row = |task: &TimedTask| task_row(task, model);
        let chain = |chain: &Chain| {
            let split = chain.may_split;
            (chain.name.clone(), ChainRow { split })
        };
        let visits = |visits: &Visits| VisitsRow {
            nodes: visits.nodes.iter().map(|node| node.0).collect(),
            every_s: JsonNumber(visits.every_s),
        };
        let nodes = |nodes: &[NodeId]| nodes.iter().map(|node| node.0).collect();
        Self {
            tasks: Some(model.tasks.iter().map(row).collect()),
            chains: Some(model.chains.iter().map(chain).collect()),
            profiles: (!model.profiles.is_empty()).then(|| ProfileRows::of(model, network)),
            visits: model.visits.as_ref().map(visits),
            destinations: (!model.destinations.is_empty()).then(|| nodes(&model.destinations)),
            may_wait: Some(model.may_wait),
        }
    }
}

/// The tasks, and the chains in the order of their names.
fn tasks(
    rows: &[TaskRow],
    named: BTreeMap<String, ChainRow>,
    violations: &mut Violations,
) -> (Vec<TimedTask>, Vec<Chain>) {
    let mut chains = named;
    for name in rows.iter().filter_map(|row| row.chain.as_ref()) {
        chains.entry(name.clone()).or_default();
    }
    let index: BTreeMap<_, _> = rows.iter().map(|row| &row.id).zip(0..).collect();
    let chain_names: Vec<_> = chains.keys().cloned().collect();
    let mut tasks = Vec::with_capacity(rows.len());
    for (i, row) in rows.iter().enumerate() {
        let place = format!("tasks[{i}] ({})", row.id);
        let after = row.after.iter().filter_map(|name| {
            let known = index.get(name).copied();
            violations.require(known.is_some(), &format!("{place}.after"), || {
                format!("names `{}`, which is no id", shortened(&name.to_string()))
            });
            known
        });
        let after = after.collect();
        let at = match (row.node, row.edge) {
            (Some(node), None) => TaskPlace::Node(NodeId(node)),
            (None, Some(edge)) => TaskPlace::Edge(EdgeId(edge)),
            _ => {
                violations.push(&*place, "gives no place or two; give `node` or `edge`");
                continue;
            }
        };
        tasks.push(TimedTask {
            name: row.id.clone(),
            place: at,
            task: Task {
                priority: row.rho.0,
                risk: row.xi.0,
                completion_time_s: row.delta.0,
            },
            windows: merged(&row.windows),
            mandatory: row.mandatory,
            after,
            chain: row
                .chain
                .as_ref()
                .and_then(|name| chain_names.binary_search(name).ok()),
        });
    }
    let chains = chains.into_iter().map(|(name, row)| Chain {
        name,
        may_split: row.split,
    });
    (tasks, chains.collect())
}

/// Windows in ascending order, those that touch made one.
fn merged(windows: &[[JsonNumber; 2]]) -> Vec<[f64; 2]> {
    let mut sorted: Vec<_> = windows.iter().map(|w| [w[0].0, w[1].0]).collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut merged: Vec<[f64; 2]> = Vec::with_capacity(sorted.len());
    for window in sorted {
        match merged.last_mut() {
            Some(last) if window[0] <= last[1] && window[0] <= window[1] => {
                last[1] = last[1].max(window[1]);
            }
            _ => merged.push(window),
        }
    }
    merged
}

fn task_row(task: &TimedTask, model: &TimeModel) -> TaskRow {
    let (node, edge) = match task.place {
        TaskPlace::Node(node) => (Some(node.0), None),
        TaskPlace::Edge(edge) => (None, Some(edge.0)),
    };
    let numbers = |window: &[f64; 2]| window.map(JsonNumber);
    TaskRow {
        id: task.name.clone(),
        node,
        edge,
        rho: JsonNumber(task.task.priority),
        xi: JsonNumber(task.task.risk),
        delta: JsonNumber(task.task.completion_time_s),
        windows: task.windows.iter().map(numbers).collect(),
        mandatory: task.mandatory,
        after: task
            .after
            .iter()
            .map(|&i| model.tasks[i].name.clone())
            .collect(),
        chain: task.chain.map(|chain| model.chains[chain].name.clone()),
    }
}

impl ProfileRows {
    fn profiles(self, network: &Network) -> Result<Profiles, Violations> {
        let mut violations = Violations::new();
        let (mut travel_s, mut names) = (BTreeMap::new(), BTreeMap::new());
        for (key, row) in self.travel {
            let Some(arc) = arc_named(&key, network) else {
                let message = "names no arc; give the index of an edge, with `-` behind it for the other way \
                               of an undirected edge";
                let key = shortened(&key);
                violations.push(format!("profiles.travel.{key}"), message);
                continue;
            };
            travel_s.insert(arc, row.into_iter().map(|number| number.0).collect());
            names.insert(arc, key);
        }
        let times_s = self.times.into_iter().map(|number| number.0).collect();
        let name = |arc: ArcId| format!("profiles.travel.{}", names[&arc]);
        let profiles = Profiles::new(times_s, travel_s, name);
        if let Err(found) = &profiles {
            violations.absorb("", found.clone());
        }
        violations.into_result()?;
        profiles
    }

    fn of(model: &TimeModel, network: &Network) -> Self {
        let key = |arc: ArcId| {
            let arc = &network.arcs()[arc.index()];
            let is_forward = network.edges()[arc.edge.index()].from == arc.tail.0;
            format!("{}{}", arc.edge.0, if is_forward { "" } else { "-" })
        };
        let numbers = |times: &[f64]| times.iter().copied().map(JsonNumber).collect();
        Self {
            times: numbers(model.profiles.times_s()),
            travel: model
                .profiles
                .arcs()
                .map(|(arc, travel)| (key(arc), numbers(travel)))
                .collect(),
        }
    }
}

/// The arc of `EDGE`, or of `EDGE-` the other way.
fn arc_named(key: &str, network: &Network) -> Option<ArcId> {
    let (number, is_back) = match key.strip_suffix('-') {
        Some(number) => (number, true),
        None => (key, false),
    };
    let edge = network.edges().get(number.parse::<usize>().ok()?)?;
    let (from, to) = (NodeId(edge.from), NodeId(edge.to));
    match is_back {
        false => network.arc_between(from, to),
        true if edge.directed => None,
        true => network.arc_between(to, from),
    }
}
