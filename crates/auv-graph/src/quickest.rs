//! The quickest way from every node to one destination.

use crate::{EdgeSet, Network, NodeId, Route};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Quickest ways to one destination, from every node.
#[derive(Clone, Debug, PartialEq)]
pub struct QuickestTo {
    time_s: Vec<f64>,
    next: Vec<Option<NodeId>>,
    destination: NodeId,
}

/// A time that orders totally.
#[derive(Clone, Copy, PartialEq)]
struct Time(f64);

impl Eq for Time {}

impl PartialOrd for Time {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Time {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl QuickestTo {
    /// Least time from a node to the destination in seconds; `+inf` where there is no way.
    #[must_use]
    pub fn time_from_s(&self, node: NodeId) -> f64 {
        self.time_s[node.index()]
    }

    /// Least times by node.
    #[must_use]
    pub fn times_s(&self) -> &[f64] {
        &self.time_s
    }

    /// The quickest route from a node, if there is a way.
    #[must_use]
    pub fn route_from(&self, node: NodeId) -> Option<Route> {
        if !self.time_s.get(node.index())?.is_finite() {
            return None;
        }
        let mut nodes = vec![node];
        let mut at = node;
        while at != self.destination {
            at = self.next[at.index()]?;
            nodes.push(at);
        }
        Some(Route::new(nodes))
    }
}

impl Network {
    /// Dijkstra towards `destination` over the arcs left, with `times` by `ArcId` where given.
    ///
    /// Ties break by the lower node index. Complexity: O((n + m) log n).
    #[must_use]
    pub fn quickest_to(
        &self,
        destination: NodeId,
        removed: &EdgeSet,
        times: Option<&[f64]>,
    ) -> QuickestTo {
        let n = self.num_nodes();
        let mut incoming: Vec<Vec<usize>> = vec![Vec::new(); n];
        for (i, arc) in self.arcs().iter().enumerate() {
            if !removed.contains(arc.edge) {
                incoming[arc.head.index()].push(i);
            }
        }
        let mut quickest = QuickestTo {
            time_s: vec![f64::INFINITY; n],
            next: vec![None; n],
            destination,
        };
        if !self.has_node(destination) {
            return quickest;
        }
        quickest.time_s[destination.index()] = 0.0;
        let mut heap = BinaryHeap::from([Reverse((Time(0.0), destination))]);
        while let Some(Reverse((Time(time_s), node))) = heap.pop() {
            if time_s > quickest.time_s[node.index()] {
                continue;
            }
            for &i in &incoming[node.index()] {
                let arc = &self.arcs()[i];
                let through_s = time_s + times.map_or(arc.time_s, |times| times[i]);
                if through_s < quickest.time_s[arc.tail.index()] {
                    quickest.time_s[arc.tail.index()] = through_s;
                    quickest.next[arc.tail.index()] = Some(node);
                    heap.push(Reverse((Time(through_s), arc.tail)));
                }
            }
        }
        quickest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Edge, EdgeId, Task, Waypoint};
    use auv_types::Point3;

    #[test]
    fn goes_round_a_removed_edge() {
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
}
