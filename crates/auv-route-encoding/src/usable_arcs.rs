//! The arcs that a route may use, in a table for quick lookup.

use auv_graph::{NetworkArc, NodeId, RouteTotals, Task};
use auv_planning::{Deadline, RouteProblem};

/// The usable arcs of a route problem: those not removed and of finite time.
///
/// Lookup by pair is O(1) up to [`UsableArcs::DENSE_NODES`] nodes and O(log degree) above.
#[derive(Debug)]
pub struct UsableArcs<'a> {
    problem: &'a RouteProblem<'a>,
    /// The times of all arcs: the problem's, or else the network's.
    times_s: &'a [f64],
    /// Index of an arc by `tail * nodes + head`, or `NONE`; empty in large networks.
    dense: Vec<u32>,
}

/// One usable arc.
#[derive(Clone, Copy, Debug)]
pub struct UsableArc<'a> {
    /// The arc.
    pub arc: &'a NetworkArc,
    /// Its task.
    pub task: Task,
    /// Its time in seconds: the problem's, or else the network's.
    pub time_s: f64,
}

const NONE: u32 = u32::MAX;

impl<'a> UsableArcs<'a> {
    /// Largest network for which a table of all pairs is kept (4 bytes a pair).
    pub const DENSE_NODES: usize = 1_000;

    /// Builds the table, unless the deadline has passed. Without the table lookups take longer and
    /// give the same. Complexity: O(n^2) up to [`UsableArcs::DENSE_NODES`] nodes, else O(1).
    #[must_use]
    pub fn new(problem: &'a RouteProblem<'a>, deadline: Deadline<'_>) -> Self {
        let network = problem.network;
        let nodes = network.num_nodes();
        let mut dense = Vec::new();
        if nodes <= Self::DENSE_NODES && !deadline.passed() {
            dense.resize(nodes * nodes, NONE);
            for tail in 0..nodes {
                let row = &mut dense[tail * nodes..][..nodes];
                for arc in network.range_from(NodeId(tail as u32)) {
                    row[network.heads()[arc].index()] = arc as u32;
                }
            }
        }
        Self {
            problem,
            times_s: problem.times.unwrap_or(network.times_s()),
            dense,
        }
    }

    /// The problem that the arcs belong to.
    #[must_use]
    pub fn problem(&self) -> &'a RouteProblem<'a> {
        self.problem
    }

    /// Index, head and time in seconds of every arc out of a node, by ascending head. Includes arcs
    /// that may not be used.
    #[inline]
    pub fn from(&self, tail: NodeId) -> impl Iterator<Item = (usize, NodeId, f64)> + '_ {
        let range = self.problem.network.range_from(tail);
        let heads = &self.problem.network.heads()[range.clone()];
        let times_s = &self.times_s[range.clone()];
        let ends = heads.iter().zip(times_s);
        range
            .zip(ends)
            .map(|(arc, (&head, &time_s))| (arc, head, time_s))
    }

    /// Whether an arc may be used.
    #[must_use]
    #[inline]
    pub fn is_usable(&self, arc: usize) -> bool {
        let edge = self.problem.network.arcs()[arc].edge;
        self.times_s[arc].is_finite() && !self.problem.removed.contains(edge)
    }

    /// The arc from one node to another, if there is one that may be used.
    #[must_use]
    pub fn between(&self, tail: NodeId, head: NodeId) -> Option<UsableArc<'a>> {
        let network = self.problem.network;
        let index = if self.dense.is_empty() {
            network.arc_between(tail, head)?.index()
        } else {
            self.dense[tail.index() * network.num_nodes() + head.index()] as usize
        };
        let arc = network.arcs().get(index)?;
        self.is_usable(index).then(|| UsableArc {
            arc,
            task: network.task(arc.edge),
            time_s: self.times_s[index],
        })
    }

    /// The totals of a sequence of nodes, if each of its arcs may be used. Does not check for
    /// repeated nodes.
    #[must_use]
    pub fn totals(&self, nodes: &[NodeId]) -> Option<RouteTotals> {
        let mut totals = RouteTotals::default();
        for pair in nodes.windows(2) {
            let usable = self.between(pair[0], pair[1])?;
            totals.add(usable.arc, usable.task, usable.time_s);
        }
        Some(totals)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{Edge, EdgeId, EdgeSet, Network, Terrain, Waypoint};
    use auv_planning::{Budget, Run};
    use auv_types::{Point3, Seed};
    use std::sync::atomic::AtomicBool;

    #[test]
    fn removed_and_blocked_arcs_are_not_usable() {
        let waypoints = [0.0, 30.0, 60.0].map(|x| Waypoint::at(Point3::new(x, x, 0.0)));
        let edges = [(0, 1), (0, 2), (1, 2)].map(|(a, b)| Edge::undirected(a, b, Task::TRANSIT));
        let network = Network::new(&waypoints, &edges, 3.0).unwrap();
        let removed: EdgeSet = [EdgeId(1)].into_iter().collect();
        let mut times: Vec<f64> = network.arcs().iter().map(|arc| arc.time_s).collect();
        let blocked = network.arc_between(NodeId(2), NodeId(1)).unwrap();
        times[blocked.index()] = f64::INFINITY;
        let problem = RouteProblem {
            removed: &removed,
            times: Some(&times),
            ..RouteProblem::new(&network, NodeId(0), NodeId(2), 1e3)
        };
        let arcs = UsableArcs::new(&problem, Deadline::default());
        let exists = |a, b| arcs.between(NodeId(a), NodeId(b)).is_some();
        assert!(exists(0, 1) && exists(1, 0) && exists(1, 2));
        assert!(!exists(0, 2) && !exists(2, 0) && !exists(2, 1));
        assert!(arcs.totals(&[0, 1, 2].map(NodeId)).is_some());
        assert!(arcs.totals(&[0, 2].map(NodeId)).is_none());
    }

    #[test]
    fn lookups_with_and_without_the_table_agree() {
        let network = Terrain::benchmark(30, 200).draw(Seed(1)).unwrap().network;
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(1), 1e4);
        let table = UsableArcs::new(&problem, Deadline::default());
        let stopped = AtomicBool::new(true);
        let run = Run::new(Seed(0), Budget::to_the_cap()).with_cancel(&stopped);
        let no_table = UsableArcs::new(&problem, run.deadline());
        assert!(no_table.dense.is_empty() && !table.dense.is_empty());
        for tail in (0..30).map(NodeId) {
            for head in (0..30).map(NodeId) {
                let [a, b] = [&table, &no_table].map(|arcs| arcs.between(tail, head));
                assert_eq!(a.map(|a| a.time_s), b.map(|b| b.time_s));
                assert_eq!(a.is_some(), network.arc_between(tail, head).is_some());
            }
        }
    }
}
