//! What a partial route can still earn at most, by place and time, if it may visit nodes again but pays a price
//! for each visit. The prices are the multipliers of the rule that no node is visited twice.
//!
//! # References
//! Christofides, Mingozzi and Toth, "State-space relaxation procedures for the computation of bounds to routing
//! problems", Networks 11(2), 1981. Houck, Picard, Queyranne and Vemuganti, "The travelling salesman problem as a
//! constrained shortest path problem", Opsearch 17, 1980 (no return to the node before).

use super::label::Label;
use super::slots::{NEVER, Slots, SlottedArc, SlottedTask};
use crate::Run;
use crate::timed::timed_network::TimedNetwork;

/// Slots of time times arcs of the tables, and of the coarse ones that look for prices first.
const STEPS: usize = 100_000;
const COARSE_STEPS: usize = 20_000;
/// Passes over the coarse tables, and over the fine ones.
const COARSE_PASSES: usize = 25;
const PASSES: usize = 8;
/// Evaluations that a pass counts as.
const EVALUATIONS: u64 = 16;
/// Passes without progress after which the steps of the prices are halved.
const PATIENCE: usize = 4;
/// How much of a step the next one keeps.
const MOMENTUM: f64 = 0.3;
/// No node follows: the route ends.
const END: u32 = u32::MAX;

/// The most that any continuation is worth and the node that it goes to first; the most of those that go to
/// another one first.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Most {
    value: f64,
    via: u32,
    other: f64,
    other_via: u32,
}

impl Most {
    const NONE: Self = Self {
        value: f64::NEG_INFINITY,
        via: END,
        other: f64::NEG_INFINITY,
        other_via: END,
    };

    fn add(&mut self, value: f64, via: u32) {
        if via == self.via {
            self.value = self.value.max(value);
        } else if value > self.value {
            (self.other, self.other_via) = (self.value, self.via);
            (self.value, self.via) = (value, via);
        } else if value > self.other {
            (self.other, self.other_via) = (value, via);
        }
    }

    fn add_all(&mut self, most: Self, more: f64) {
        self.add(most.value + more, most.via);
        self.add(most.other + more, most.other_via);
    }

    /// The most of what does not go to a node first, and where it goes.
    fn avoiding(&self, node: u32) -> (f64, u32) {
        if self.via == node {
            (self.other, self.other_via)
        } else {
            (self.value, self.via)
        }
    }

    /// The most of what goes to a node first.
    fn going(&self, via: u32) -> f64 {
        match via {
            via if via == self.via => self.value,
            via if via == self.other_via => self.other,
            _ => f64::NEG_INFINITY,
        }
    }
}

/// The tables. A row is a node with some of its tasks done.
#[derive(Debug)]
pub(super) struct Priced {
    slots: Slots,
    /// By node.
    price: Vec<f64>,
    /// By row and slot.
    most: Vec<Most>,
}

impl Priced {
    /// The tables with prices that make the bound of the whole problem low; with the best found when the run stops.
    /// `least`: what a known route weighs.
    pub(super) fn new(run: &mut Run<'_>, tables: &TimedNetwork<'_>, least: f64) -> Self {
        let mut coarse = Self::with(Slots::new(tables, COARSE_STEPS), vec![0.0; tables.nodes()]);
        let mut share = 1.0;
        coarse.find_prices(run, least, COARSE_PASSES, &mut share);
        let mut fine = Self::with(Slots::new(tables, STEPS), coarse.price);
        fine.find_prices(run, least, PASSES, &mut share);
        fine
    }

    fn with(slots: Slots, price: Vec<f64>) -> Self {
        let most = vec![Most::NONE; slots.rows() * slots.count];
        Self { slots, price, most }
    }

    /// Improves the prices by steps along the subgradient, and fills the tables with the best.
    fn find_prices(&mut self, run: &mut Run<'_>, least: f64, passes: usize, share: &mut f64) {
        let mut best = (f64::INFINITY, self.price.clone());
        let (mut failed, mut direction) = (0, vec![0.0; self.price.len()]);
        for _ in 0..passes {
            if run.grant(EVALUATIONS) == 0 {
                break;
            }
            self.fill();
            let bound = self.of_start();

            if bound < best.0 {
                best = (bound, self.price.clone());
            } else {
                failed += 1;
                *share *= if failed % PATIENCE == 0 { 0.5 } else { 1.0 };
            }
            let visits = self.visits();
            let change = |(visits, price): (&f64, &f64)| {
                let is_free = *visits == 0.0 && *price <= 0.0;
                if is_free { 0.0 } else { visits - 1.0 }
            };
            let changes: Vec<f64> = visits.iter().zip(&self.price).map(change).collect();
            for (kept, change) in direction.iter_mut().zip(changes) {
                *kept = change + MOMENTUM * *kept;
            }
            let norm = direction.iter().fold(0.0, |sum, by| sum + by * by);
            if norm <= 0.0 || bound <= least {
                break;
            }
            let step = *share * (bound - least) / norm;
            for (price, change) in self.price.iter_mut().zip(&direction) {
                *price = (*price + step * change).max(0.0);
            }
        }
        self.price = best.1;
        self.fill();
    }

    fn at(&self, row: usize, slot: usize) -> &Most {
        &self.most[row * self.slots.count + slot]
    }

    fn at_mut(&mut self, row: usize, slot: usize) -> &mut Most {
        &mut self.most[row * self.slots.count + slot]
    }

    fn of_start(&self) -> f64 {
        let prices: f64 = self.price.iter().sum();
        prices
            + self
                .at(self.slots.first_row[self.slots.start as usize], 0)
                .value
    }

    /// Fills the tables, the last slot first. What can be done later can be done earlier.
    fn fill(&mut self) {
        for slot in (0..self.slots.count).rev() {
            for row in 0..self.slots.rows() {
                let later = slot + 1 < self.slots.count;
                *self.at_mut(row, slot) = if later {
                    *self.at(row, slot + 1)
                } else {
                    Most::NONE
                };
            }
            for node in 0..self.price.len() {
                if self.slots.is_end[node] {
                    let departure = self.slots.departure_row(node);
                    self.at_mut(departure, slot).add(0.0, END);
                }
            }
            let mut within = Vec::new();
            for arc in 0..self.slots.arcs.len() {
                let arrival = self.slots.arrival(arc, slot);
                if arrival as usize == slot {
                    within.push(arc);
                } else if arrival != NEVER {
                    self.add_along(arc, (slot, arrival as usize));
                }
            }
            for node in 0..self.price.len() {
                self.add_tasks(node, slot);
            }
            self.add_within(slot, &within);
        }
    }

    /// Arcs that lead nowhere in time: routes of them have as many as there are nodes at most.
    fn add_within(&mut self, slot: usize, within: &[usize]) {
        for _ in 0..if within.is_empty() {
            0
        } else {
            self.price.len()
        } {
            let mut is_changed = false;
            for &arc in within {
                if self.add_along(arc, (slot, slot)) {
                    self.add_tasks(self.slots.arcs[arc].tail as usize, slot);
                    is_changed = true;
                }
            }
            if !is_changed {
                return;
            }
        }
    }

    /// Adds what an arc leads to; whether that changes anything.
    fn add_along(&mut self, arc: usize, (slot, arrival): (usize, usize)) -> bool {
        let arc = self.slots.arcs[arc];
        let head = arc.head as usize;
        let rest = if arc.head == self.slots.start {
            self.slots.at_start
        } else {
            let most = self.at(self.slots.first_row[head], arrival);
            most.avoiding(arc.tail).0 - self.price[head]
        };
        let departure = self.slots.departure_row(arc.tail as usize);
        let most = self.at_mut(departure, slot);
        let before = *most;
        most.add(arc.weight + rest, arc.head);
        *most != before
    }

    /// Adds what the tasks of a node lead to: from more tasks done to fewer.
    fn add_tasks(&mut self, node: usize, slot: usize) {
        let first = self.slots.first_row[node];
        let departure = self.slots.departure_row(node);
        for row in (first..departure).rev() {
            let mut most = *self.at(row, slot);
            if self.slots.may_leave {
                most.add_all(*self.at(departure, slot), 0.0);
            }
            for (task, next) in self.slots.tasks_at(node, row - first) {
                let ready = task.ready[slot];
                if ready != NEVER {
                    most.add_all(*self.at(first + next, ready as usize), task.weight);
                }
            }
            *self.at_mut(row, slot) = most;
        }
    }

    /// How often the best route of the tables visits each node.
    fn visits(&self) -> Vec<f64> {
        let slots = &self.slots;
        let mut visits = vec![0.0; self.price.len()];
        let (mut node, mut before, mut slot) = (slots.start as usize, END - 1, 0);
        let mut done = 0;
        for _ in 0..self.most.len() {
            let (first, departure) = (slots.first_row[node], slots.departure_row(node));
            let (value, via) = self.at(first + done, slot).avoiding(before);
            while slot + 1 < slots.count && self.at(first + done, slot + 1).going(via) >= value {
                slot += 1;
            }
            let does = |(task, next): &(&SlottedTask, usize)| {
                let ready = task.ready[slot];
                ready != NEVER
                    && self.at(first + next, ready as usize).going(via) + task.weight >= value
            };
            let leaves = first + done == departure
                || (slots.may_leave && self.at(departure, slot).going(via) >= value);
            if !leaves {
                let Some((task, next)) = slots.tasks_at(node, done).find(does) else {
                    break;
                };
                (slot, done) = (task.ready[slot] as usize, next);
                continue;
            }
            let is_it = |arc: &SlottedArc| arc.tail as usize == node && arc.head == via;
            let arc = slots.arcs.iter().position(is_it);
            let Some(arc) = arc.filter(|_| via != slots.start) else {
                break;
            };
            let arrival = slots.arrival(arc, slot);
            if arrival == NEVER {
                break;
            }
            (before, node, slot, done) = (node as u32, via as usize, arrival as usize, 0);
            visits[node] += 1.0;
        }
        visits
    }

    /// What a partial route can still earn at most at its node and at the nodes `open`.
    pub(super) fn of(&self, label: &Label, done: usize, open: u128) -> f64 {
        let slots = &self.slots;
        let node = label.place.node as usize;
        let most = self.at(slots.row(node, done), slots.slot(label.ready_s));
        let is_open = |via: u32| via == END || via == slots.start || open >> via & 1 == 1;
        let more = if is_open(most.via) {
            most.value
        } else {
            most.other
        };
        let (mut sum, mut rest) = (more, open);
        while rest != 0 {
            sum += self.price[rest.trailing_zeros() as usize];
            rest &= rest - 1;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests may panic")]

    use super::*;
    use crate::{Budget, RouteProblem};
    use auv_graph::{
        Edge, Network, NodeId, Task, TaskName, TaskPlace, TimeModel, TimedTask, Waypoint,
    };
    use auv_types::{Point3, Seed};

    fn task(weight: f64) -> Task {
        Task {
            priority: weight,
            risk: 1.0,
            completion_time_s: 0.0,
        }
    }

    /// Five nodes on a line of 900 m, all joined, and a task at each of the inner three: the first opens late.
    fn problem() -> (Network, TimeModel) {
        let waypoint =
            |x: u32| Waypoint::at(Point3::new(f64::from(x * 225), f64::from(x % 2), 0.0));
        let waypoints: Vec<_> = (0..5).map(waypoint).collect();
        let pairs = (0..5).flat_map(|a| (a + 1..5).map(move |b| (a, b)));
        let edges: Vec<_> = pairs
            .map(|(a, b)| Edge::undirected(a, b, Task::TRANSIT))
            .collect();
        let at_node = |node: u32| TimedTask {
            name: TaskName::Text(format!("{node}")),
            place: TaskPlace::Node(NodeId(node)),
            task: task(f64::from(node)),
            windows: if node == 1 {
                vec![[400.0, 450.0]]
            } else {
                Vec::new()
            },
            after: Vec::new(),
            chain: None,
            mandatory: false,
        };
        let model = TimeModel {
            tasks: (1..4).map(at_node).collect(),
            ..TimeModel::default()
        };
        (Network::new(&waypoints, &edges, 2.0).unwrap(), model)
    }

    #[test]
    fn the_bound_is_no_less_than_the_best_route_and_close_to_it() {
        let (network, model) = problem();
        // The straight way takes 450 s; after the opening at 400 s it takes 338 s to the end.
        for (available_s, best) in [(451.0, 5.0), (850.0, 6.0)] {
            let mut problem = RouteProblem::new(&network, NodeId(0), NodeId(4), available_s);
            problem.time_model = Some(&model);
            let tables = TimedNetwork::new(&problem, &model);
            let mut run = Run::new(Seed(1), Budget::evaluations(1_000_000));
            let priced = Priced::new(&mut run, &tables, 0.0);
            let bound = priced.of_start();
            assert!(
                (best - 1e-9..=best + 0.1).contains(&bound),
                "{bound}, not {best}"
            );
        }
    }

    #[test]
    fn filling_again_changes_nothing() {
        let (network, model) = problem();
        let mut problem = RouteProblem::new(&network, NodeId(0), NodeId(4), 850.0);
        problem.time_model = Some(&model);
        let tables = TimedNetwork::new(&problem, &model);
        let mut priced = Priced::with(Slots::new(&tables, COARSE_STEPS), vec![0.25; 5]);
        priced.fill();
        let filled = priced.most.clone();
        priced.fill();
        assert_eq!(priced.most, filled);
    }
}
