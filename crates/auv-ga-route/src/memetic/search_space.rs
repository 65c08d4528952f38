//! The search space of the memetic algorithm: the nodes worth visiting, renumbered, with all arcs
//! between them in one table and short lists of promising neighbours.

use super::arc_table::ArcTable;
use super::neighbour_lists::{ArcBounds, BestNeighbours, Neighbour, NeighbourLists};
use super::profit_time::ProfitTime;
use super::reachable::ReachableNodes;
use auv_graph::{Network, NodeId, QuickestTo};
use auv_planning::{Deadline, RouteProblem};
use std::ops::Add;

pub(crate) use super::numbers::{END, START};

/// The reachable nodes, numbered from 0, their arcs and neighbour lists.
pub(crate) struct SearchSpace {
    /// The network's node for each number.
    ids: Vec<NodeId>,
    pub(crate) time_available_s: f64,
    /// Whether each arc between inner nodes has a reverse of equal profit and time.
    pub(crate) symmetric: bool,
    /// Whether arcs join more than half of all pairs: then a node can be inserted nearly anywhere.
    pub(crate) is_dense: bool,
    /// Profit that a second is worth.
    pub(crate) price: f64,
    /// The price at which neighbours were ranked.
    pub(crate) ranked_at: f64,
    /// Quickest time to the destination, and the next node on that way.
    pub(crate) home: Vec<(f64, u32)>,
    table: ArcTable,
    heads: NeighbourLists,
    tails: NeighbourLists,
}

impl SearchSpace {
    /// Most inner nodes: all that a network can have.
    const MOST_NODES: usize = Network::MAX_NODES;
    /// Most nodes of a small space, in which all of them can be tried again and again.
    const SMALL: usize = 64;

    /// Finds the nodes and their arcs. `home` are the quickest ways to the destination.
    /// `None` if the deadline passes first.
    ///
    /// Complexity: O(n^2 + m log n).
    pub(crate) fn new(
        problem: &RouteProblem<'_>,
        home: &QuickestTo,
        deadline: Deadline<'_>,
    ) -> Option<Self> {
        if deadline.passed() {
            return None;
        }
        let reachable = ReachableNodes::new(problem, home, Self::MOST_NODES);
        let table = ArcTable::new(problem, &reachable, deadline)?;
        let ReachableNodes { ids, numbers } = reachable;
        let symmetric =
            (problem.times.is_none() && problem.network.is_undirected()) || table.is_symmetric();
        let is_dense = table.is_dense();
        let home = ids
            .iter()
            .map(|&id| {
                let next = home.way_from(id).and_then(|mut way| way.nth(1));
                let next = next.map_or(END, |next| numbers[next.index()]);
                (home.time_from_s(id), next)
            })
            .collect();
        Some(Self {
            ids,
            time_available_s: problem.time_available_s,
            symmetric,
            is_dense,
            price: 0.0,
            ranked_at: 0.0,
            home,
            table,
            heads: NeighbourLists::default(),
            tails: NeighbourLists::default(),
        })
    }

    /// The network's node for a number.
    pub(crate) fn id(&self, node: u32) -> NodeId {
        self.ids[node as usize]
    }

    /// The numbers of a route of the network, if the space has all its nodes.
    pub(crate) fn numbers_of(&self, nodes: &[NodeId]) -> Option<Vec<u32>> {
        let number = |id: &NodeId| self.ids.iter().position(|other| other == id);
        nodes.iter().map(|id| Some(number(id)? as u32)).collect()
    }

    /// The nodes of the quickest route.
    pub(crate) fn quickest(&self) -> Vec<u32> {
        let mut nodes = vec![START];
        let mut at = START;
        while at != END {
            at = self.home[at as usize].1;
            nodes.push(at);
        }
        nodes
    }

    /// Number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether all nodes can be tried again and again.
    pub(crate) fn is_small(&self) -> bool {
        self.len() <= Self::SMALL
    }

    /// Whether only the arcs of a large network are kept, not all pairs.
    pub(crate) fn has_lists(&self) -> bool {
        self.table.has_lists()
    }

    /// The arc from a node to one after it, or to a node from one before it.
    pub(crate) fn arc_beside<const AFTER: bool>(&self, node: u32, other: u32) -> ProfitTime {
        if AFTER {
            self.arc(node, other)
        } else {
            self.arc(other, node)
        }
    }

    /// The most promising nodes after or before a node, the best first.
    pub(crate) fn near<const AFTER: bool>(&self, node: u32) -> &[Neighbour] {
        let lists = if AFTER { &self.heads } else { &self.tails };
        lists.of(node)
    }

    /// Bounds over all arcs out of or into a node.
    pub(crate) fn bounds<const AFTER: bool>(&self, node: u32) -> ArcBounds {
        let lists = if AFTER { &self.heads } else { &self.tails };
        lists.bounds(node)
    }

    /// The arc from one node to another; [`ProfitTime::MISSING`] if there is none.
    #[inline]
    pub(crate) fn arc(&self, tail: u32, head: u32) -> ProfitTime {
        self.table.arc(tail, head)
    }

    /// The arc to a node. It is read from the node's own row where that is the same, because the arcs
    /// from the node are in the cache then.
    pub(crate) fn arc_to(&self, node: u32, tail: u32) -> ProfitTime {
        if self.symmetric && tail != START && node != END {
            self.arc(node, tail)
        } else {
            self.arc(tail, node)
        }
    }

    /// Profit and time of a route.
    pub(crate) fn sum(&self, nodes: &[u32]) -> ProfitTime {
        let arcs = nodes.windows(2).map(|pair| self.arc(pair[0], pair[1]));
        arcs.fold(ProfitTime::default(), Add::add)
    }

    /// Lists for each node the `width` neighbours of most worth at the current price. Stops at the
    /// deadline.
    ///
    /// Complexity: O(n^2).
    pub(crate) fn rank_neighbours(&mut self, width: usize, deadline: Deadline<'_>) {
        let nodes = START..self.len() as u32;
        let inner = END + 1..nodes.end;
        self.heads = NeighbourLists::new(nodes.len(), width);
        self.tails = NeighbourLists::new(nodes.len(), width);
        let (mut best, mut into) = (BestNeighbours::new(width, self.price), Vec::new());
        let mut room = Vec::new();
        for node in nodes.clone().take_while(|_| !deadline.passed()) {
            let out = self.table.row(node, &mut room);
            best.find(END + 1, &out[inner.start as usize..]);
            self.heads.fill(node, &best, END, |head| out[head as usize]);
            if !self.symmetric || !inner.contains(&node) {
                into.clear();
                into.extend(inner.clone().map(|tail| self.arc(tail, node)));
                best.find(END + 1, &into);
            }
            let table = &self.table;
            self.tails
                .fill(node, &best, START, |tail| table.arc(tail, node));
        }
        self.ranked_at = self.price;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{EdgeId, EdgeSet, Terrain, Topology};
    use auv_types::Seed;

    #[test]
    fn the_table_holds_the_usable_arcs_between_reachable_nodes() {
        for topology in [Topology::Directed, Topology::Undirected] {
            let terrain = Terrain {
                topology,
                ..Terrain::benchmark(40, 500)
            };
            let network = terrain.draw(Seed(3)).unwrap().network;
            let removed: EdgeSet = (0..100).map(|i| EdgeId(5 * i)).collect();
            let mut times = network.times_s().to_vec();
            times
                .iter_mut()
                .step_by(7)
                .for_each(|time_s| *time_s = f64::INFINITY);
            let problem = RouteProblem {
                removed: &removed,
                times: Some(&times),
                ..RouteProblem::new(&network, NodeId(0), NodeId(39), 9_000.0)
            };
            let home = network.quickest_to(NodeId(39), &removed, problem.times);
            let space = SearchSpace::new(&problem, &home, Deadline::default()).unwrap();
            assert_eq!((space.id(START), space.id(END)), (NodeId(0), NodeId(39)));
            for tail in 0..space.len() as u32 {
                for head in 0..space.len() as u32 {
                    let arc = network.arc_between(space.id(tail), space.id(head));
                    let arc = arc.filter(|arc| {
                        let edge = network.arcs()[arc.index()].edge;
                        tail != END && head != START && !removed.contains(edge)
                    });
                    let expected = arc.map_or(ProfitTime::MISSING, |arc| ProfitTime {
                        profit: network.weights()[arc.index()],
                        time_s: times[arc.index()],
                    });
                    let found = space.arc(tail, head);
                    let is_missing = found.time_s.is_infinite() && expected.time_s.is_infinite();
                    assert!(is_missing || found == expected, "{tail} to {head}");
                }
            }
        }
    }

    #[test]
    fn numbers_translate_routes_of_the_network() {
        let network = Terrain::figure12().draw(Seed(4)).unwrap().network;
        let problem = RouteProblem::new(&network, NodeId(7), NodeId(3), 9_000.0);
        let home = network.quickest_to(NodeId(3), problem.removed, None);
        let space = SearchSpace::new(&problem, &home, Deadline::default()).unwrap();
        let quickest = home.route_from(NodeId(7)).unwrap();
        let numbers = space.numbers_of(quickest.nodes()).unwrap();
        assert_eq!(numbers, space.quickest());
        let back: Vec<_> = numbers.iter().map(|&node| space.id(node)).collect();
        assert_eq!(back, quickest.nodes());
        let totals = network.evaluate(&quickest, problem.removed, None).unwrap();
        assert_eq!(space.sum(&numbers).time_s, totals.time_s);
        assert_eq!(space.numbers_of(&[NodeId(99)]), None);
    }
}
