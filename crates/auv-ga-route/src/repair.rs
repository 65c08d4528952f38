//! Repair of offspring that are not routes.

use auv_graph::NodeId;
use auv_route_encoding::UsableArcs;

/// Removes nodes that are visited already or cannot be reached from the node kept before them, then
/// nodes at the end from which no edge leads to the destination. The result is empty if no node is
/// left. `visited` must hold `false` for every node of the network.
pub(crate) fn repair(nodes: &mut Vec<NodeId>, arcs: &UsableArcs<'_>, visited: &mut [bool]) {
    let Some(&destination) = nodes.last() else {
        return;
    };
    let mut kept = 1;
    visited[nodes[0].index()] = true;
    visited[destination.index()] = true;
    for i in 1..nodes.len() {
        let node = nodes[i];
        let is_new = !visited[node.index()];
        if is_new && arcs.between(nodes[kept - 1], node).is_some() {
            visited[node.index()] = true;
            nodes[kept] = node;
            kept += 1;
        }
    }
    while kept > 0 && arcs.between(nodes[kept - 1], destination).is_none() {
        kept -= 1;
    }
    nodes.truncate(kept);
    if kept > 0 {
        nodes.push(destination);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{Edge, Network, Task, Waypoint};
    use auv_planning::{Deadline, RouteProblem};
    use auv_types::Point3;

    #[test]
    fn removes_duplicates_and_nodes_without_an_edge() {
        let waypoints: Vec<_> = (0..6)
            .map(|i| Waypoint::at(Point3::new(f64::from(i), 0.0, 0.0)))
            .collect();
        let edges = [(0, 1), (1, 2), (2, 3), (1, 3), (2, 5)]
            .map(|(a, b)| Edge::directed(a, b, Task::TRANSIT));
        let network = Network::new(&waypoints, &edges, 1.0).unwrap();
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(5), 1e3);
        let arcs = UsableArcs::new(&problem, Deadline::default());
        let repaired = |nodes: &[u32]| {
            let mut nodes: Vec<_> = nodes.iter().copied().map(NodeId).collect();
            repair(&mut nodes, &arcs, &mut [false; 6]);
            nodes.iter().map(|node| node.0).collect::<Vec<_>>()
        };
        assert_eq!(repaired(&[0, 1, 4, 1, 2, 3, 5]), [0, 1, 2, 5]);
        assert_eq!(repaired(&[0, 4, 3, 5]), [0_u32; 0]);
    }
}
