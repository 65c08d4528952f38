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
    /// What can be earned, most for its time first.
    earnings: Vec<Earning>,
    nodes: usize,
    end_s: f64,
    start: usize,
}

/// A step of what the edges into a node earn for their least time, or a task at the node.
#[derive(Clone, Copy, Debug)]
struct Earning {
    node: usize,
    weight: f64,
    /// Least time that it takes, seconds.
    time_s: f64,
    /// The latest arrival at the node, seconds.
    latest_s: f64,
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
        let into = edges_into(tables);
        let most =
            |edges: &Vec<[f64; 2]>| edges.iter().fold(0.0_f64, |most, edge| most.max(edge[1]));
        let edge = into.iter().map(most).collect();
        let task = |&task: &u32| {
            let latest = tables.model.tasks[task as usize].latest_start_s(f64::INFINITY);
            (
                tables.works[task as usize].weight,
                latest.unwrap_or(f64::NEG_INFINITY),
            )
        };
        Self {
            earnings: earnings(tables, into),
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

    /// What a route at a node can still earn at nodes that it has not visited, and the nodes it can still visit;
    /// `closes`: at the start again too. The time left is given to what earns most for its least time, the last
    /// of it in part: a fractional knapsack.
    pub(super) fn of(&self, node: u32, ready_s: f64, visited: u128, closes: bool) -> (f64, u128) {
        let least_s = &self.least_s[node as usize * self.nodes..][..self.nodes];
        let shut = if closes {
            visited & !(1 << self.start)
        } else {
            visited
        };
        let is_open = |to: &usize| {
            shut >> to & 1 == 0 && ready_s + least_s[*to] + self.home_s[*to] <= self.end_s
        };
        let nodes = (0..self.nodes).filter(is_open);
        let open = nodes.fold(0_u128, |open, to| open | 1 << to);
        let (mut most, mut left_s) = (0.0, self.end_s - ready_s);
        for earning in &self.earnings {
            let arrival_s = ready_s + least_s[earning.node];
            if open >> earning.node & 1 == 0 || arrival_s > earning.latest_s {
                continue;
            }
            if earning.time_s > left_s {
                most += earning.weight * (left_s / earning.time_s).max(0.0);
                break;
            }
            most += earning.weight;
            left_s -= earning.time_s;
        }
        (most, open & !visited)
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

/// For each node the edges into it: least time, and what their tasks weigh.
fn edges_into(tables: &TimedNetwork<'_>) -> Vec<Vec<[f64; 2]>> {
    let mut on_edge = vec![Vec::new(); tables.nodes()];
    for work in tables.works.iter().filter(|work| work.is_on_edge) {
        let [a, b] = work.ends;
        on_edge[b as usize].push((a, work.weight));
        if !work.is_one_way {
            on_edge[a as usize].push((b, work.weight));
        }
    }
    let mut into = vec![Vec::new(); tables.nodes()];
    for arc in tables.problem.network.arcs() {
        let (tail, head) = (arc.tail.0, arc.head.0);
        if !tables.connects(tail, head) {
            continue;
        }
        let others = on_edge[head as usize].iter();
        let others = others.filter(|(from, _)| *from == tail);
        let tasks = others.fold(0.0, |sum, (_, weight)| sum + weight);
        let weight = tables.own_weight(tail, head) + tasks;
        // The task of an edge passed again, back to the start, is not done again.
        let is_again = head == tables.problem.start.0;
        let own_s = if is_again {
            tables.own_s(tail, head)
        } else {
            0.0
        };
        into[head as usize].push([(tables.least_s(tail, head) - own_s).max(0.0), weight]);
    }
    into
}

/// What can be earned, most for its time first. `into`: least time and most weight of each edge into each node.
fn earnings(tables: &TimedNetwork<'_>, into: Vec<Vec<[f64; 2]>>) -> Vec<Earning> {
    let into = into.into_iter().enumerate();
    let arrivals = into.flat_map(|(node, edges)| {
        let steps = concave(edges).into_iter();
        steps.map(move |[time_s, weight]| Earning {
            node,
            weight,
            time_s,
            latest_s: f64::INFINITY,
        })
    });
    let of_task = |(node, &task): (usize, &u32)| {
        let work = &tables.works[task as usize];
        let latest_s = tables.model.tasks[task as usize].latest_start_s(f64::INFINITY);
        Earning {
            node,
            weight: work.weight,
            time_s: work.delta_s,
            latest_s: latest_s.unwrap_or(f64::NEG_INFINITY) + auv_graph::TIME_TOLERANCE_S,
        }
    };
    let at_nodes = tables.at_node.iter().enumerate();
    let tasks = at_nodes.flat_map(|(node, list)| list.iter().map(move |task| (node, task)));
    let mut earnings: Vec<Earning> = arrivals.chain(tasks.map(of_task)).collect();
    earnings.retain(|earning| earning.weight > 0.0);
    earnings.sort_by(|a, b| (b.weight * a.time_s).total_cmp(&(a.weight * b.time_s)));
    earnings
}

/// The steps, in time and weight, of the least concave function that is 0 at 0 and nowhere below these points.
fn concave(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(b[1].total_cmp(&a[1])));
    let mut hull = vec![[0.0, 0.0]];
    for point in points {
        if point[1] <= hull[hull.len() - 1][1] {
            continue;
        }
        while let [.., a, b] = hull[..]
            && (b[1] - a[1]) * (point[0] - a[0]) <= (point[1] - a[1]) * (b[0] - a[0])
        {
            hull.pop();
        }
        hull.push(point);
    }
    hull.windows(2)
        .map(|pair| [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]])
        .collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_edges_are_concave_and_nowhere_below_them() {
        let steps = concave(vec![
            [4.0, 5.0],
            [2.0, 1.0],
            [1.0, 2.0],
            [3.0, 4.0],
            [9.0, 5.0],
        ]);
        assert_eq!(steps, [[1.0, 2.0], [3.0, 3.0]]);
        assert!(concave(vec![[2.0, 0.0]]).is_empty());
    }
}
