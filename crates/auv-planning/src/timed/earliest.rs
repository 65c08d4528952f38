//! Earliest arrivals at all nodes, and quickest ways, over travel times by departure.

use super::timed_network::TimedNetwork;
use auv_graph::NodeId;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The earliest arrival at every node after leaving one at a time, in seconds; infinite where no way
/// leads. First in, first out, so that Dijkstra's algorithm holds.
pub(super) fn earliest_arrivals(tables: &TimedNetwork<'_>, from: u32, leave_s: f64) -> Vec<f64> {
    search(tables, from, None, leave_s, |_| true).0
}

/// The quickest way between two nodes after leaving at a time: the arrival in seconds, and its nodes without
/// the first.
pub(super) fn quickest_way(
    tables: &TimedNetwork<'_>,
    from: u32,
    to: u32,
    leave_s: f64,
    is_free: impl Fn(u32) -> bool,
) -> Option<(f64, Vec<u32>)> {
    let (time_s, before) = search(tables, from, Some(to), leave_s, is_free);
    let arrival_s = time_s[to as usize];
    if arrival_s == f64::INFINITY {
        return None;
    }
    let mut way = vec![to];
    while let Some(&at) = way.last() {
        let tail = before[at as usize];
        if tail == from || at == from {
            break;
        }
        way.push(tail);
    }
    way.reverse();
    Some((arrival_s, way))
}

fn search(
    tables: &TimedNetwork<'_>,
    from: u32,
    to: Option<u32>,
    leave_s: f64,
    is_free: impl Fn(u32) -> bool,
) -> (Vec<f64>, Vec<u32>) {
    let network = tables.problem.network;
    let mut time_s = vec![f64::INFINITY; tables.nodes()];
    let mut before = vec![from; tables.nodes()];
    time_s[from as usize] = leave_s;
    // Times are not negative, so their bits are in the same order as they are.
    let mut heap = BinaryHeap::from([Reverse((leave_s.to_bits(), from))]);
    while let Some(Reverse((bits, at))) = heap.pop() {
        let at_s = f64::from_bits(bits);
        if at_s > time_s[at as usize] {
            continue;
        }
        if to == Some(at) {
            break;
        }
        for arc in network.range_from(NodeId(at)) {
            let head = network.heads()[arc].0;
            if !is_free(head) {
                continue;
            }
            let arrival_s = tables.arrival_s(at, head, at_s);
            if arrival_s < time_s[head as usize] {
                time_s[head as usize] = arrival_s;
                before[head as usize] = at;
                heap.push(Reverse((arrival_s.to_bits(), head)));
            }
        }
    }
    (time_s, before)
}
