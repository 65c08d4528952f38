//! The quickest way from every node to one destination.

use crate::edge_set::EdgeSet;
use crate::ids::NodeId;
use crate::network::Network;
use crate::route::Route;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The quickest ways from every node to one destination.
#[derive(Clone, Debug, PartialEq)]
pub struct QuickestTo {
    time_s: Vec<f64>,
    next: Vec<Option<NodeId>>,
}

impl QuickestTo {
    /// Least time from a node to the destination in seconds; infinite if there is no way.
    #[must_use]
    pub fn time_from_s(&self, node: NodeId) -> f64 {
        self.time_s[node.index()]
    }

    /// Least times in seconds by node.
    #[must_use]
    pub fn times_s(&self) -> &[f64] {
        &self.time_s
    }

    /// The quickest route from a node, if there is a way.
    #[must_use]
    pub fn route_from(&self, node: NodeId) -> Option<Route> {
        Some(Route::new(self.way_from(node)?.collect()))
    }

    /// The nodes of the quickest route from a node, that node first, if there is a way.
    pub fn way_from(&self, node: NodeId) -> Option<impl Iterator<Item = NodeId> + '_> {
        let way = |&at: &NodeId| self.next[at.index()];
        let finite = self.time_s.get(node.index())?.is_finite();
        finite.then(|| std::iter::successors(Some(node), way))
    }
}

impl Network {
    /// The quickest ways to `destination` over the edges that are not removed (Dijkstra's algorithm).
    /// `times`, by [`ArcId`](crate::ArcId), replace the network's times if given.
    ///
    /// Complexity: O((n + m) log n).
    ///
    /// # Determinism
    /// Nodes of equal time are settled in the order of their indices.
    #[must_use]
    pub fn quickest_to(
        &self,
        destination: NodeId,
        removed: &EdgeSet,
        times: Option<&[f64]>,
    ) -> QuickestTo {
        let n = self.num_nodes();
        let incoming = Incoming::new(self, removed, times);
        let mut quickest = QuickestTo {
            time_s: vec![f64::INFINITY; n],
            next: vec![None; n],
        };
        if !self.has_node(destination) {
            return quickest;
        }
        quickest.time_s[destination.index()] = 0.0;
        // Times are not negative, so their bits are in the same order as they are.
        let mut heap = BinaryHeap::from([Reverse((0_u64, destination))]);
        while let Some(Reverse((bits, node))) = heap.pop() {
            let time_s = f64::from_bits(bits);
            if time_s > quickest.time_s[node.index()] {
                continue;
            }
            incoming.for_each(node, |arc, tail, arc_s| {
                let through_s = time_s + arc_s;
                let best_s = &mut quickest.time_s[tail.index()];
                if through_s < *best_s && incoming.is_usable(arc) {
                    *best_s = through_s;
                    quickest.next[tail.index()] = Some(node);
                    heap.push(Reverse((through_s.to_bits(), tail)));
                }
            });
        }
        quickest
    }
}

/// The arcs into each node.
enum Incoming<'a> {
    /// Every arc has a reverse of equal time: the arcs out of a node stand for those into it.
    Reverses(&'a Network, &'a EdgeSet),
    /// Tails and times of the arcs that are not removed, grouped by head. The group of node `i` starts
    /// at `first[i]`.
    Grouped {
        first: Vec<u32>,
        arcs: Vec<(NodeId, f64)>,
    },
}

impl<'a> Incoming<'a> {
    fn new(network: &'a Network, removed: &'a EdgeSet, times: Option<&[f64]>) -> Self {
        if network.is_undirected() && times.is_none() {
            return Self::Reverses(network, removed);
        }
        let usable = || {
            let arcs = network.arcs().iter().enumerate();
            arcs.filter(|(_, arc)| !removed.contains(arc.edge))
        };
        let mut first = vec![0_u32; network.num_nodes() + 2];
        for (_, arc) in usable() {
            first[arc.head.index() + 2] += 1;
        }
        for head in 2..first.len() {
            first[head] += first[head - 1];
        }
        // While a group is filled, first[head + 1] moves from its start to its end.
        let mut arcs = vec![(NodeId(0), 0.0); network.arcs().len()];
        for (i, arc) in usable() {
            let slot = &mut first[arc.head.index() + 1];
            arcs[*slot as usize] = (arc.tail, times.map_or(arc.time_s, |times| times[i]));
            *slot += 1;
        }
        Self::Grouped { first, arcs }
    }

    /// Calls `visit` with index, tail and time of each arc into a node. The index has a meaning for
    /// [`Incoming::is_usable`] only.
    fn for_each(&self, head: NodeId, mut visit: impl FnMut(usize, NodeId, f64)) {
        match self {
            Self::Reverses(network, _) => {
                let arcs = network.range_from(head);
                let heads = network.heads()[arcs.clone()].iter();
                let legs = heads.zip(&network.times_s()[arcs.clone()]);
                arcs.zip(legs)
                    .for_each(|(arc, (&tail, &time_s))| visit(arc, tail, time_s));
            }
            Self::Grouped { first, arcs } => {
                let group = first[head.index()] as usize..first[head.index() + 1] as usize;
                let legs = group.clone().zip(&arcs[group]);
                legs.for_each(|(arc, &(tail, time_s))| visit(arc, tail, time_s));
            }
        }
    }

    /// Whether an arc is not removed; called only for arcs that would improve a time.
    fn is_usable(&self, arc: usize) -> bool {
        match self {
            Self::Reverses(network, removed) => !removed.contains(network.arcs()[arc].edge),
            Self::Grouped { .. } => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Edge, EdgeId, Task, Terrain, Topology, Waypoint};
    use auv_types::{Point3, Seed};

    #[test]
    fn the_quickest_way_avoids_a_removed_edge() {
        let waypoints = [0.0, 30.0, 60.0].map(|x| Waypoint::at(Point3::new(x, x, 0.0)));
        let edges = [(0, 2), (0, 1), (1, 2)].map(|(a, b)| Edge::directed(a, b, Task::TRANSIT));
        let network = Network::new(&waypoints, &edges, 3.0).unwrap();
        let direct = network.quickest_to(NodeId(2), &EdgeSet::empty(), None);
        assert_eq!(direct.route_from(NodeId(0)).unwrap().nodes().len(), 2);
        let removed = [EdgeId(0)].into_iter().collect();
        let round = network.quickest_to(NodeId(2), &removed, None);
        assert_eq!(round.route_from(NodeId(0)).unwrap().nodes().len(), 3);
        assert!(
            network
                .quickest_to(NodeId(0), &removed, None)
                .route_from(NodeId(2))
                .is_none()
        );
    }

    #[test]
    fn times_are_those_of_relaxation_over_all_arcs() {
        for topology in [Topology::Directed, Topology::Undirected] {
            let terrain = Terrain {
                topology,
                ..Terrain::benchmark(30, 120)
            };
            let network = terrain.draw(Seed(1)).unwrap().network;
            let removed: EdgeSet = (0..30).map(|i| EdgeId(4 * i)).collect();
            let changed: Vec<f64> = (0..)
                .zip(network.times_s())
                .map(|(i, time_s)| match i % 5 {
                    0 => f64::INFINITY,
                    _ => time_s * f64::from(1 + i % 3),
                })
                .collect();
            for times in [None, Some(&changed[..])] {
                let mut expected = vec![f64::INFINITY; 30];
                expected[7] = 0.0;
                // Bellman and Ford.
                for _ in 0..30 {
                    for (i, arc) in network.arcs().iter().enumerate() {
                        let time_s = times.map_or(arc.time_s, |times| times[i]);
                        let through_s = expected[arc.head.index()] + time_s;
                        if !removed.contains(arc.edge) && through_s < expected[arc.tail.index()] {
                            expected[arc.tail.index()] = through_s;
                        }
                    }
                }
                let quickest = network.quickest_to(NodeId(7), &removed, times);
                assert_eq!(quickest.times_s(), expected);
                for node in (0..30).map(NodeId) {
                    let Some(route) = quickest.route_from(node) else {
                        assert!(expected[node.index()].is_infinite());
                        continue;
                    };
                    let totals = network.evaluate(&route, &removed, times).unwrap();
                    assert!((totals.time_s - expected[node.index()]).abs() < 1e-6);
                }
            }
        }
    }
}
