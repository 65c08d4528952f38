//! The network: waypoints, arcs and their tasks in compact adjacency.

use crate::ids::{ArcId, EdgeId, NodeId};
use crate::waypoint::{Edge, Task, Waypoint};
use auv_types::Violations;
use std::ops::Range;

/// An edge in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkArc {
    /// The node it leaves.
    pub tail: NodeId,
    /// The node it leads to.
    pub head: NodeId,
    /// The edge it belongs to.
    pub edge: EdgeId,
    /// Length in metres (Eq. 6).
    pub distance_m: f64,
    /// Travel and task time in seconds (Eq. 7).
    pub time_s: f64,
    /// The task's weight (Eq. 9).
    pub weight: f64,
}

/// Waypoints connected by arcs. A network is immutable: removed edges are an
/// [`EdgeSet`](crate::EdgeSet) beside it and changed times a slice beside it, so a replan copies nothing.
/// With the feature `serde` it is written as its waypoints, edges and speed, and checked when it is read.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    waypoints: Vec<Waypoint>,
    edges: Vec<Edge>,
    speed_mps: f64,
    undirected: bool,
    /// Arcs out of node `i` are `arcs[first[i]..first[i + 1]]`.
    first: Vec<u32>,
    arcs: Vec<NetworkArc>,
    /// Heads, times and weights of the arcs in arrays of their own, for searches that read nothing else.
    heads: Vec<NodeId>,
    times_s: Vec<f64>,
    weights: Vec<f64>,
}

impl Network {
    /// Most waypoints a network may have.
    pub const MAX_NODES: usize = 10_000;
    /// Most edges a network may have.
    pub const MAX_EDGES: usize = 1_000_000;

    /// Builds a network for a vehicle that travels at `speed_mps`.
    ///
    /// Complexity: O(n + m log m).
    ///
    /// # Errors
    /// All of: no or too many waypoints or edges, a coordinate that is not finite, unknown end
    /// points, self-loops, duplicate arcs, a priority, time or length that is negative or not finite, a
    /// risk or speed that is not positive.
    pub fn new(waypoints: &[Waypoint], edges: &[Edge], speed_mps: f64) -> Result<Self, Violations> {
        let mut violations = Violations::new();
        check(waypoints, edges, speed_mps, &mut violations);
        violations.into_result()?;

        let mut arcs = Vec::with_capacity(2 * edges.len());
        for (index, edge) in edges.iter().enumerate() {
            let (tail, head) = (NodeId(edge.from), NodeId(edge.to));
            let straight_m =
                (waypoints[head.index()].position - waypoints[tail.index()].position).norm();
            let distance_m = edge.distance_m.unwrap_or(straight_m);
            let arc = NetworkArc {
                tail,
                head,
                edge: EdgeId(index as u32),
                distance_m,
                time_s: distance_m / speed_mps + edge.task.completion_time_s,
                weight: edge.task.weight(),
            };
            arcs.push(arc);
            if !edge.directed {
                arcs.push(NetworkArc {
                    tail: head,
                    head: tail,
                    ..arc
                });
            }
        }
        arcs.sort_by_key(|arc| (arc.tail, arc.head));
        let mut first = vec![0_u32; waypoints.len() + 1];
        for arc in &arcs {
            first[arc.tail.index() + 1] += 1;
        }
        for node in 0..waypoints.len() {
            first[node + 1] += first[node];
        }
        Ok(Self {
            waypoints: waypoints.to_vec(),
            edges: edges.to_vec(),
            speed_mps,
            undirected: edges.iter().all(|edge| !edge.directed),
            first,
            heads: arcs.iter().map(|arc| arc.head).collect(),
            times_s: arcs.iter().map(|arc| arc.time_s).collect(),
            weights: arcs.iter().map(|arc| arc.weight).collect(),
            arcs,
        })
    }

    /// Number of waypoints.
    #[must_use]
    pub fn num_nodes(&self) -> usize {
        self.waypoints.len()
    }

    /// Number of edges; an undirected edge counts once.
    #[must_use]
    pub fn num_edges(&self) -> usize {
        self.edges.len()
    }

    /// All waypoints, by [`NodeId`].
    #[must_use]
    pub fn waypoints(&self) -> &[Waypoint] {
        &self.waypoints
    }

    /// All edges, by [`EdgeId`].
    #[must_use]
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// All arcs, by [`ArcId`].
    #[must_use]
    #[inline]
    pub fn arcs(&self) -> &[NetworkArc] {
        &self.arcs
    }

    /// The heads of all arcs, by [`ArcId`].
    #[must_use]
    #[inline]
    pub fn heads(&self) -> &[NodeId] {
        &self.heads
    }

    /// The times of all arcs in seconds (Eq. 7), by [`ArcId`].
    #[must_use]
    #[inline]
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// The weights of all arcs' tasks (Eq. 9), by [`ArcId`].
    #[must_use]
    #[inline]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The speed that the arcs' times assume, m/s.
    #[must_use]
    pub fn speed_mps(&self) -> f64 {
        self.speed_mps
    }

    /// Whether every edge is undirected.
    #[must_use]
    pub fn is_undirected(&self) -> bool {
        self.undirected
    }

    /// Whether a node belongs to the network.
    #[must_use]
    pub fn has_node(&self, node: NodeId) -> bool {
        node.index() < self.waypoints.len()
    }

    /// A waypoint's name, or its number where it has none or is not in the network.
    #[must_use]
    pub fn name_of(&self, node: NodeId) -> String {
        match self.waypoints.get(node.index()) {
            Some(waypoint) if !waypoint.name.is_empty() => waypoint.name.clone(),
            _ => node.0.to_string(),
        }
    }

    /// The first waypoint of that name, if there is one; [`Network::waypoint`] tells which name is missing.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<NodeId> {
        let at = self.waypoints.iter().position(|w| w.name == name)?;
        Some(NodeId(at as u32))
    }

    /// The task of an edge.
    #[must_use]
    #[inline]
    pub fn task(&self, edge: EdgeId) -> Task {
        self.edges[edge.index()].task
    }

    /// The ids of the arcs out of a node, by ascending head.
    #[must_use]
    #[inline]
    pub fn range_from(&self, node: NodeId) -> Range<usize> {
        self.first[node.index()] as usize..self.first[node.index() + 1] as usize
    }

    /// The arcs out of a node with their ids, by ascending head.
    #[inline]
    pub fn arcs_from(
        &self,
        node: NodeId,
    ) -> impl DoubleEndedIterator<Item = (ArcId, &NetworkArc)> + '_ {
        let range = self.range_from(node);
        let first = range.start;
        self.arcs[range]
            .iter()
            .enumerate()
            .map(move |(i, arc)| (ArcId((first + i) as u32), arc))
    }

    /// The arc from one node to another, if there is one. Complexity: O(log of the out-degree).
    #[must_use]
    pub fn arc_between(&self, tail: NodeId, head: NodeId) -> Option<ArcId> {
        if !self.has_node(tail) || !self.has_node(head) {
            return None;
        }
        let range = self.range_from(tail);
        let at = self.heads[range.clone()].binary_search(&head).ok()?;
        Some(ArcId((range.start + at) as u32))
    }

    /// The time of an arc in seconds: from `times`, by [`ArcId`], if given, else Eq. 7.
    #[must_use]
    #[inline]
    pub fn arc_time_s(&self, arc: ArcId, times: Option<&[f64]>) -> f64 {
        times.unwrap_or(&self.times_s)[arc.index()]
    }
}

fn check(waypoints: &[Waypoint], edges: &[Edge], speed_mps: f64, violations: &mut Violations) {
    violations.require_positive(speed_mps, "speed");
    violations.require(!waypoints.is_empty(), "nodes", || {
        "is empty; give at least one".into()
    });
    violations.require(waypoints.len() <= Network::MAX_NODES, "nodes", || {
        format!(
            "has {} entries; at most {} are allowed",
            waypoints.len(),
            Network::MAX_NODES
        )
    });
    violations.require(edges.len() <= Network::MAX_EDGES, "edges", || {
        format!(
            "has {} entries; at most {} are allowed",
            edges.len(),
            Network::MAX_EDGES
        )
    });
    if violations.total() > 0 {
        return;
    }
    for (i, waypoint) in waypoints.iter().enumerate() {
        let p = &waypoint.position;
        let far = p.iter().any(|x| !x.is_finite() || x.abs() > 1e7);
        violations.require(
            !far,
            &format!("nodes[{i}]{}", named(waypoints, &[i as u32])),
            || {
                format!(
                    "is at [{:?}, {:?}, {:?}]; give finite coordinates within 10,000 km",
                    p.x, p.y, p.z
                )
            },
        );
    }
    for (i, edge) in edges.iter().enumerate() {
        check_edge(i, edge, waypoints, violations);
    }
    check_duplicates(edges, waypoints, violations);
}

/// The names of nodes in brackets, where they have names.
fn named(waypoints: &[Waypoint], nodes: &[u32]) -> String {
    let names = nodes.iter().filter_map(|&node| {
        let name = &waypoints.get(node as usize)?.name;
        (!name.is_empty()).then_some(name.as_str())
    });
    let names: Vec<&str> = names.collect();
    if names.len() < nodes.len() {
        return String::new();
    }
    format!(" ({})", names.join(" - "))
}

/// An edge by its number, and by the names of its ends.
fn edge_named(i: usize, edge: &Edge, waypoints: &[Waypoint]) -> String {
    format!("edges[{i}]{}", named(waypoints, &[edge.from, edge.to]))
}

/// Reports every edge that has an arc in common with an earlier edge.
fn check_duplicates(edges: &[Edge], waypoints: &[Waypoint], violations: &mut Violations) {
    let mut arcs = Vec::with_capacity(2 * edges.len());
    for (i, edge) in edges.iter().enumerate() {
        arcs.push((edge.from, edge.to, i));
        if !edge.directed && edge.from != edge.to {
            arcs.push((edge.to, edge.from, i));
        }
    }
    arcs.sort_unstable();
    let mut again: Vec<_> = arcs
        .windows(2)
        .filter(|pair| (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1))
        .map(|pair| (pair[1].2, pair[0].2))
        .collect();
    again.sort_unstable();
    again.dedup_by_key(|(i, _)| *i);
    for (i, first) in again {
        let Edge { from, to, .. } = edges[i];
        violations.push(
            edge_named(i, &edges[i], waypoints),
            format!("connects nodes {from} and {to} as edges[{first}] does; keep one"),
        );
    }
}

fn check_edge(i: usize, edge: &Edge, waypoints: &[Waypoint], violations: &mut Violations) {
    let (place, num_nodes) = (edge_named(i, edge, waypoints), waypoints.len());
    for end in [edge.from, edge.to] {
        violations.require((end as usize) < num_nodes, &place, || {
            format!("names node {end}; nodes are 0 to {}", num_nodes - 1)
        });
    }
    violations.require(edge.from != edge.to, &place, || {
        format!("leads from node {} to itself; remove it", edge.from)
    });
    let Task {
        priority,
        risk,
        completion_time_s,
    } = edge.task;
    let most = 1e12;
    violations.require(
        (0.0..=most).contains(&priority),
        &format!("{place}.priority"),
        || format!("is {priority}; give a value from 0 to 1e12"),
    );
    violations.require(
        risk > 1e-12 && risk <= most,
        &format!("{place}.risk"),
        || format!("is {risk}; give a value above 0 (risk is in percent points)"),
    );
    violations.require(
        (0.0..=most).contains(&completion_time_s),
        &format!("{place}.completion_time"),
        || format!("is {completion_time_s}; give seconds from 0 to 1e12"),
    );
    if let Some(distance_m) = edge.distance_m {
        violations.require(
            distance_m >= 0.0 && distance_m <= most,
            &format!("{place}.distance"),
            || format!("is {distance_m}; give metres from 0 to 1e12"),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Point3;

    #[test]
    fn every_offender_is_reported() {
        let waypoints = [0.0, 1.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 0.0)));
        let task = Task {
            priority: 1.0,
            risk: 1.0,
            completion_time_s: 0.0,
        };
        let bad = [
            Edge::directed(0, 0, task),
            Edge::directed(0, 7, task),
            Edge::directed(0, 1, Task { risk: 0.0, ..task }),
            Edge::directed(
                1,
                0,
                Task {
                    priority: f64::NAN,
                    ..task
                },
            ),
        ];
        assert_eq!(Network::new(&waypoints, &bad, 3.0).unwrap_err().total(), 4);
        let twice = [Edge::undirected(0, 1, task), Edge::directed(1, 0, task)];
        assert!(
            Network::new(&waypoints, &twice, 3.0)
                .unwrap_err()
                .to_string()
                .contains("edges[1]")
        );
        let named = ["ramp", "pier"].map(|name| Waypoint::named(name, Point3::origin()));
        let error = Network::new(&named, &bad, 3.0).unwrap_err().to_string();
        assert!(error.contains("edges[2] (ramp - pier).risk"), "{error}");
        assert!(
            Network::new(&waypoints, &[], 0.0).is_err() && Network::new(&[], &[], 1.0).is_err()
        );
    }

    #[test]
    fn an_undirected_edge_has_an_arc_in_each_direction() {
        let waypoints = [0.0, 30.0, 60.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 0.0)));
        let edges = [
            Edge::undirected(0, 2, Task::TRANSIT),
            Edge::directed(0, 1, Task::TRANSIT),
        ];
        let network = Network::new(&waypoints, &edges, 3.0).unwrap();
        assert!(network.arc_between(NodeId(2), NodeId(0)).is_some());
        assert!(network.arc_between(NodeId(1), NodeId(0)).is_none());
        let heads: Vec<_> = network
            .arcs_from(NodeId(0))
            .map(|(_, arc)| arc.head.0)
            .collect();
        assert_eq!(heads, [1, 2]);
        let there = network.arc_between(NodeId(0), NodeId(2)).unwrap();
        assert!((network.arc_time_s(there, None) - 20.0).abs() < 1e-12);
    }
}
