//! Which nodes a partial route can still visit.

use crate::timed::timed_network::TimedNetwork;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Least times between nodes, whenever one leaves.
#[derive(Debug)]
pub(super) struct Reach {
    /// By pair of nodes, seconds.
    least_s: Vec<f64>,
    /// Least time to a destination, seconds.
    pub(super) home_s: Vec<f64>,
    nodes: usize,
    end_s: f64,
    start: usize,
}

impl Reach {
    pub(super) fn new(tables: &TimedNetwork<'_>) -> Self {
        let nodes = tables.nodes();
        let least_s: Vec<f64> = (0..nodes)
            .flat_map(|from| least_times_s(tables, from))
            .collect();
        let home_s = (0..nodes).map(|from| {
            let ends = tables.destinations.iter();
            let ends_s = ends.map(|&end| least_s[from * nodes + end as usize]);
            ends_s.fold(f64::INFINITY, f64::min)
        });
        Self {
            home_s: home_s.collect(),
            least_s,
            nodes,
            end_s: tables.problem.time_available_s + auv_graph::TIME_TOLERANCE_S,
            start: tables.problem.start.index(),
        }
    }

    /// The nodes that a route at a node can still visit; `closes`: the start again too, on its way there.
    pub(super) fn open(&self, node: u32, ready_s: f64, visited: u128, closes: bool) -> u128 {
        let shut = if closes {
            visited & !(1 << self.start)
        } else {
            visited
        };
        let is_open =
            |to: &usize| shut >> to & 1 == 0 && self.is_within(node as usize, *to, ready_s);
        let nodes = (0..self.nodes).filter(is_open);
        nodes.fold(0_u128, |open, to| open | 1 << to) & !visited
    }

    /// Whether a route at a node can come to another one and home in time.
    fn is_within(&self, node: usize, to: usize, ready_s: f64) -> bool {
        ready_s + self.least_s[node * self.nodes + to] + self.home_s[to] <= self.end_s
    }
}

/// A bound of the weight: of all tasks that can be reached, and of one edge into each node.
#[must_use]
pub fn most_of_all(tables: &TimedNetwork<'_>) -> f64 {
    let reach = Reach::new(tables);
    let start = reach.start;
    let on_edge: Vec<_> = tables.works.iter().filter(|work| work.is_on_edge).collect();
    let mut most = vec![0.0_f64; reach.nodes];
    for arc in tables.problem.network.arcs() {
        let (tail, head) = (arc.tail.0, arc.head.0);
        if tables.connects(tail, head) {
            let along = on_edge.iter().filter(|work| work.is_along(tail, head));
            let weight = along.fold(tables.own_weight(tail, head), |sum, work| sum + work.weight);
            most[head as usize] = most[head as usize].max(weight);
        }
    }
    for (node, tasks) in tables.at_node.iter().enumerate() {
        let arrival_s = reach.least_s[start * reach.nodes + node];
        for &task in tasks {
            let starts = tables.model.tasks[task as usize].earliest_start_s(arrival_s);
            if starts.is_some() {
                most[node] += tables.works[task as usize].weight;
            }
        }
    }
    let within = (0..reach.nodes).filter(|&node| reach.is_within(start, node, 0.0));
    within.map(|node| most[node]).sum()
}

/// Least times from a node to all, at any departures, seconds.
fn least_times_s(tables: &TimedNetwork<'_>, from: usize) -> Vec<f64> {
    let network = tables.problem.network;
    let mut least_s = vec![f64::INFINITY; tables.nodes()];
    least_s[from] = 0.0;
    let mut heap = BinaryHeap::from([Reverse((0_u64, from as u32))]);
    while let Some(Reverse((bits, at))) = heap.pop() {
        let at_s = f64::from_bits(bits);
        if at_s > least_s[at as usize] {
            continue;
        }
        for arc in network.range_from(auv_graph::NodeId(at)) {
            let head = network.heads()[arc].0;
            // The task of an edge passed again is not done again.
            let there_s = at_s + (tables.least_s(at, head) - tables.own_s(at, head)).max(0.0);
            if there_s < least_s[head as usize] {
                least_s[head as usize] = there_s;
                heap.push(Reverse((there_s.to_bits(), head)));
            }
        }
    }
    least_s
}
