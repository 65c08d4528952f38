//! A route through the network's corridors, for the population to begin with.

use auv_graph::{NodeId, Route, TimeModel};
use auv_planning::RouteProblem;
use auv_planning::timed::{Step, TimedNetwork, TimedTour, corridors, fill, pieces};

/// A route with its corridors inserted: ways whose inner nodes lead nowhere else, such as the lines of a
/// survey. Moves of single nodes never find these. `None` if there is no corridor, or none fits.
///
/// Complexity: O(n) where every node has three neighbours or more.
pub(crate) fn corridor_route(problem: &RouteProblem<'_>, route: &Route) -> Option<Route> {
    let nodes = 0..problem.network.num_nodes() as u32;
    if !nodes.map(NodeId).any(|node| is_narrow(problem, node)) {
        return None;
    }
    let model = TimeModel::default();
    let tables = TimedNetwork::new(problem, &model);
    let corridors = corridors(&tables);
    let steps = route
        .nodes()
        .iter()
        .map(|node| Step::pass(node.0))
        .collect();
    let mut tour = TimedTour::new(&tables, steps).filter(|_| !corridors.is_empty())?;
    fill(&tables, &mut tour, &corridors);
    fill(&tables, &mut tour, &pieces(&tables));
    Some(tour.answer(&tables).0)
}

/// Whether at most two usable arcs leave a node.
fn is_narrow(problem: &RouteProblem<'_>, node: NodeId) -> bool {
    let network = problem.network;
    let times_s = problem.times.unwrap_or(network.times_s());
    let usable = network.range_from(node).filter(|&arc| {
        let is_removed = problem.removed.contains(network.arcs()[arc].edge);
        !is_removed && times_s[arc].is_finite()
    });
    usable.take(3).count() <= 2
}
