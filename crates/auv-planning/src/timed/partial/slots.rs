//! A problem in time with its times rounded down to slots: whatever can be done, can be done here.

use crate::timed::timed_network::TimedNetwork;

/// Not in time.
pub(super) const NEVER: u16 = u16::MAX;
const MOST_SLOTS: usize = 1024;
const LEAST_SLOTS: usize = 32;
/// Most tasks of a node that are told apart.
const MOST_TASKS: usize = 5;

/// An arc that a route can use, and what its tasks weigh.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlottedArc {
    pub(super) tail: u32,
    pub(super) head: u32,
    pub(super) weight: f64,
}

/// Work at a node.
#[derive(Clone, Debug)]
pub(super) struct SlottedTask {
    pub(super) weight: f64,
    /// The slot when it is ready, by the slot of arrival.
    pub(super) ready: Vec<u16>,
}

/// The problem in slots. A node has a row for each set of its tasks that may be done, all of them last. Where a
/// node has too many tasks, they are one that takes no time.
#[derive(Debug)]
pub(super) struct Slots {
    pub(super) count: usize,
    slot_s: f64,
    pub(super) arcs: Vec<SlottedArc>,
    /// The slot of arrival by the slot of departure and the arc.
    arrival: Vec<u16>,
    tasks: Vec<Vec<SlottedTask>>,
    /// By node: whether its tasks are joined to one.
    is_joined: Vec<bool>,
    pub(super) first_row: Vec<usize>,
    /// Whether a route may leave a node without doing its tasks.
    pub(super) may_leave: bool,
    /// By node: whether a route may end there.
    pub(super) is_end: Vec<bool>,
    pub(super) start: u32,
    /// What the tasks at the start weigh.
    pub(super) at_start: f64,
}

impl Slots {
    /// `steps`: about how many arrivals are kept.
    pub(super) fn new(tables: &TimedNetwork<'_>, steps: usize) -> Self {
        let nodes = tables.nodes() as u32;
        let arcs = arcs(tables);
        let count = (steps / arcs.len().max(1)).clamp(LEAST_SLOTS, MOST_SLOTS);
        let end_s = tables.problem.time_available_s + auv_graph::TIME_TOLERANCE_S;
        let start = tables.problem.start.0;
        let at_start = tables.at_node[start as usize].iter();
        let mut slots = Self {
            count,
            slot_s: end_s / (count - 1) as f64,
            arrival: Vec::new(),
            tasks: Vec::new(),
            is_joined: tables
                .at_node
                .iter()
                .map(|list| list.len() > MOST_TASKS)
                .collect(),
            first_row: Vec::new(),
            may_leave: !tables.passing_works(),
            is_end: (0..nodes)
                .map(|node| tables.destinations.contains(&node))
                .collect(),
            start,
            at_start: at_start.fold(0.0, |sum, &task| sum + tables.works[task as usize].weight),
            arcs,
        };
        for slot in 0..count {
            let begins_s = slot as f64 * slots.slot_s;
            for arc in &slots.arcs {
                // The task of an edge passed again, back to the start, is not done again.
                let again = arc.head == start;
                let own_s = if again {
                    tables.own_s(arc.tail, arc.head)
                } else {
                    0.0
                };
                let arrival_s = tables.arrival_s(arc.tail, arc.head, begins_s) - own_s;
                slots.arrival.push(slots.slot_by(arrival_s, slot));
            }
        }
        let mut rows = 0;
        for node in 0..nodes {
            slots.first_row.push(rows);
            let tasks = slots.tasks_of(tables, node);
            rows += 1 << tasks.len();
            slots.tasks.push(tasks);
        }
        slots.first_row.push(rows);
        slots
    }

    pub(super) fn rows(&self) -> usize {
        self.first_row[self.first_row.len() - 1]
    }

    /// The row of a node with all of its tasks done.
    pub(super) fn departure_row(&self, node: usize) -> usize {
        self.first_row[node + 1] - 1
    }

    /// The row of a node with some tasks done, as a set.
    pub(super) fn row(&self, node: usize, done: usize) -> usize {
        self.first_row[node] + if self.is_joined[node] { 0 } else { done }
    }

    pub(super) fn arrival(&self, arc: usize, slot: usize) -> u16 {
        self.arrival[slot * self.arcs.len() + arc]
    }

    /// The tasks of a node that are not done, each with what is done after it.
    pub(super) fn tasks_at(
        &self,
        node: usize,
        done: usize,
    ) -> impl Iterator<Item = (&SlottedTask, usize)> {
        let tasks = self.tasks[node].iter().enumerate();
        tasks.filter_map(move |(i, task)| (done >> i & 1 == 0).then_some((task, done | 1 << i)))
    }

    /// The slot of a time.
    pub(super) fn slot(&self, at_s: f64) -> usize {
        // With room for the rounding of the division.
        ((at_s / self.slot_s - 1e-9).max(0.0) as usize).min(self.count - 1)
    }

    /// The slot of a time after that of the slot `from`.
    fn slot_by(&self, at_s: f64, from: usize) -> u16 {
        let end_s = self.slot_s * (self.count - 1) as f64;
        if at_s > end_s * (1.0 + 1e-12) {
            NEVER
        } else {
            self.slot(at_s).max(from) as u16
        }
    }

    fn tasks_of(&self, tables: &TimedNetwork<'_>, node: u32) -> Vec<SlottedTask> {
        let tasks = &tables.at_node[node as usize];
        let ready_s = |task: u32, arrival_s: f64| {
            let start_s = tables.model.tasks[task as usize].earliest_start_s(arrival_s);
            start_s.map(|start_s| start_s + tables.works[task as usize].delta_s)
        };
        if self.is_joined[node as usize] {
            let weight = tasks
                .iter()
                .fold(0.0, |sum, &task| sum + tables.works[task as usize].weight);
            let ready = (0..self.count as u16).collect();
            return vec![SlottedTask { weight, ready }];
        }
        let slotted = |&task: &u32| {
            let ready = |slot: usize| {
                let ready_s = ready_s(task, slot as f64 * self.slot_s);
                ready_s.map_or(NEVER, |ready_s| self.slot_by(ready_s, slot))
            };
            SlottedTask {
                weight: tables.works[task as usize].weight,
                ready: (0..self.count).map(ready).collect(),
            }
        };
        tasks.iter().map(slotted).collect()
    }
}

/// The arcs that a route can use.
fn arcs(tables: &TimedNetwork<'_>) -> Vec<SlottedArc> {
    let start = tables.problem.start.0;
    let is_round = tables.destinations.contains(&start);
    let arcs = tables.problem.network.arcs().iter();
    let arcs = arcs.map(|arc| (arc.tail.0, arc.head.0));
    let usable = arcs.filter(|&(tail, head)| {
        // A route ends at the only destination when it comes there.
        let is_over = !is_round && tables.destinations[..] == [tail];
        tables.connects(tail, head) && !is_over && (is_round || head != start)
    });
    let slotted = |(tail, head)| {
        let on_edge = tables.works.iter().filter(|work| work.is_along(tail, head));
        SlottedArc {
            tail,
            head,
            weight: on_edge.fold(tables.own_weight(tail, head), |sum, work| sum + work.weight),
        }
    };
    usable.map(slotted).collect()
}
