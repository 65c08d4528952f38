//! A final local search over all nodes: afterwards no single insertion, replacement or swap improves
//! the tour.

use super::profit_time::ProfitTime;
use super::search_space::SearchSpace;
use super::tour::Tour;
use auv_planning::Deadline;
use std::ops::Range;

/// Smaller gains are rounding errors.
const EPSILON: f64 = 1e-9;

/// A change of a tour, by positions.
#[derive(Clone, Copy, Debug)]
enum Change {
    /// Inserts a node after the position.
    Insert { node: u32, after: usize },
    /// Removes the node at `out` and inserts a node, perhaps the same one, after another position.
    Replace { out: usize, node: u32, after: usize },
    /// Exchanges two nodes.
    Swap { low: usize, high: usize },
}

impl Change {
    fn apply(self, nodes: &mut Vec<u32>) {
        match self {
            Self::Insert { node, after } => nodes.insert(after + 1, node),
            Self::Replace { out, node, after } => {
                nodes.remove(out);
                nodes.insert(if after < out { after + 1 } else { after }, node);
            }
            Self::Swap { low, high } => nodes.swap(low, high),
        }
    }
}

/// Applies the best change at `price` again and again until none improves the tour. After the
/// deadline it goes on only while the insertions it evaluates add up to at most `late`.
///
/// Complexity: O(k^2 n) for one change of a tour of k nodes; pruning skips most of it.
pub(crate) fn polish(
    space: &SearchSpace,
    tour: &mut Tour,
    price: f64,
    deadline: Deadline<'_>,
    mut late: usize,
) {
    loop {
        if deadline.passed() {
            let insertions = space.len() * tour.nodes.len();
            if insertions > late {
                return;
            }
            late -= insertions;
        }
        let Some(change) = best_change(space, tour, price) else {
            return;
        };
        change.apply(&mut tour.nodes);
        tour.sum(space);
    }
}

/// The change of greatest gain, if any gains.
fn best_change(space: &SearchSpace, tour: &Tour, price: f64) -> Option<Change> {
    let mut search = ChangeSearch::new(space, tour, price);
    let mut is_out = vec![true; space.len()];
    let inner = 1..tour.nodes.len() - 1;
    for &node in &tour.nodes {
        is_out[node as usize] = false;
    }
    for node in (0..space.len() as u32).filter(|&node| is_out[node as usize]) {
        search.add(node, inner.clone());
    }
    for position in inner.clone() {
        search.shift(position, inner.clone());
    }
    search.change
}

/// A search over all changes of a tour, node by node.
struct ChangeSearch<'a> {
    space: &'a SearchSpace,
    nodes: &'a [u32],
    legs: Vec<ProfitTime>,
    /// What the removal of each inner node adds; 0 for the ends, which stay.
    removals: Vec<ProfitTime>,
    /// For each removal its time, the one that saves most first, and the greatest gain so far in
    /// this order.
    savings: Vec<(f64, f64)>,
    /// The arcs from each position to the current node.
    into: Vec<ProfitTime>,
    /// The arcs from the current node to each position.
    onward: Vec<ProfitTime>,
    price: f64,
    left_s: f64,
    /// Gain of the best change so far.
    gain: f64,
    change: Option<Change>,
}

impl<'a> ChangeSearch<'a> {
    fn new(space: &'a SearchSpace, tour: &'a Tour, price: f64) -> Self {
        let nodes = &tour.nodes;
        let legs: Vec<ProfitTime> = nodes
            .windows(2)
            .map(|pair| space.arc(pair[0], pair[1]))
            .collect();
        let mut removals = vec![ProfitTime::default(); nodes.len()];
        for i in 1..nodes.len() - 1 {
            removals[i] = space.arc(nodes[i - 1], nodes[i + 1]) - (legs[i - 1] + legs[i]);
        }
        let inner = removals[1..nodes.len() - 1].iter();
        let mut savings: Vec<_> = inner
            .map(|delta| (delta.time_s, delta.worth(price)))
            .collect();
        savings.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for i in 1..savings.len() {
            savings[i].1 = savings[i].1.max(savings[i - 1].1);
        }
        Self {
            space,
            nodes,
            legs,
            savings,
            removals,
            into: Vec::new(),
            onward: Vec::new(),
            price,
            left_s: tour.time_left_s(space),
            gain: EPSILON,
            change: None,
        }
    }

    /// Keeps a change if it is in time and better than the best so far.
    fn offer(&mut self, delta: ProfitTime, change: Change) {
        let gain = delta.worth(self.price);
        if gain > self.gain && delta.time_s <= self.left_s {
            (self.gain, self.change) = (gain, Some(change));
        }
    }

    /// Whether an insertion may become the best change together with a removal that saves enough
    /// time: an upper bound over all removals.
    fn may_pay_with_removal(&self, insertion: ProfitTime) -> bool {
        let gain = insertion.worth(self.price);
        let spare_s = self.left_s - insertion.time_s;
        let (Some(first), Some(last)) = (self.savings.first(), self.savings.last()) else {
            return false;
        };
        if gain + last.1 <= self.gain || first.0 > spare_s {
            return false;
        }
        let enough = self.savings.partition_point(|saving| saving.0 <= spare_s);
        gain + self.savings[enough.saturating_sub(1)].1 > self.gain
    }

    /// Makes a node the current one: reads its arcs to and from the tour.
    fn read_arcs(&mut self, node: u32) {
        let (space, nodes) = (self.space, self.nodes);
        self.onward.clear();
        self.onward
            .extend(nodes.iter().map(|&head| space.arc(node, head)));
        self.into.clear();
        if space.symmetric {
            self.into.extend_from_slice(&self.onward);
            self.into[0] = space.arc(nodes[0], node);
        } else {
            self.into
                .extend(nodes.iter().map(|&tail| space.arc(tail, node)));
        }
    }

    /// Tries to add a node that the tour leaves out, alone or in exchange for another.
    fn add(&mut self, node: u32, inner: Range<usize>) {
        self.read_arcs(node);
        for after in 0..self.legs.len() {
            let delta = self.into[after] + self.onward[after + 1] - self.legs[after];
            self.offer(delta, Change::Insert { node, after });
            if !self.may_pay_with_removal(delta) {
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

    /// Tries to move a node of the tour elsewhere, and to exchange it with a later one.
    fn shift(&mut self, low: usize, inner: Range<usize>) {
        let (space, nodes) = (self.space, self.nodes);
        let (node, before, behind) = (nodes[low], nodes[low - 1], nodes[low + 1]);
        self.read_arcs(node);
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
                space.arc(before, other) + self.into[high] + last
                    - (legs[low - 1] + legs[low] + legs[high])
            } else {
                space.arc(before, other) + space.arc_to(behind, other) + self.into[high - 1] + last
                    - (legs[low - 1] + legs[low] + legs[high - 1] + legs[high])
            };
            self.offer(delta, Change::Swap { low, high });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memetic::testing::{random_tour, spaces};

    /// Gain of the best change by scoring every changed tour from its nodes.
    fn best_gain_by_enumeration(space: &SearchSpace, tour: &Tour, price: f64) -> f64 {
        let worth = |tour: &Tour| tour.profit - price * tour.time_s;
        let mut best: f64 = 0.0;
        let mut consider = |change: Change| {
            let mut nodes = tour.nodes.clone();
            change.apply(&mut nodes);
            let changed = Tour::new(nodes, space);
            if changed.time_s <= space.time_available_s {
                best = best.max(worth(&changed) - worth(tour));
            }
        };
        let last = tour.nodes.len() - 1;
        for node in 2..space.len() as u32 {
            let is_in = tour.nodes.contains(&node);
            for after in 0..last {
                if !is_in {
                    consider(Change::Insert { node, after });
                }
                for out in (1..last).filter(|&out| !is_in || tour.nodes[out] == node) {
                    // Inserting after the removed node means after its predecessor.
                    consider(Change::Replace { out, node, after });
                }
            }
        }
        for low in 1..last {
            (low + 1..last).for_each(|high| consider(Change::Swap { low, high }));
        }
        best
    }

    #[test]
    fn the_best_change_is_that_of_an_enumeration() {
        let mut changes = [0; 3];
        for space in spaces() {
            for seed in 0..60 {
                let tour = random_tour(&space, seed);
                for price in [-1e-3, 1e-9, 2e-3] {
                    let expected = best_gain_by_enumeration(&space, &tour, price);
                    let Some(change) = best_change(&space, &tour, price) else {
                        assert!(expected <= 1e-8, "missed a gain of {expected}");
                        continue;
                    };
                    changes[match change {
                        Change::Insert { .. } => 0,
                        Change::Replace { .. } => 1,
                        Change::Swap { .. } => 2,
                    }] += 1;
                    let mut nodes = tour.nodes.clone();
                    change.apply(&mut nodes);
                    let changed = Tour::new(nodes, &space);
                    assert!(changed.time_s <= space.time_available_s + 1e-6);
                    let gain =
                        changed.profit - tour.profit - price * (changed.time_s - tour.time_s);
                    assert!(
                        (gain - expected).abs() < 1e-8,
                        "{change:?}: {gain} {expected}"
                    );
                }
            }
        }
        assert!(changes.iter().all(|&count| count > 0), "{changes:?}");
    }

    #[test]
    fn a_polished_tour_has_no_better_change() {
        for space in spaces() {
            let mut tour = random_tour(&space, 3);
            polish(&space, &mut tour, 1e-9, Deadline::default(), 0);
            assert!(best_gain_by_enumeration(&space, &tour, 1e-9) < 1e-8);
        }
    }
}
