//! The last word on a best route: no single insertion, removal and insertion or swap improves it.

use super::field::{Arc, Field};
use super::tour::Tour;
use auv_planning::Deadline;

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

/// Makes the best change at `price` a second again and again until none improves the route.
///
/// Complexity: O(k^2 n) for a change of a route of k nodes, most of it cut short.
pub(crate) fn polish(field: &Field, tour: &mut Tour, price: f64, deadline: Deadline<'_>) {
    while let Some(change) = best_change(field, tour, price) {
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
        if deadline.passed() {
            break;
        }
    }
}

struct Best {
    gain: f64,
    left_s: f64,
    price: f64,
    change: Option<Change>,
}

impl Best {
    fn offer(&mut self, delta: Arc, change: Change) {
        let gain = delta.profit - self.price * delta.time_s;
        if gain > self.gain && delta.time_s <= self.left_s {
            (self.gain, self.change) = (gain, Some(change));
        }
    }
}

fn best_change(field: &Field, tour: &Tour, price: f64) -> Option<Change> {
    let nodes = &tour.nodes;
    let mut best = Best {
        gain: EPSILON,
        left_s: tour.time_left_s(field),
        price,
        change: None,
    };
    let arc = |a: u32, b: u32| field.arc(a, b);
    let inner = 1..nodes.len() - 1;
    // What taking each inner node out changes.
    let removals: Vec<Arc> = inner
        .clone()
        .map(|i| {
            let through = arc(nodes[i - 1], nodes[i]) + arc(nodes[i], nodes[i + 1]);
            arc(nodes[i - 1], nodes[i + 1]) - through
        })
        .collect();
    let gain = |delta: &Arc| delta.profit - price * delta.time_s;
    let gentlest = removals.iter().map(gain).fold(f64::NEG_INFINITY, f64::max);
    let saved_s = removals
        .iter()
        .map(|delta| delta.time_s)
        .fold(0.0, f64::min);

    let mut out: Vec<bool> = vec![true; field.len()];
    nodes.iter().for_each(|&node| out[node as usize] = false);
    for node in (0..field.len() as u32).filter(|&node| out[node as usize]) {
        for after in 0..nodes.len() - 1 {
            let (a, b) = (nodes[after], nodes[after + 1]);
            let delta = arc(a, node) + arc(node, b) - arc(a, b);
            best.offer(delta, Change::Insert { node, after });
            let hopeless =
                gain(&delta) + gentlest <= best.gain || delta.time_s + saved_s > best.left_s;
            if hopeless {
                continue;
            }
            for i in inner.clone().filter(|&i| i != after && i != after + 1) {
                best.offer(
                    delta + removals[i - 1],
                    Change::Replace {
                        out: i,
                        node,
                        after,
                    },
                );
            }
        }
        for i in inner.clone() {
            let (a, b) = (nodes[i - 1], nodes[i + 1]);
            let through = arc(a, nodes[i]) + arc(nodes[i], b);
            let delta = arc(a, node) + arc(node, b) - through;
            best.offer(
                delta,
                Change::Replace {
                    out: i,
                    node,
                    after: i,
                },
            );
        }
    }
    for i in inner.clone() {
        let node = nodes[i];
        for after in (0..nodes.len() - 1).filter(|&after| after != i && after + 1 != i) {
            let (a, b) = (nodes[after], nodes[after + 1]);
            let delta = arc(a, node) + arc(node, b) - arc(a, b) + removals[i - 1];
            best.offer(
                delta,
                Change::Replace {
                    out: i,
                    node,
                    after,
                },
            );
        }
        for j in i + 1..nodes.len() - 1 {
            best.offer(swap(field, nodes, i, j), Change::Swap { low: i, high: j });
        }
    }
    best.change
}

/// What exchanging two inner nodes changes.
fn swap(field: &Field, nodes: &[u32], low: usize, high: usize) -> Arc {
    let arc = |a: usize, b: usize| field.arc(nodes[a], nodes[b]);
    if high == low + 1 {
        return arc(low - 1, high) + arc(high, low) + arc(low, high + 1)
            - (arc(low - 1, low) + arc(low, high) + arc(high, high + 1));
    }
    let new = arc(low - 1, high) + arc(high, low + 1) + arc(high - 1, low) + arc(low, high + 1);
    let old = arc(low - 1, low) + arc(low, low + 1) + arc(high - 1, high) + arc(high, high + 1);
    new - old
}
