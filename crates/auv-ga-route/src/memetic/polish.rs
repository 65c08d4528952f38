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

/// The best change; what a node left out would add is looked up once for each of its legs.
fn best_change(field: &Field, tour: &Tour, price: f64) -> Option<Change> {
    let nodes = &tour.nodes;
    let mut best = Best {
        gain: EPSILON,
        left_s: tour.time_left_s(field),
        price,
        change: None,
    };
    let legs: Vec<Arc> = nodes
        .windows(2)
        .map(|pair| field.arc(pair[0], pair[1]))
        .collect();
    let inner = 1..nodes.len() - 1;
    // What taking each inner node out changes; the ends stay.
    let mut removals = vec![Arc::default(); nodes.len()];
    for i in inner.clone() {
        removals[i] = field.arc(nodes[i - 1], nodes[i + 1]) - (legs[i - 1] + legs[i]);
    }
    let gain = |delta: &Arc| delta.profit - price * delta.time_s;
    let gentlest = removals[inner.clone()]
        .iter()
        .map(gain)
        .fold(f64::NEG_INFINITY, f64::max);
    let saved_s = removals
        .iter()
        .map(|delta| delta.time_s)
        .fold(0.0, f64::min);

    let mut is_out: Vec<bool> = vec![true; field.len()];
    nodes.iter().for_each(|&node| is_out[node as usize] = false);
    // The node's arcs from and to each place of the route.
    let (mut into, mut onward) = (Vec::new(), Vec::new());
    let look_up = |node: u32, into: &mut Vec<Arc>, onward: &mut Vec<Arc>| {
        into.clear();
        into.extend(nodes.iter().map(|&tail| field.arc_to(node, tail)));
        onward.clear();
        onward.extend(nodes.iter().map(|&head| field.arc(node, head)));
    };
    for node in (0..field.len() as u32).filter(|&node| is_out[node as usize]) {
        look_up(node, &mut into, &mut onward);
        for (after, &leg) in legs.iter().enumerate() {
            let delta = into[after] + onward[after + 1] - leg;
            best.offer(delta, Change::Insert { node, after });
            let hopeless =
                gain(&delta) + gentlest <= best.gain || delta.time_s + saved_s > best.left_s;
            if hopeless {
                continue;
            }
            for out in inner.clone().filter(|&i| i != after && i != after + 1) {
                best.offer(delta + removals[out], Change::Replace { out, node, after });
            }
        }
        for out in inner.clone() {
            let delta = into[out - 1] + onward[out + 1] - (legs[out - 1] + legs[out]);
            let after = out;
            best.offer(delta, Change::Replace { out, node, after });
        }
    }
    for out in inner.clone() {
        let node = nodes[out];
        look_up(node, &mut into, &mut onward);
        for after in (0..legs.len()).filter(|&after| after != out && after + 1 != out) {
            let delta = into[after] + onward[after + 1] - legs[after] + removals[out];
            best.offer(delta, Change::Replace { out, node, after });
        }
        let (low, before, behind) = (out, nodes[out - 1], nodes[out + 1]);
        for high in low + 1..nodes.len() - 1 {
            let other = nodes[high];
            let delta = if high == low + 1 {
                field.arc(before, other) + into[high] + onward[high + 1]
                    - (legs[low - 1] + legs[low] + legs[high])
            } else {
                field.arc(before, other)
                    + field.arc_to(behind, other)
                    + into[high - 1]
                    + onward[high + 1]
                    - (legs[low - 1] + legs[low] + legs[high - 1] + legs[high])
            };
            best.offer(delta, Change::Swap { low, high });
        }
    }
    best.change
}
