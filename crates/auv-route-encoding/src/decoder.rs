//! Priority vectors: the encoding of routes that GA and ICA share (Section 4.1, Fig. 7).

use crate::scored_route::ScoredRoute;
use crate::usable_arcs::UsableArcs;
use auv_graph::{NodeId, QuickestTo};
use auv_types::{Seed, rand::RngExt};

/// Which adjacent nodes may come next while a priority vector is decoded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Decoding {
    /// Any unvisited node, as in the paper. The route may take too long; on a dense network 72 to 89 %
    /// do.
    Plain,
    /// Only nodes from which the quickest way to the destination passes no visited node and is in
    /// time. If any route is feasible, every decoded route is.
    #[default]
    BudgetAware,
}

/// Decodes priority vectors. A vector has one number in [`Decoder::PRIORITIES`] for each node.
#[derive(Debug)]
pub struct Decoder<'a> {
    arcs: &'a UsableArcs<'a>,
    home: &'a QuickestTo,
}

/// The memory that decoding needs; one for each thread.
#[derive(Clone, Debug, Default)]
pub struct DecoderScratch {
    visited: Vec<bool>,
}

impl<'a> Decoder<'a> {
    /// The range of the priorities.
    pub const PRIORITIES: std::ops::RangeInclusive<f64> = -100.0..=100.0;

    /// A decoder of routes that use `arcs`. `home` are the quickest ways to the destination.
    #[must_use]
    pub const fn new(arcs: &'a UsableArcs<'a>, home: &'a QuickestTo) -> Self {
        Self { arcs, home }
    }

    /// Draws uniform priorities for initial route number `index` at a given attempt.
    ///
    /// # Determinism
    /// The same seed, attempt and index give the same priorities in every planner.
    pub fn draw(&self, seed: Seed, attempt: u64, index: u64, priorities: &mut Vec<f64>) {
        let random = &mut seed.split(0).split(attempt).stream(index);
        let nodes = self.arcs.problem().network.num_nodes();
        priorities.clear();
        priorities.extend((0..nodes).map(|_| random.random_range(Self::PRIORITIES)));
    }

    /// Decodes a vector and scores the route: one evaluation.
    ///
    /// From the start, the adjacent node of greatest priority that may come next is appended until
    /// the destination is reached; among equal priorities the lower node. At a dead end, nodes are
    /// removed up to one with a way to the destination ([`Decoding::Plain`]: an arc to it), which is
    /// appended. If there is none, the result has no nodes.
    pub fn decode(
        &self,
        priorities: &[f64],
        decoding: Decoding,
        scratch: &mut DecoderScratch,
        out: &mut ScoredRoute,
    ) {
        let problem = self.arcs.problem();
        let visited = &mut scratch.visited;
        visited.clear();
        visited.resize(problem.network.num_nodes(), false);
        out.nodes.clear();
        out.nodes.push(problem.start);
        visited[problem.start.index()] = true;
        let (mut at, mut time_s) = (problem.start, 0.0);
        while at != problem.destination {
            let mut next: Option<(f64, NodeId, f64)> = None;
            for (arc, head, leg_s) in self.arcs.from(at) {
                let priority = priorities[head.index()];
                let is_first = next.is_none_or(|(most, ..)| priority.total_cmp(&most).is_gt());
                // The most expensive test comes last.
                if is_first
                    && !visited[head.index()]
                    && self.arcs.is_usable(arc)
                    && (decoding == Decoding::Plain
                        || self.has_way_home(head, time_s + leg_s, visited))
                {
                    next = Some((priority, head, leg_s));
                }
            }
            let Some((_, head, leg_s)) = next else {
                self.end_at_destination(decoding, visited, &mut out.nodes);
                break;
            };
            at = head;
            time_s += leg_s;
            visited[at.index()] = true;
            out.nodes.push(at);
        }
        out.evaluate(self.arcs);
    }

    /// Whether the quickest way from `node`, reached at `time_s`, to the destination passes no visited
    /// node and is in time.
    fn has_way_home(&self, node: NodeId, time_s: f64, visited: &[bool]) -> bool {
        time_s + self.home.time_from_s(node) <= self.arcs.problem().time_available_s
            && self.is_way_home_free(node, visited)
    }

    fn is_way_home_free(&self, node: NodeId, visited: &[bool]) -> bool {
        self.home
            .way_from(node)
            .is_some_and(|mut way| way.all(|node| !visited[node.index()]))
    }

    /// Removes nodes up to one with a way to the destination, and appends that way.
    fn end_at_destination(
        &self,
        decoding: Decoding,
        visited: &mut [bool],
        nodes: &mut Vec<NodeId>,
    ) {
        let destination = self.arcs.problem().destination;
        while let Some(&last) = nodes.last() {
            match decoding {
                Decoding::Plain => {
                    if self.arcs.between(last, destination).is_some() {
                        nodes.push(destination);
                        return;
                    }
                }
                Decoding::BudgetAware => {
                    visited[last.index()] = false;
                    if self.is_way_home_free(last, visited) {
                        let way = self.home.way_from(last).into_iter().flatten();
                        nodes.extend(way.skip(1));
                        return;
                    }
                }
            }
            nodes.pop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{Edge, Network, Task, Waypoint};
    use auv_planning::{Deadline, RouteProblem};
    use auv_types::Point3;

    const TASK: Task = Task {
        priority: 2.0,
        risk: 1.0,
        completion_time_s: 0.0,
    };

    fn network(nodes: u32, edges: &[(u32, u32)]) -> Network {
        let waypoints: Vec<_> = (0..nodes)
            .map(|i| Waypoint::at(Point3::new(30.0 * f64::from(i), 0.0, 0.0)))
            .collect();
        let edges: Vec<_> = edges
            .iter()
            .map(|&(a, b)| Edge::undirected(a, b, TASK))
            .collect();
        Network::new(&waypoints, &edges, 3.0).unwrap()
    }

    fn decode(
        network: &Network,
        priorities: &[f64],
        decoding: Decoding,
        available_s: f64,
    ) -> ScoredRoute {
        let destination = NodeId(network.num_nodes() as u32 - 1);
        let problem = RouteProblem::new(network, NodeId(0), destination, available_s);
        let arcs = UsableArcs::new(&problem, Deadline::default());
        let mut out = ScoredRoute::none();
        let home = network.quickest_to(destination, problem.removed, None);
        let decoder = Decoder::new(&arcs, &home);
        decoder.decode(
            priorities,
            decoding,
            &mut DecoderScratch::default(),
            &mut out,
        );
        out
    }

    fn ids(candidate: &ScoredRoute) -> Vec<u32> {
        candidate.nodes.iter().map(|node| node.0).collect()
    }

    #[test]
    fn the_adjacent_node_of_greatest_priority_comes_next_as_in_fig_7() {
        // Fig. 7: 18 nodes, the first adjacent to nodes 2, 3, 4 and 5 (1-based).
        let mut edges = vec![(0, 1), (0, 2), (0, 3), (0, 4), (3, 7), (3, 8), (8, 17)];
        edges.extend([(1, 5), (2, 6), (4, 9), (7, 10), (10, 17), (8, 11)]);
        let network = network(18, &edges);
        let mut priorities = vec![0.0; 18];
        for (node, priority) in [(1, -5.0), (2, 3.0), (3, 40.0), (4, 39.0), (7, 10.0)] {
            priorities[node] = priority;
        }
        priorities[8] = 60.0;
        priorities[17] = 5.0;
        let plain = decode(&network, &priorities, Decoding::Plain, 1e6);
        assert_eq!(ids(&plain), [0, 3, 8, 17]);
        assert_eq!(plain.score.cost, -6.0);
    }

    #[test]
    fn a_dead_end_is_removed() {
        let network = network(5, &[(0, 1), (1, 2), (2, 3), (1, 4)]);
        let priorities = [0.0, 0.0, 9.0, 9.0, -9.0];
        assert_eq!(
            ids(&decode(&network, &priorities, Decoding::Plain, 1e6)),
            [0, 1, 4]
        );
        assert_eq!(
            ids(&decode(&network, &priorities, Decoding::BudgetAware, 1e6)),
            [0, 1, 4]
        );
    }

    #[test]
    fn budget_aware_routes_are_in_time() {
        let edges: Vec<_> = (0..8)
            .flat_map(|a| (a + 1..8).map(move |b| (a, b)))
            .collect();
        let network = network(8, &edges);
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(7), 150.0);
        let arcs = UsableArcs::new(&problem, Deadline::default());
        let home = network.quickest_to(NodeId(7), problem.removed, None);
        let decoder = Decoder::new(&arcs, &home);
        let (mut priorities, mut scratch) = (Vec::new(), DecoderScratch::default());
        for index in 0..200 {
            decoder.draw(Seed(3), 0, index, &mut priorities);
            let mut out = ScoredRoute::none();
            decoder.decode(&priorities, Decoding::BudgetAware, &mut scratch, &mut out);
            assert!(out.score.violation == 0.0 && problem.check(&out.route()).is_ok());
        }
    }

    #[test]
    fn there_is_no_route_if_no_way_leads_to_the_destination() {
        let network = network(4, &[(0, 1), (1, 2)]);
        for decoding in [Decoding::Plain, Decoding::BudgetAware] {
            let none = decode(&network, &[0.0; 4], decoding, 1e6);
            assert!(none.nodes.is_empty() && none.score.violation.is_infinite());
        }
    }
}
