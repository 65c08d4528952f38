//! Small digraphs, prices and an enumeration of all routes, for the tests of the planner's parts.

use crate::digraph::Digraph;
use crate::prices::Prices;
use auv_graph::{NodeId, Terrain, Topology};
use auv_planning::{Deadline, RouteProblem};
use auv_types::{Seed, rand::RngExt};

/// The digraph of a drawn network from node 0 to the last one.
pub(crate) fn digraph(nodes: usize, edges: usize, seed: u64, limit_s: f64) -> Digraph {
    let terrain = Terrain {
        topology: Topology::Directed,
        ..Terrain::paper(nodes, edges)
    };
    let network = terrain.draw(Seed(seed)).unwrap().network;
    let destination = NodeId(nodes as u32 - 1);
    let problem = RouteProblem::new(&network, NodeId(0), destination, limit_s);
    let home = network.quickest_to(destination, problem.removed, None);
    Digraph::new(&problem, &home, Deadline::default()).unwrap()
}

/// Random prices that are 0 at start and destination.
pub(crate) fn prices(graph: &Digraph, seed: u64) -> Prices {
    let random = &mut Seed(seed).stream(1);
    let mut visit: Vec<f64> = (0..graph.num_nodes())
        .map(|_| random.random_range(0.0..1.5))
        .collect();
    (visit[graph.start], visit[graph.destination]) = (0.0, 0.0);
    Prices {
        per_second: random.random_range(0.0..1e-3),
        visit,
    }
}

/// The arcs of every simple route in time.
pub(crate) fn routes(graph: &Digraph, limit_s: f64) -> Vec<Vec<usize>> {
    let mut routes = Vec::new();
    extend(
        graph,
        limit_s,
        &mut vec![graph.start],
        &mut Vec::new(),
        &mut routes,
    );
    routes
}

fn extend(
    graph: &Digraph,
    limit_s: f64,
    nodes: &mut Vec<usize>,
    arcs: &mut Vec<usize>,
    routes: &mut Vec<Vec<usize>>,
) {
    let at = nodes[nodes.len() - 1];
    if at == graph.destination {
        routes.push(arcs.clone());
        return;
    }
    for arc in graph.arcs_from(at) {
        arcs.push(arc);
        let time_s: f64 = arcs.iter().map(|&arc| graph.time_s[arc]).sum();
        if time_s <= limit_s && !nodes.contains(&graph.head[arc]) {
            nodes.push(graph.head[arc]);
            extend(graph, limit_s, nodes, arcs, routes);
            nodes.pop();
        }
        arcs.pop();
    }
}
