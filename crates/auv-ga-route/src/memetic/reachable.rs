//! The nodes that a route in time can visit.

use auv_graph::{NodeId, QuickestTo};
use auv_planning::RouteProblem;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The nodes on some walk in time, and their new numbers.
pub(super) struct ReachableNodes {
    /// The network's node for each number: the start, the destination, then the others by id.
    pub(super) ids: Vec<NodeId>,
    /// The number of each node of the network, [`ReachableNodes::NONE`] for those left out.
    pub(super) numbers: Vec<u32>,
}

impl ReachableNodes {
    /// The number of a node that is left out.
    pub(super) const NONE: u32 = u32::MAX;

    /// Finds at most `most` inner nodes. If more are in time, it takes those of which the walk from
    /// start to destination through the node is shortest. `home` are the quickest ways to the
    /// destination.
    ///
    /// Complexity: O(m log n).
    pub(super) fn new(problem: &RouteProblem<'_>, home: &QuickestTo, most: usize) -> Self {
        let from_start_s = quickest_from_start(problem, home, most);
        let ends = [problem.start, problem.destination];
        let through_s = |node: NodeId| from_start_s[node.index()] + home.time_from_s(node);
        let mut inner: Vec<_> = (0..from_start_s.len() as u32)
            .map(NodeId)
            .filter(|&node| is_in_time(problem, through_s(node)))
            .filter(|node| !ends.contains(node))
            .collect();
        if inner.len() > most {
            inner.sort_by(|&a, &b| {
                let order = through_s(a).total_cmp(&through_s(b));
                order.then(home.time_from_s(a).total_cmp(&home.time_from_s(b)))
            });
            inner.truncate(most);
            inner.sort_unstable();
        }
        let ids: Vec<_> = ends.into_iter().chain(inner).collect();
        let mut numbers = vec![Self::NONE; from_start_s.len()];
        for (i, id) in ids.iter().enumerate() {
            numbers[id.index()] = i as u32;
        }
        Self { ids, numbers }
    }
}

/// Whether a walk is in time. The tolerance keeps every node of the quickest way, although the sums
/// from both ends round differently.
fn is_in_time(problem: &RouteProblem<'_>, time_s: f64) -> bool {
    time_s * (1.0 - 1e-12) <= problem.time_available_s
}

/// Dijkstra's algorithm from the start over the usable arcs to the nodes from which the destination
/// is reached in time. In a network of at most `most` nodes it stops as soon as every node is known
/// to be among them; the times of the others are then not all the quickest.
fn quickest_from_start(problem: &RouteProblem<'_>, home: &QuickestTo, most: usize) -> Vec<f64> {
    let network = problem.network;
    let (heads, times_s) = (network.heads(), problem.times.unwrap_or(network.times_s()));
    let is_through = |node: NodeId, time_s| is_in_time(problem, time_s + home.time_from_s(node));
    let mut from_start_s = vec![f64::INFINITY; network.num_nodes()];
    from_start_s[problem.start.index()] = 0.0;
    // A larger network needs exact times, since nodes are left out by them.
    let mut missing = if from_start_s.len() > most {
        usize::MAX
    } else {
        from_start_s.len() - 1
    };
    // Times are not negative, so their bits are in the same order as they are.
    let mut heap = BinaryHeap::from([Reverse((0_u64, problem.start))]);
    while missing > 0
        && let Some(Reverse((bits, node))) = heap.pop()
    {
        let here_s = f64::from_bits(bits);
        if here_s > from_start_s[node.index()] {
            continue;
        }
        for arc in network.range_from(node) {
            let (head, there_s) = (heads[arc], here_s + times_s[arc]);
            let before_s = from_start_s[head.index()];
            if there_s < before_s
                && is_through(head, there_s)
                && !problem.removed.contains(network.arcs()[arc].edge)
            {
                missing -= usize::from(before_s == f64::INFINITY);
                from_start_s[head.index()] = there_s;
                heap.push(Reverse((there_s.to_bits(), head)));
            }
        }
    }
    from_start_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{Terrain, Topology};
    use auv_types::Seed;

    #[test]
    fn a_node_is_reachable_exactly_if_the_quickest_walk_through_it_is_in_time() {
        let terrain = Terrain {
            topology: Topology::Directed,
            ..Terrain::benchmark(60, 300)
        };
        let network = terrain.draw(Seed(1)).unwrap().network;
        let to = |node| network.quickest_to(NodeId(node), &Default::default(), None);
        let home = to(1);
        for factor in [2.5, 3.0, 3.5] {
            let time_s = factor * home.time_from_s(NodeId(0));
            let problem = RouteProblem::new(&network, NodeId(0), NodeId(1), time_s);
            let reachable = ReachableNodes::new(&problem, &home, 1_000);
            let expected: Vec<u32> = (2..60)
                .filter(|&node| {
                    let there_s = to(node).time_from_s(NodeId(0));
                    there_s + home.time_from_s(NodeId(node)) <= time_s
                })
                .collect();
            let inner: Vec<u32> = reachable.ids[2..].iter().map(|id| id.0).collect();
            assert_eq!(inner, expected, "{time_s} s");
            assert!(!inner.is_empty() && inner.len() < 58, "{factor}: {inner:?}");
            for (number, id) in (0..).zip(&reachable.ids) {
                assert_eq!(reachable.numbers[id.index()], number);
            }
        }
    }

    #[test]
    fn of_too_many_nodes_those_least_out_of_the_way_are_kept() {
        let network = Terrain::benchmark(40, 700).draw(Seed(2)).unwrap().network;
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(1), 1e5);
        let home = network.quickest_to(NodeId(1), problem.removed, None);
        let start = network.quickest_to(NodeId(0), problem.removed, None);
        let reachable = ReachableNodes::new(&problem, &home, 10);
        assert_eq!(reachable.ids.len(), 12);
        let through_s = |node: NodeId| start.time_from_s(node) + home.time_from_s(node);
        let kept = reachable.ids.iter().map(|&id| through_s(id));
        let longest_s = kept.fold(0.0, f64::max);
        let left_out = (0..40).map(NodeId).filter(|id| !reachable.ids.contains(id));
        for node in left_out {
            assert!(through_s(node) > longest_s - 1e-6);
            assert_eq!(reachable.numbers[node.index()], ReachableNodes::NONE);
        }
    }
}
