//! The network of a mission file: tasks, listed edges, edges found by themselves.

use super::document::{Connect, MissionFile};
use super::ways::{Way, Ways};
use auv_graph::{ArcId, Edge, EdgeId, Network, NodeId, Task, Waypoint};
use auv_types::{Point3, Violations};
use std::collections::{BTreeMap, BTreeSet};

/// A network with what belongs to its arcs.
pub(super) struct Charted {
    pub(super) network: Network,
    pub(super) guides: BTreeMap<ArcId, Vec<Point3<f64>>>,
    /// Edges that carry the same task: those to a waypoint with one.
    pub(super) shared_tasks: Vec<Vec<EdgeId>>,
}

/// One edge while the network is drawn.
struct EdgeDraft {
    edge: Edge,
    way: Way,
    /// The waypoint whose task it carries.
    visits: Option<usize>,
}

struct Drawing<'a> {
    file: &'a MissionFile,
    places: &'a [Point3<f64>],
    ways: &'a Ways<'a>,
    /// Tasks of the waypoints.
    tasks: Vec<Option<Task>>,
    drafts: Vec<EdgeDraft>,
    joined: BTreeSet<(usize, usize)>,
}

/// The index of a waypoint by name.
pub(super) fn node_of(file: &MissionFile, name: &str) -> Option<usize> {
    file.waypoints
        .iter()
        .position(|waypoint| waypoint.name == name)
}

/// Builds the network for a vehicle of this speed.
pub(super) fn network(
    file: &MissionFile,
    places: &[Point3<f64>],
    ways: &Ways<'_>,
    speed_mps: f64,
    violations: &mut Violations,
) -> Option<Charted> {
    let tasks = waypoint_tasks(file, violations);
    let mut drawing = Drawing {
        file,
        places,
        ways,
        tasks,
        drafts: Vec::new(),
        joined: BTreeSet::new(),
    };
    drawing.list(violations);
    if let Some(connect) = &file.connect {
        drawing.connect(connect, violations);
    }
    if !violations.is_empty() {
        return None;
    }
    let waypoints: Vec<Waypoint> = file
        .waypoints
        .iter()
        .zip(places)
        .map(|(entry, position)| Waypoint {
            position: *position,
            name: entry.name.clone(),
        })
        .collect();
    let edges: Vec<Edge> = drawing.drafts.iter().map(|draft| draft.edge).collect();
    match Network::new(&waypoints, &edges, speed_mps) {
        Ok(network) => Some(drawing.charted(network)),
        Err(wrong) => {
            violations.absorb("", wrong);
            None
        }
    }
}

/// The task of every waypoint that has one; unknown names and malformed tasks are noted.
fn waypoint_tasks(file: &MissionFile, violations: &mut Violations) -> Vec<Option<Task>> {
    for (name, task) in &file.tasks {
        let place = |key: &str| format!("tasks.{name}.{key}");
        violations.require_not_negative(task.priority, &place("priority"));
        violations.require_positive(task.risk, &place("risk"));
        violations.require_not_negative(task.time_s, &place("time_s"));
    }
    let of = |(i, waypoint): (usize, &super::document::WaypointEntry)| {
        let name = waypoint.task.as_deref()?;
        let place = format!("waypoints[{i}] ({}).task", waypoint.name);
        task_called(file, name, &place, violations)
    };
    file.waypoints.iter().enumerate().map(of).collect()
}

fn task_called(
    file: &MissionFile,
    name: &str,
    place: &str,
    violations: &mut Violations,
) -> Option<Task> {
    let task = file.tasks.get(name);
    violations.require(task.is_some(), place, || {
        format!("names the task {name}, which [tasks] does not have; add it or correct the name")
    });
    task.map(|task| Task {
        priority: task.priority,
        risk: task.risk,
        completion_time_s: task.time_s,
    })
}

impl Drawing<'_> {
    /// The edges the file lists.
    fn list(&mut self, violations: &mut Violations) {
        for (i, entry) in self.file.edges.iter().enumerate() {
            let place = format!("edges[{i}] ({} - {})", entry.from, entry.to);
            let ends = [&entry.from, &entry.to].map(|name| {
                let node = node_of(self.file, name);
                violations.require(node.is_some(), &place, || {
                    format!("names the waypoint {name}, which there is not; correct the name")
                });
                node
            });
            let [Some(from), Some(to)] = ends else {
                continue;
            };
            let own = entry
                .task
                .as_deref()
                .map(|name| task_called(self.file, name, &place, violations));
            if from == to {
                violations.push(place, "leads from a waypoint to itself; remove it");
                continue;
            }
            let fresh = !self.joined.contains(&(from, to))
                && (entry.directed || !self.joined.contains(&(to, from)));
            violations.require(fresh, &place, || {
                "connects what an edge before it connects already; keep one".into()
            });
            let Some(way) = self.ways.between(&self.places[from], &self.places[to]) else {
                violations.push(
                    place,
                    "has no way through water deep enough for it; remove it or move its ends",
                );
                continue;
            };
            if fresh {
                self.join(from, to, entry.directed, own.flatten(), way);
            }
        }
    }

    /// Joins two waypoints: by the task given, else by the tasks of the ends.
    fn join(&mut self, from: usize, to: usize, directed: bool, own: Option<Task>, way: Way) {
        let (there, back) = (self.tasks[to], self.tasks[from]);
        let length_m = (!way.is_straight()).then_some(way.length_m);
        let mut draw = |from: usize, to: usize, directed, task: Option<Task>, visits, way| {
            self.drafts.push(EdgeDraft {
                edge: Edge {
                    from: from as u32,
                    to: to as u32,
                    directed,
                    task: task.unwrap_or(Task::TRANSIT),
                    distance_m: length_m,
                },
                way,
                visits,
            });
        };
        let same = own.is_some() || (there.is_none() && back.is_none());
        if directed {
            let task = own.or(there);
            let visits = (own.is_none() && there.is_some()).then_some(to);
            draw(from, to, true, task, visits, way);
        } else if same {
            draw(from, to, false, own, None, way);
        } else {
            let mut reversed = way.clone();
            reversed.points.reverse();
            draw(from, to, true, there, there.map(|_| to), way);
            draw(to, from, true, back, back.map(|_| from), reversed);
        }
        self.joined.insert((from, to));
        if !directed {
            self.joined.insert((to, from));
        }
    }

    /// Every waypoint with its nearest by water.
    fn connect(&mut self, connect: &Connect, violations: &mut Violations) {
        let n = self.places.len();
        let within_m = connect.within_m.unwrap_or(f64::INFINITY);
        violations.require(
            (1..=1_000).contains(&connect.nearest),
            "connect.nearest",
            || format!("is {}; give 1 to 1000", connect.nearest),
        );
        let limited = connect.within_m.is_none_or(|m| m > 0.0 && m.is_finite());
        violations.require(limited, "connect.within_m", || {
            format!("is {within_m}; give metres above 0")
        });
        violations.require(n <= 2_000, "connect", || {
            format!("is for at most 2000 waypoints; list the edges of {n}")
        });
        for name in &connect.except {
            violations.require(node_of(self.file, name).is_some(), "connect.except", || {
                format!("names the waypoint {name}, which there is not; correct the name")
            });
        }
        if !violations.is_empty() {
            return;
        }
        let free: Vec<usize> = (0..n)
            .filter(|&i| !connect.except.contains(&self.file.waypoints[i].name))
            .collect();
        let mut found: BTreeMap<(usize, usize), Option<Way>> = BTreeMap::new();
        let mut pairs = BTreeSet::new();
        for &i in &free {
            // Ways are no shorter than straight lines: of the nearest by those, the nearest by water.
            let apart_m = |j: usize| (self.places[j] - self.places[i]).norm();
            let mut near: Vec<usize> = free.iter().copied().filter(|&j| j != i).collect();
            near.sort_by(|&a, &b| apart_m(a).total_cmp(&apart_m(b)).then(a.cmp(&b)));
            let mut by_water: Vec<(f64, usize)> = Vec::new();
            for j in near {
                by_water.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                by_water.truncate(connect.nearest);
                let full = by_water.len() == connect.nearest;
                let worst_m = by_water.last().map_or(f64::INFINITY, |(m, _)| *m);
                if apart_m(j) > within_m || (full && apart_m(j) >= worst_m) {
                    break;
                }
                let pair = (i.min(j), i.max(j));
                let way = found.entry(pair).or_insert_with(|| {
                    self.ways
                        .between(&self.places[pair.0], &self.places[pair.1])
                });
                if let Some(way) = way.as_ref().filter(|way| way.length_m <= within_m) {
                    by_water.push((way.length_m, j));
                }
            }
            by_water.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            by_water.truncate(connect.nearest);
            pairs.extend(by_water.iter().map(|&(_, j)| (i.min(j), i.max(j))));
        }
        for pair in pairs {
            let listed = self.joined.contains(&pair) || self.joined.contains(&(pair.1, pair.0));
            if let (false, Some(Some(way))) = (listed, found.remove(&pair)) {
                self.join(pair.0, pair.1, false, None, way);
            }
        }
    }

    fn charted(self, network: Network) -> Charted {
        let mut guides = BTreeMap::new();
        let mut visits: BTreeMap<usize, Vec<EdgeId>> = BTreeMap::new();
        for (i, draft) in self.drafts.into_iter().enumerate() {
            if let Some(node) = draft.visits {
                visits.entry(node).or_default().push(EdgeId(i as u32));
            }
            if draft.way.is_straight() {
                continue;
            }
            let (from, to) = (NodeId(draft.edge.from), NodeId(draft.edge.to));
            let mut points = draft.way.points;
            if let Some(arc) = network.arc_between(from, to) {
                guides.insert(arc, points.clone());
            }
            if let (false, Some(arc)) = (draft.edge.directed, network.arc_between(to, from)) {
                points.reverse();
                guides.insert(arc, points);
            }
        }
        Charted {
            network,
            guides,
            shared_tasks: visits.into_values().collect(),
        }
    }
}
