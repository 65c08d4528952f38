//! Search spaces and tours for the tests of the search's parts.

use super::search_space::SearchSpace;
use super::tour::Tour;
use auv_graph::{NodeId, Terrain, Topology};
use auv_planning::{Deadline, RouteProblem};
use auv_types::{Seed, rand::RngExt};

/// A space drawn from a terrain, with ranked neighbours.
pub(super) fn space(terrain: &Terrain, seed: u64, time_available_s: f64) -> SearchSpace {
    let network = terrain.draw(Seed(seed)).unwrap().network;
    let problem = RouteProblem::new(&network, NodeId(0), NodeId(1), time_available_s);
    let home = network.quickest_to(NodeId(1), problem.removed, None);
    let mut space = SearchSpace::new(&problem, &home, Deadline::default()).unwrap();
    space.price = 2e-3;
    space.rank_neighbours(6, Deadline::default());
    space
}

/// A dense and a sparse symmetric space and a directed one, of 20 to 30 nodes.
pub(super) fn spaces() -> [SearchSpace; 3] {
    let directed = Terrain {
        topology: Topology::Directed,
        ..Terrain::benchmark(20, 330)
    };
    [
        space(&Terrain::benchmark(20, 185), 1, 16_000.0),
        space(&Terrain::benchmark(30, 130), 2, 22_000.0),
        space(&directed, 3, 16_000.0),
    ]
}

/// A tour in time with random nodes at random places.
pub(super) fn random_tour(space: &SearchSpace, seed: u64) -> Tour {
    let random = &mut Seed(seed).stream(0);
    let mut tour = Tour::new(space.quickest(), space);
    for _ in 0..200 {
        let node = random.random_range(2..space.len() as u32);
        let position = random.random_range(1..tour.nodes.len() as u64) as usize;
        if !tour.nodes.contains(&node) {
            let mut nodes = tour.nodes.clone();
            nodes.insert(position, node);
            let longer = Tour::new(nodes, space);
            if longer.time_s <= space.time_available_s {
                tour = longer;
            }
        }
    }
    tour
}
