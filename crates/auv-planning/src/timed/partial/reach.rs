//! Which nodes a partial route can still visit.

use crate::timed::timed_network::TimedNetwork;

/// Until when a route at a node can still visit others and come home in time.
#[derive(Debug)]
pub(super) struct Reach {
    /// Least time to a destination, seconds.
    pub(super) home_s: Vec<f64>,
    /// By node: the latest times to leave for other nodes, ascending, each with the nodes that can still be
    /// visited until then.
    until: Vec<Vec<(f64, u128)>>,
}

impl Reach {
    pub(super) fn new(tables: &TimedNetwork<'_>) -> Self {
        let nodes = tables.nodes();
        let least_s = |from: usize, to: usize| tables.least_way_s(from as u32, to as u32);
        let home_s: Vec<f64> = (0..nodes as u32).map(|from| home_s(tables, from)).collect();
        // With room for the rounding of the sums.
        let end_s = tables.problem.time_available_s + 2.0 * auv_graph::TIME_TOLERANCE_S;
        let until = |from: usize| {
            let leave_s = |to: usize| end_s - (least_s(from, to) + home_s[to]);
            let mut until: Vec<_> = (0..nodes).map(|to| (leave_s(to), 1_u128 << to)).collect();
            until.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for i in (1..until.len()).rev() {
                until[i - 1].1 |= until[i].1;
            }
            until
        };
        Self {
            until: (0..nodes).map(until).collect(),
            home_s,
        }
    }

    /// The nodes to which a route at a node can go and come home in time.
    pub(super) fn within(&self, node: u32, ready_s: f64) -> u128 {
        let until = &self.until[node as usize];
        let first = until.partition_point(|(leave_s, _)| *leave_s < ready_s);
        until.get(first).map_or(0, |(_, within)| *within)
    }
}

/// A bound of the weight: of all tasks that can be reached, and of one edge into each node.
#[must_use]
pub fn most_of_all(tables: &TimedNetwork<'_>) -> f64 {
    let start = tables.problem.start.0;
    let on_edge: Vec<_> = tables.works.iter().filter(|work| work.is_on_edge).collect();
    let mut most = vec![0.0_f64; tables.nodes()];
    for arc in tables.problem.network.arcs() {
        let (tail, head) = (arc.tail.0, arc.head.0);
        if tables.connects(tail, head) {
            let along = on_edge.iter().filter(|work| work.is_along(tail, head));
            let weight = along.fold(tables.own_weight(tail, head), |sum, work| sum + work.weight);
            most[head as usize] = most[head as usize].max(weight);
        }
    }
    for (node, tasks) in tables.at_node.iter().enumerate() {
        let arrival_s = tables.least_way_s(start, node as u32);
        for &task in tasks {
            let starts = tables.model.tasks[task as usize].earliest_start_s(arrival_s);
            if starts.is_some() {
                most[node] += tables.works[task as usize].weight;
            }
        }
    }
    let end_s = tables.problem.time_available_s + auv_graph::TIME_TOLERANCE_S;
    let is_within = |&node: &u32| tables.least_way_s(start, node) + home_s(tables, node) <= end_s;
    let within = (0..tables.nodes() as u32).filter(is_within);
    within.map(|node| most[node as usize]).sum()
}

/// Least time from a node to a destination, seconds.
fn home_s(tables: &TimedNetwork<'_>, from: u32) -> f64 {
    let ends = tables.destinations.iter();
    let ends_s = ends.map(|&end| tables.least_way_s(from, end));
    ends_s.fold(f64::INFINITY, f64::min)
}
