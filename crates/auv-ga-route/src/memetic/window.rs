//! Optimising a window of a tour: the best way between two of its nodes over all nodes that the rest
//! of the tour leaves free, by a layered beam search. In small or sparse spaces the beam holds every
//! way; then the window becomes optimal.

use super::search_space::{END, SearchSpace};
use super::tour::Tour;

/// A way from the start of the window, described by its last step.
#[derive(Clone, Copy, Debug)]
struct PartialWay {
    node: u32,
    /// Index of the way without its last step.
    before: u32,
    profit: f64,
    time_s: f64,
    /// Worth if the next step led to the end of the window: ways are ranked by it.
    promise: f64,
    /// A hash of the set of nodes, equal for all their orders.
    signature: u64,
}

/// The part of a tour that is searched again.
#[derive(Clone, Copy, Debug)]
struct Window {
    /// Its last node.
    target: u32,
    /// Most seconds that it may take.
    limit_s: f64,
    /// What a second is worth.
    price: f64,
}

/// The memory of the search; one for each thread.
#[derive(Debug, Default)]
pub(crate) struct WindowSearch {
    /// Whether a node is on the tour outside the window.
    taken: Vec<bool>,
    /// All ways kept, layer by layer.
    ways: Vec<PartialWay>,
    next: Vec<PartialWay>,
}

impl WindowSearch {
    /// Number of ways kept in a layer.
    const WIDTH: usize = 16;
    /// Most nodes of a space in which practically all ways are kept.
    const SMALL_SPACE: usize = 12;
    const SMALL_SPACE_WIDTH: usize = 500;
    /// How many more nodes than before the window may have.
    const LONGER: usize = 3;

    /// Replaces the nodes strictly between two positions where that gains at `price` a second.
    /// Returns the number of layers searched. `touched` receives the old and new nodes of the window
    /// if it changes.
    pub(crate) fn solve(
        &mut self,
        space: &SearchSpace,
        tour: &mut Tour,
        [from, to]: [usize; 2],
        price: f64,
        touched: &mut Vec<u32>,
    ) -> u64 {
        let mut old = (0.0, 0.0);
        for pair in tour.nodes[from..=to].windows(2) {
            let arc = space.arc(pair[0], pair[1]);
            old = (old.0 + arc.profit, old.1 + arc.time_s);
        }
        let window = Window {
            target: tour.nodes[to],
            limit_s: old.1 + tour.time_left_s(space),
            price,
        };
        self.start(space, &tour.nodes, [from, to]);
        let mut best = (old.0 - price * old.1 + 1e-9, None);
        let (mut first, mut layers) = (0, 0);
        while first < self.ways.len() && layers < (to - from + Self::LONGER) as u64 {
            layers += 1;
            self.extend_layer(space, &window, first, &mut best);
            first = self.ways.len();
            self.ways.append(&mut self.next);
        }
        if let (_, Some(index)) = best {
            let nodes = self.nodes_to(index);
            touched.clear();
            touched.extend_from_slice(&tour.nodes[from..=to]);
            touched.extend_from_slice(&nodes);
            tour.nodes.splice(from + 1..to, nodes);
            tour.sum(space);
        }
        layers
    }

    /// Marks the nodes outside the window and starts with the way of no step.
    fn start(&mut self, space: &SearchSpace, nodes: &[u32], [from, to]: [usize; 2]) {
        self.taken.clear();
        self.taken.resize(space.len(), false);
        self.taken[END as usize] = true;
        for &node in nodes[..=from].iter().chain(&nodes[to..]) {
            self.taken[node as usize] = true;
        }
        self.ways.clear();
        self.ways.push(PartialWay {
            node: nodes[from],
            before: 0,
            profit: 0.0,
            time_s: 0.0,
            promise: 0.0,
            signature: 0,
        });
    }

    /// Closes every way of the last layer, the first of which has index `first`, for the best, and
    /// extends it by one step for the next layer.
    fn extend_layer(
        &mut self,
        space: &SearchSpace,
        window: &Window,
        first: usize,
        best: &mut (f64, Option<usize>),
    ) {
        self.next.clear();
        for index in first..self.ways.len() {
            let way = self.ways[index];
            let last = space.arc(way.node, window.target);
            let value = way.profit + last.profit - window.price * (way.time_s + last.time_s);
            if way.time_s + last.time_s <= window.limit_s && value > best.0 {
                *best = (value, Some(index));
            }
            for near in space.near::<true>(way.node) {
                let head = near.node;
                if !self.taken[head as usize] && !self.passes(index, head) {
                    self.extend(space, window, index, head);
                }
            }
        }
        self.prune_next(space.len());
    }

    /// Whether a way passes a node.
    fn passes(&self, mut index: usize, node: u32) -> bool {
        while index > 0 {
            if self.ways[index].node == node {
                return true;
            }
            index = self.ways[index].before as usize;
        }
        false
    }

    /// The nodes of a way after the first.
    fn nodes_to(&self, index: usize) -> Vec<u32> {
        let mut nodes = Vec::new();
        let mut at = index;
        while at > 0 {
            nodes.push(self.ways[at].node);
            at = self.ways[at].before as usize;
        }
        nodes.reverse();
        nodes
    }

    fn extend(&mut self, space: &SearchSpace, window: &Window, index: usize, head: u32) {
        let way = self.ways[index];
        let arc = space.arc(way.node, head);
        let (profit, time_s) = (way.profit + arc.profit, way.time_s + arc.time_s);
        let last = space.arc(head, window.target);
        // Without an arc to the target, a longer way may still reach it.
        let closed_s = if last.time_s < f64::INFINITY {
            last.time_s
        } else {
            0.0
        };
        if time_s + closed_s > window.limit_s {
            return;
        }
        self.next.push(PartialWay {
            node: head,
            before: index as u32,
            profit,
            time_s,
            promise: profit + last.profit - window.price * (time_s + closed_s),
            signature: way.signature ^ scramble(head),
        });
    }

    /// Keeps the most promising ways of the next layer. Of two orders of the same nodes with the same
    /// last node, it drops one that earns no more in no less time.
    fn prune_next(&mut self, nodes: usize) {
        let width = if nodes <= Self::SMALL_SPACE {
            Self::SMALL_SPACE_WIDTH
        } else {
            Self::WIDTH
        };
        let next = &mut self.next;
        let better = |a: &PartialWay, b: &PartialWay| {
            let place = |way: &PartialWay| (way.node, way.signature, way.before);
            b.promise
                .total_cmp(&a.promise)
                .then(place(a).cmp(&place(b)))
        };
        // Some of the best are dominated, so twice as many candidates are tested as are kept.
        if next.len() > 2 * width {
            next.select_nth_unstable_by(2 * width, better);
            next.truncate(2 * width);
        }
        next.sort_unstable_by(better);
        let mut kept = 0;
        for i in 0..next.len() {
            let way = next[i];
            let dominates = |other: &PartialWay| {
                other.node == way.node
                    && other.signature == way.signature
                    && other.profit >= way.profit
                    && other.time_s <= way.time_s
            };
            if !next[..kept].iter().any(dominates) {
                next[kept] = way;
                kept += 1;
                if kept == width {
                    break;
                }
            }
        }
        next.truncate(kept);
    }
}

/// A pseudo-random number for each node (SplitMix64); their exclusive or hashes a set of nodes.
fn scramble(node: u32) -> u64 {
    let mut z = (u64::from(node) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memetic::testing::{random_tour, space, spaces};
    use auv_graph::Terrain;
    use auv_planning::Deadline;

    /// The greatest worth of any way in time from `nodes` to the target over free nodes.
    fn most_worth(space: &SearchSpace, window: &Window, free: &[u32], nodes: &mut Vec<u32>) -> f64 {
        let last = nodes[nodes.len() - 1];
        let sum = space.sum(nodes) + space.arc(last, window.target);
        let mut most = f64::NEG_INFINITY;
        if sum.time_s <= window.limit_s {
            most = sum.worth(window.price);
        }
        for &node in free
            .iter()
            .filter(|node| !nodes.contains(node))
            .collect::<Vec<_>>()
        {
            if space.arc(last, node).time_s.is_finite() {
                nodes.push(node);
                most = most.max(most_worth(space, window, free, nodes));
                nodes.pop();
            }
        }
        most
    }

    #[test]
    fn a_window_of_a_small_space_becomes_optimal() {
        let mut improved = 0;
        for seed in 0..30 {
            let mut space = space(&Terrain::benchmark(9, 36), seed, 10_000.0);
            space.rank_neighbours(8, Deadline::default());
            let mut tour = random_tour(&space, seed);
            if tour.nodes.len() < 4 {
                continue;
            }
            let [from, to] = [0, tour.nodes.len() - 1];
            let before = tour.clone();
            let window = Window {
                target: END,
                limit_s: space.time_available_s,
                price: 1e-4,
            };
            let free: Vec<u32> = (2..space.len() as u32).collect();
            let most_nodes = to - from + WindowSearch::LONGER;
            let expected = most_worth(&space, &window, &free, &mut vec![0]);
            let mut touched = Vec::new();
            let price = window.price;
            WindowSearch::default().solve(&space, &mut tour, [from, to], price, &mut touched);
            let worth = |tour: &Tour| tour.profit - price * tour.time_s;
            assert!(worth(&tour) <= expected + 1e-9 && worth(&tour) >= worth(&before));
            assert_eq!(touched.is_empty(), tour == before);
            if most_nodes >= space.len() {
                assert!(worth(&tour) >= expected - 1e-9, "seed {seed}");
                improved += usize::from(tour != before);
            }
        }
        assert!(improved > 0);
    }

    #[test]
    fn the_rest_of_the_tour_stays_and_the_changed_tour_is_in_time_and_worth_more() {
        let mut changed = 0;
        for space in spaces() {
            let mut search = WindowSearch::default();
            for seed in 0..30 {
                let before = random_tour(&space, seed);
                let mut tour = before.clone();
                let last = tour.nodes.len() - 1;
                let (from, to) = (last / 3, last - last / 4);
                let mut touched = Vec::new();
                search.solve(&space, &mut tour, [from, to], space.price, &mut touched);
                assert_eq!(tour.nodes[..=from], before.nodes[..=from]);
                let after = last - to;
                assert_eq!(
                    tour.nodes[tour.nodes.len() - 1 - after..],
                    before.nodes[to..]
                );
                assert!(tour.time_s <= space.time_available_s + 1e-6);
                let worth = |tour: &Tour| tour.profit - space.price * tour.time_s;
                assert!(tour == before || worth(&tour) > worth(&before));
                changed += usize::from(tour != before);
                let mut once = tour.nodes.clone();
                once.sort_unstable();
                once.dedup();
                assert_eq!(once.len(), tour.nodes.len());
            }
        }
        assert!(changed > 5, "{changed}");
    }
}
