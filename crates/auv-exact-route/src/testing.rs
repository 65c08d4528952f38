//! Small digraphs and an enumeration of all routes, for the tests of the planner's parts.

use crate::digraph::Digraph;
use auv_graph::{NodeId, Terrain, Topology};
use auv_planning::{Deadline, RouteProblem};
use auv_types::Seed;

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
