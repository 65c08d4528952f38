//! Bounded labelling: partial routes are extended node by node, and those are dropped that another one
//! at the same node beats in time and weight.
//!
//! A partial route only beats another if it has not visited more of the nodes near by. With no such nodes
//! the search is quick and may miss the best route; the more it looks at, the more it finds.
//!
//! # References
//! Righini and Salani, "Decremental state space relaxation strategies and initialization heuristics for
//! solving the orienteering problem with time windows with dynamic programming", Computers and Operations
//! Research 36(4), 2009.

use auv_graph::TIME_TOLERANCE_S;
use auv_planning::Run;
use auv_planning::timed::{NO_TASK, Step, TimedNetwork};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Words of a set of nodes.
const WORDS: usize = 5;
/// Labels extended between two looks at the clock.
const BATCH: u64 = 32;
const NO_PARENT: u32 = u32::MAX;

type NodeSet = [u64; WORDS];

/// A partial route.
struct Label {
    ready_s: f64,
    weight: f64,
    /// Its last node, by place among the customers.
    at: u32,
    parent: u32,
    visited: NodeSet,
    is_beaten: bool,
}

/// A node with its one task.
struct Customer {
    step: Step,
    weight: f64,
    /// Least time from it to the end in seconds.
    home_s: f64,
    /// Those near it.
    near: NodeSet,
}

/// Labelling of a problem in which each node has one task at most and edges have no weights.
pub(super) struct Labelling<'a> {
    tables: &'a TimedNetwork<'a>,
    customers: Vec<Customer>,
    /// Customers by distance, for each.
    by_distance: Vec<Vec<u32>>,
    start: u32,
    end: u32,
}

/// How a labelling ended.
pub(super) enum Labelled {
    /// All partial routes were extended, or as many as allowed.
    Ended(Vec<Step>),
    /// The run stopped it; the best so far.
    Stopped(Vec<Step>),
}

impl<'a> Labelling<'a> {
    /// `None` if there are too many tasks.
    pub(super) fn new(tables: &'a TimedNetwork<'a>) -> Option<Self> {
        let start = tables.problem.start.0;
        let &[end] = &tables.destinations[..] else {
            return None;
        };
        if tables.works.len() > 64 * WORDS {
            return None;
        }
        let customers: Vec<_> = (0..tables.works.len())
            .map(|task| {
                let node = tables.works[task].ends[0];
                let task = task as u32;
                Customer {
                    step: Step { node, task },
                    weight: tables.works[task as usize].weight,
                    home_s: tables.least_s(node, end),
                    near: [0; WORDS],
                }
            })
            .filter(|customer| customer.weight > 0.0 && ![start, end].contains(&customer.step.node))
            .collect();
        let order = |from: &Customer| {
            let least_s =
                |&i: &u32| tables.least_s(from.step.node, customers[i as usize].step.node);
            let mut order: Vec<u32> = (0..customers.len() as u32).collect();
            order.sort_by(|a, b| least_s(a).total_cmp(&least_s(b)).then(a.cmp(b)));
            order
        };
        let by_distance = customers.iter().map(order).collect();
        Some(Self {
            tables,
            customers,
            by_distance,
            start,
            end,
        })
    }

    /// The route of most weight found; a label is beaten only by one that has visited no more of its
    /// `near` nearest customers. At most `most` labels are extended. One evaluation is one extension.
    pub(super) fn run(&mut self, run: &mut Run<'_>, near: usize, most: u64) -> Labelled {
        for (customer, order) in self.customers.iter_mut().zip(&self.by_distance) {
            customer.near = [0; WORDS];
            for &other in order.iter().take(near) {
                insert(&mut customer.near, other);
            }
        }
        let mut labels = vec![Label {
            ready_s: 0.0,
            weight: 0.0,
            at: NO_TASK,
            parent: NO_PARENT,
            visited: [0; WORDS],
            is_beaten: false,
        }];
        let mut at_node: Vec<Vec<u32>> = vec![Vec::new(); self.customers.len()];
        let mut open = BinaryHeap::from([Reverse((0_u64, 0_u32))]);
        let (mut best, mut granted, mut extended) = (0_u32, 0, 0);
        while let Some(Reverse((_, id))) = open.pop() {
            if labels[id as usize].is_beaten {
                continue;
            }
            if granted == 0 {
                granted = run.grant(BATCH);
                if granted == 0 {
                    return Labelled::Stopped(self.steps(&labels, best));
                }
            }
            granted -= 1;
            extended += 1;
            let first_new = labels.len();
            self.extend(&mut labels, &mut at_node, id);
            for new in first_new..labels.len() {
                // Times are not negative, so their bits are in the same order as they are.
                open.push(Reverse((labels[new].ready_s.to_bits(), new as u32)));
                if labels[new].weight > labels[best as usize].weight {
                    best = new as u32;
                }
            }
            if extended >= most {
                break;
            }
        }
        Labelled::Ended(self.steps(&labels, best))
    }

    fn extend(&self, labels: &mut Vec<Label>, at_node: &mut [Vec<u32>], id: u32) {
        let tables = self.tables;
        let (ready_s, weight, at, visited) = {
            let label = &labels[id as usize];
            (label.ready_s, label.weight, label.at, label.visited)
        };
        let from = self
            .customers
            .get(at as usize)
            .map_or(self.start, |c| c.step.node);
        let last_s = tables.problem.time_available_s + TIME_TOLERANCE_S;
        for (i, customer) in self.customers.iter().enumerate() {
            if contains(&visited, i as u32) {
                continue;
            }
            let arrival_s = tables.arrival_s(from, customer.step.node, ready_s);
            let ready_s = tables.ready_s(customer.step.task, arrival_s);
            if ready_s + customer.home_s > last_s {
                continue;
            }
            let mut new = Label {
                ready_s,
                weight: weight + customer.weight,
                at: i as u32,
                parent: id,
                visited,
                is_beaten: false,
            };
            insert(&mut new.visited, i as u32);
            keep(labels, &mut at_node[i], &customer.near, new);
        }
    }

    fn steps(&self, labels: &[Label], best: u32) -> Vec<Step> {
        let mut steps = vec![Step::pass(self.end)];
        let mut id = best;
        while let Some(label) = labels.get(id as usize) {
            if let Some(customer) = self.customers.get(label.at as usize) {
                steps.push(customer.step);
            }
            id = label.parent;
        }
        steps.push(Step::pass(self.start));
        steps.reverse();
        steps
    }
}

/// Adds a label to those of its node unless one of them beats it; drops those that it beats.
fn keep(labels: &mut Vec<Label>, at_node: &mut Vec<u32>, near: &NodeSet, new: Label) {
    let beats = |a: &Label, b: &Label| {
        a.ready_s <= b.ready_s
            && a.weight >= b.weight
            && (0..WORDS).all(|w| a.visited[w] & near[w] & !b.visited[w] == 0)
    };
    if at_node
        .iter()
        .any(|&other| beats(&labels[other as usize], &new))
    {
        return;
    }
    at_node.retain(|&other| {
        let is_beaten = beats(&new, &labels[other as usize]);
        labels[other as usize].is_beaten |= is_beaten;
        !is_beaten
    });
    at_node.push(labels.len() as u32);
    labels.push(new);
}

fn insert(set: &mut NodeSet, i: u32) {
    set[i as usize / 64] |= 1 << (i % 64);
}

fn contains(set: &NodeSet, i: u32) -> bool {
    set[i as usize / 64] >> (i % 64) & 1 == 1
}
