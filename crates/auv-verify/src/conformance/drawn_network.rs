//! Random networks.

use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_planning::RouteProblem;
use auv_types::rand::RngExt;
use auv_types::{Point3, Seed};

/// A network and the time available on it.
pub(super) struct DrawnNetwork {
    pub(super) network: Network,
    time_available_s: f64,
}

impl DrawnNetwork {
    /// From the first node to the last.
    pub(super) fn problem(&self) -> RouteProblem<'_> {
        let destination = NodeId(self.network.num_nodes() as u32 - 1);
        RouteProblem::new(&self.network, NodeId(0), destination, self.time_available_s)
    }
}

/// Random waypoints and edges after section 3.1 of the paper. The time available is enough for about
/// a third of the waypoints. The last node, the destination, can be reached from any node.
pub(super) fn drawn_network(
    seed: u64,
    nodes: u32,
    density: f64,
    is_directed: bool,
) -> Result<DrawnNetwork, String> {
    let mut random = Seed(seed).stream(0);
    let waypoints: Vec<_> = (0..nodes)
        .map(|_| {
            let [x, y, z] = [10_000.0, 10_000.0, 100.0].map(|most| random.random_range(0.0..most));
            Waypoint::at(Point3::new(x, y, z))
        })
        .collect();
    let mut edges = Vec::new();
    for a in 0..nodes {
        for b in 0..nodes {
            let is_wanted = if is_directed { a != b } else { a < b };
            let task = Task {
                priority: random.random_range(1.0..10.0),
                risk: random.random_range(1.0..10.0),
                completion_time_s: random.random_range(50.0..300.0),
            };
            if is_wanted && (b + 1 == nodes || random.random_bool(density)) {
                edges.push(Edge {
                    directed: is_directed,
                    ..Edge::undirected(a, b, task)
                });
            }
        }
    }
    let network = Network::new(&waypoints, &edges, 3.0).map_err(|error| error.to_string())?;
    Ok(DrawnNetwork {
        network,
        time_available_s: 3_500.0 + 600.0 * f64::from(nodes),
    })
}
