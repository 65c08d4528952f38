//! What a partial route can still earn at most.

use crate::timed::timed_network::TimedNetwork;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Upper bounds of what the nodes can earn, and least times between them.
#[derive(Debug)]
pub(super) struct Potential {
    /// By pair of nodes, seconds.
    least_s: Vec<f64>,
    /// Least time to a destination, seconds.
    pub(super) home_s: Vec<f64>,
    /// By node: the most that an edge into it earns, its own task and others.
    edge: Vec<f64>,
    /// By node: weight of each task there and the latest time when it may begin.
    tasks: Vec<Vec<(f64, f64)>>,
    nodes: usize,
    end_s: f64,
    start: usize,
}

impl Potential {
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
        let mut on_edge = vec![Vec::new(); nodes];
        for work in tables.works.iter().filter(|work| work.is_on_edge) {
            let [a, b] = work.ends;
            on_edge[b as usize].push((a, work.weight));
            if !work.is_one_way {
                on_edge[a as usize].push((b, work.weight));
            }
        }
        let mut edge = vec![0.0_f64; nodes];
        for arc in tables.problem.network.arcs() {
            let (tail, head) = (arc.tail.0, arc.head.0);
            if tables.connects(tail, head) {
                let others = on_edge[head as usize]
                    .iter()
                    .filter(|(from, _)| *from == tail);
                let tasks = others.fold(0.0, |sum, (_, weight)| sum + weight);
                let most = &mut edge[head as usize];
                *most = most.max(tables.own_weight(tail, head) + tasks);
            }
        }
        let task = |&task: &u32| {
            let latest = tables.model.tasks[task as usize].latest_start_s(f64::INFINITY);
            (
                tables.works[task as usize].weight,
                latest.unwrap_or(f64::NEG_INFINITY),
            )
        };
        Self {
            home_s: home_s.collect(),
            least_s,
            edge,
            tasks: tables
                .at_node
                .iter()
                .map(|list| list.iter().map(task).collect())
                .collect(),
            nodes,
            end_s: tables.problem.time_available_s + auv_graph::TIME_TOLERANCE_S,
            start: tables.problem.start.index(),
        }
    }

    /// What a route at a node can still earn at nodes that it has not visited; `closes`: at the start again too.
    pub(super) fn of(&self, node: u32, ready_s: f64, visited: u128, closes: bool) -> f64 {
        let from = node as usize * self.nodes;
        let mut most = 0.0;
        for to in 0..self.nodes {
            if visited >> to & 1 == 1 && !(closes && to == self.start) {
                continue;
            }
            let arrival_s = ready_s + self.least_s[from + to];
            if arrival_s + self.home_s[to] <= self.end_s {
                most += self.at(to, arrival_s);
            }
        }
        most
    }

    /// What the tasks at a node, and the edge that leads there, can earn from an arrival on.
    fn at(&self, node: usize, arrival_s: f64) -> f64 {
        let late = auv_graph::TIME_TOLERANCE_S;
        let open = self.tasks[node]
            .iter()
            .filter(|(_, latest_s)| arrival_s <= latest_s + late);
        open.fold(self.edge[node], |sum, (weight, _)| sum + weight)
    }

    /// What all nodes can earn.
    fn of_all(&self) -> f64 {
        let from = self.start * self.nodes;
        let within = |to: &usize| self.least_s[from + to] + self.home_s[*to] <= self.end_s;
        let nodes = (0..self.nodes).filter(within);
        nodes.fold(0.0, |sum, node| {
            sum + self.at(node, self.least_s[from + node])
        })
    }
}

/// A bound of the weight: that of all tasks that can be reached.
#[must_use]
pub fn most_of_all(tables: &TimedNetwork<'_>) -> f64 {
    Potential::new(tables).of_all()
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
