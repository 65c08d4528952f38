//! Re-solving a window of a route: the best way between two of its nodes over all nodes that the
//! rest of the route leaves free, by a layered beam search. Where the beam holds every way, as in
//! small or sparse networks, the window becomes optimal.

use super::field::{END, Field};
use super::tour::Tour;

/// A way from the window's begin, told by its last step.
#[derive(Clone, Copy, Debug)]
struct Way {
    node: u32,
    /// Index of the way it prolongs.
    before: u32,
    profit: f64,
    time_s: f64,
    /// What it is ranked by.
    promise: f64,
    /// The same for all orders of the same nodes.
    signature: u64,
}

/// Room to re-solve in.
#[derive(Debug, Default)]
pub(crate) struct Window {
    /// Nodes of the route outside the window.
    taken: Vec<bool>,
    /// All ways kept, layer by layer.
    ways: Vec<Way>,
    next: Vec<Way>,
}

impl Window {
    /// How many ways a layer keeps; in a small field, practically all.
    const WIDTH: usize = 16;
    const SMALL_FIELD: usize = 12;
    const SMALL_FIELD_WIDTH: usize = 500;
    /// How many nodes the new window may have more than the old one.
    const LONGER: usize = 3;

    /// Replaces the nodes strictly between two positions where that gains at `price` a second.
    /// Returns the layers searched; `touched` receives the nodes of a new window.
    pub(crate) fn solve(
        &mut self,
        field: &Field,
        tour: &mut Tour,
        [from, to]: [usize; 2],
        price: f64,
        touched: &mut Vec<u32>,
    ) -> u64 {
        let target = tour.nodes[to];
        let mut old = (0.0, 0.0);
        for pair in tour.nodes[from..=to].windows(2) {
            let arc = field.arc(pair[0], pair[1]);
            old = (old.0 + arc.profit, old.1 + arc.time_s);
        }
        let limit_s = old.1 + tour.time_left_s(field);
        let mut best = (old.0 - price * old.1 + 1e-9, None);
        self.taken.clear();
        self.taken.resize(field.len(), false);
        self.taken[END as usize] = true;
        for &node in tour.nodes[..=from].iter().chain(&tour.nodes[to..]) {
            self.taken[node as usize] = true;
        }
        self.ways.clear();
        self.ways.push(Way {
            node: tour.nodes[from],
            before: 0,
            profit: 0.0,
            time_s: 0.0,
            promise: 0.0,
            signature: 0,
        });
        let (mut begin, mut layers) = (0, 0);
        while begin < self.ways.len() && layers < (to - from + Self::LONGER) as u64 {
            layers += 1;
            self.next.clear();
            for index in begin..self.ways.len() {
                let way = self.ways[index];
                let last = field.arc(way.node, target);
                let value = way.profit + last.profit - price * (way.time_s + last.time_s);
                if way.time_s + last.time_s <= limit_s && value > best.0 {
                    best = (value, Some(index));
                }
                for near in field.near::<true>(way.node) {
                    let head = near.node;
                    if !self.taken[head as usize] && !self.passes(index, head) {
                        self.prolong(field, index, head, target, price, limit_s);
                    }
                }
            }
            self.keep_the_best(field.len());
            begin = self.ways.len();
            self.ways.append(&mut self.next);
        }
        if let (_, Some(index)) = best {
            let mut nodes = Vec::new();
            let mut at = index;
            while at > 0 {
                nodes.push(self.ways[at].node);
                at = self.ways[at].before as usize;
            }
            nodes.reverse();
            touched.clear();
            touched.extend_from_slice(&tour.nodes[from..=to]);
            touched.extend_from_slice(&nodes);
            tour.nodes.splice(from + 1..to, nodes);
            tour.sum(field);
        }
        layers
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

    fn prolong(
        &mut self,
        field: &Field,
        index: usize,
        head: u32,
        target: u32,
        price: f64,
        limit_s: f64,
    ) {
        let way = self.ways[index];
        let arc = field.arc(way.node, head);
        let (profit, time_s) = (way.profit + arc.profit, way.time_s + arc.time_s);
        let last = field.arc(head, target);
        // Where no arc leads to the target there may still be a way.
        let closed_s = if last.time_s < f64::INFINITY {
            last.time_s
        } else {
            0.0
        };
        if time_s + closed_s > limit_s {
            return;
        }
        self.next.push(Way {
            node: head,
            before: index as u32,
            profit,
            time_s,
            promise: profit + last.profit - price * (time_s + closed_s),
            signature: way.signature ^ scramble(head),
        });
    }

    /// Keeps the most promising ways of the next layer; of two orders of the same nodes with the
    /// same last one, not the one that earns no more in no less time.
    fn keep_the_best(&mut self, nodes: usize) {
        let width = if nodes <= Self::SMALL_FIELD {
            Self::SMALL_FIELD_WIDTH
        } else {
            Self::WIDTH
        };
        let next = &mut self.next;
        let better = |a: &Way, b: &Way| {
            let place = |way: &Way| (way.node, way.signature, way.before);
            b.promise
                .total_cmp(&a.promise)
                .then(place(a).cmp(&place(b)))
        };
        // Some of the best are dominated: twice as many are looked at as are kept.
        if next.len() > 2 * width {
            next.select_nth_unstable_by(2 * width, better);
            next.truncate(2 * width);
        }
        next.sort_unstable_by(better);
        let mut kept = 0;
        for i in 0..next.len() {
            let way = next[i];
            let dominates = |other: &Way| {
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

/// A number for each node whose exclusive or tells sets apart (SplitMix64).
fn scramble(node: u32) -> u64 {
    let mut z = (u64::from(node) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
