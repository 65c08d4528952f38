//! The last word on a best route: no single insertion, removal and insertion or swap improves it.

use super::field::{Field, ProfitTime};
use super::tour::Tour;
use auv_planning::Deadline;
use std::ops::Range;

/// Gains up to this are rounding.
const EPSILON: f64 = 1e-9;

/// A change by positions in the route.
#[derive(Clone, Copy, Debug)]
enum Change {
    /// The node comes after the position.
    Insert { node: u32, after: usize },
    /// The node at a position goes, a node (perhaps the same) comes after another position.
    Replace { out: usize, node: u32, after: usize },
    /// Two nodes change places.
    Swap { low: usize, high: usize },
}

/// Makes the best change at `price` a second again and again until none improves the route; after
/// the deadline only while it has to look at no more than `late` insertions.
///
/// Complexity: O(k^2 n) for a change of a route of k nodes, most of it cut short.
pub(crate) fn polish(
    field: &Field,
    tour: &mut Tour,
    price: f64,
    deadline: Deadline<'_>,
    mut late: usize,
) {
    loop {
        if deadline.passed() {
            let insertions = field.len() * tour.nodes.len();
            if insertions > late {
                return;
            }
            late -= insertions;
        }
        let Some(change) = best_change(field, tour, price) else {
            return;
        };
        let nodes = &mut tour.nodes;
        match change {
            Change::Insert { node, after } => nodes.insert(after + 1, node),
            Change::Replace { out, node, after } => {
                nodes.remove(out);
                nodes.insert(if after < out { after + 1 } else { after }, node);
            }
            Change::Swap { low, high } => nodes.swap(low, high),
        }
        tour.sum(field);
    }
}

/// The best change.
fn best_change(field: &Field, tour: &Tour, price: f64) -> Option<Change> {
    let mut look = Look::new(field, tour, price);
    let mut is_out = vec![true; field.len()];
    let inner = 1..tour.nodes.len() - 1;
    for &node in &tour.nodes {
        is_out[node as usize] = false;
    }
    for node in (0..field.len() as u32).filter(|&node| is_out[node as usize]) {
        look.bring_in(node, inner.clone());
    }
    for out in inner.clone() {
        look.shift(out, inner.clone());
    }
    look.change
}

/// A look at all changes of a route, one node after the other.
struct Look<'a> {
    field: &'a Field,
    nodes: &'a [u32],
    legs: Vec<ProfitTime>,
    /// What taking each inner node out changes; the ends stay.
    removals: Vec<ProfitTime>,
    /// Time of each removal, that of the one which saves most first, and the greatest gain up to it.
    savings: Vec<(f64, f64)>,
    /// The arcs from and to each place of the route, of the node looked at.
    into: Vec<ProfitTime>,
    onward: Vec<ProfitTime>,
    price: f64,
    left_s: f64,
    /// The best change so far and its gain.
    gain: f64,
    change: Option<Change>,
}

impl<'a> Look<'a> {
    fn new(field: &'a Field, tour: &'a Tour, price: f64) -> Self {
        let nodes = &tour.nodes;
        let legs: Vec<ProfitTime> = nodes
            .windows(2)
            .map(|pair| field.arc(pair[0], pair[1]))
            .collect();
        let mut removals = vec![ProfitTime::default(); nodes.len()];
        for i in 1..nodes.len() - 1 {
            removals[i] = field.arc(nodes[i - 1], nodes[i + 1]) - (legs[i - 1] + legs[i]);
        }
        let gain = |delta: &ProfitTime| delta.profit - price * delta.time_s;
        let inner = removals[1..nodes.len() - 1].iter();
        let mut savings: Vec<_> = inner.map(|delta| (delta.time_s, gain(delta))).collect();
        savings.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for i in 1..savings.len() {
            savings[i].1 = savings[i].1.max(savings[i - 1].1);
        }
        Self {
            field,
            nodes,
            legs,
            savings,
            removals,
            into: Vec::new(),
            onward: Vec::new(),
            price,
            left_s: tour.time_left_s(field),
            gain: EPSILON,
            change: None,
        }
    }

    fn offer(&mut self, delta: ProfitTime, change: Change) {
        let gain = delta.profit - self.price * delta.time_s;
        if gain > self.gain && delta.time_s <= self.left_s {
            (self.gain, self.change) = (gain, Some(change));
        }
    }

    /// Whether taking out the best node that saves enough time might make a change the best.
    fn is_hopeful(&self, delta: ProfitTime) -> bool {
        let gain = delta.profit - self.price * delta.time_s;
        let spare_s = self.left_s - delta.time_s;
        let (Some(first), Some(last)) = (self.savings.first(), self.savings.last()) else {
            return false;
        };
        if gain + last.1 <= self.gain || first.0 > spare_s {
            return false;
        }
        let enough = self.savings.partition_point(|saving| saving.0 <= spare_s);
        gain + self.savings[enough.saturating_sub(1)].1 > self.gain
    }

    fn look_up(&mut self, node: u32) {
        let (field, nodes) = (self.field, self.nodes);
        self.onward.clear();
        self.onward
            .extend(nodes.iter().map(|&head| field.arc(node, head)));
        self.into.clear();
        if field.symmetric {
            self.into.extend_from_slice(&self.onward);
            self.into[0] = field.arc(nodes[0], node);
        } else {
            self.into
                .extend(nodes.iter().map(|&tail| field.arc(tail, node)));
        }
    }

    /// Brings in a node left out, alone or for one of the route.
    fn bring_in(&mut self, node: u32, inner: Range<usize>) {
        self.look_up(node);
        for after in 0..self.legs.len() {
            let delta = self.into[after] + self.onward[after + 1] - self.legs[after];
            self.offer(delta, Change::Insert { node, after });
            if !self.is_hopeful(delta) {
                continue;
            }
            for out in inner.clone().filter(|&i| i != after && i != after + 1) {
                let delta = delta + self.removals[out];
                self.offer(delta, Change::Replace { out, node, after });
            }
        }
        for out in inner {
            let old = self.legs[out - 1] + self.legs[out];
            let delta = self.into[out - 1] + self.onward[out + 1] - old;
            let after = out;
            self.offer(delta, Change::Replace { out, node, after });
        }
    }

    /// Moves a node of the route elsewhere, or swaps it with a later one.
    fn shift(&mut self, low: usize, inner: Range<usize>) {
        let (field, nodes) = (self.field, self.nodes);
        let (node, before, behind) = (nodes[low], nodes[low - 1], nodes[low + 1]);
        self.look_up(node);
        for after in (0..self.legs.len()).filter(|&after| after != low && after + 1 != low) {
            let new = self.into[after] + self.onward[after + 1];
            let delta = new - self.legs[after] + self.removals[low];
            let out = low;
            self.offer(delta, Change::Replace { out, node, after });
        }
        for high in low + 1..inner.end {
            let other = nodes[high];
            let (legs, last) = (&self.legs, self.onward[high + 1]);
            let delta = if high == low + 1 {
                field.arc(before, other) + self.into[high] + last
                    - (legs[low - 1] + legs[low] + legs[high])
            } else {
                field.arc(before, other) + field.arc_to(behind, other) + self.into[high - 1] + last
                    - (legs[low - 1] + legs[low] + legs[high - 1] + legs[high])
            };
            self.offer(delta, Change::Swap { low, high });
        }
    }
}
