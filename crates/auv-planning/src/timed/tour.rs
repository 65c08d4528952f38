//! A route in time with the earliest and the latest time of each step.

use super::rules::{Marks, keeps_rules};
use super::timed_network::{Step, TimedNetwork};
use crate::{Schedule, TaskDone};
use auv_graph::{NodeId, Route, RouteTotals, TIME_TOLERANCE_S};

/// Not on the tour.
const NOWHERE: u32 = u32::MAX;

/// A feasible route in time. Every change is taken back if it breaks a rule.
#[derive(Clone, Debug, Default)]
pub struct TimedTour {
    steps: Vec<Step>,
    /// When the work of each step is ready at the earliest.
    pub(super) ready_s: Vec<f64>,
    /// The latest arrival at each step for which the rest stays in time.
    pub(super) latest_s: Vec<f64>,
    /// Earliest permitted arrival at each step, for visits that must come later.
    hold_s: Vec<f64>,
    /// The first step at each node, or `NOWHERE`.
    first_at: Vec<u32>,
    /// The step of each task, or `NOWHERE`.
    step_of: Vec<u32>,
    weight: f64,
    spare: Vec<Step>,
    marks: Marks,
}

impl TimedTour {
    /// A tour of these steps if it is feasible.
    #[must_use]
    pub fn new(tables: &TimedNetwork<'_>, steps: Vec<Step>) -> Option<Self> {
        let mut tour = Self {
            steps,
            first_at: vec![NOWHERE; tables.nodes()],
            step_of: vec![NOWHERE; tables.works.len()],
            ..Self::default()
        };
        tour.index();
        tour.refresh(tables).then_some(tour)
    }

    /// The steps.
    #[must_use]
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// The weight, the edges' own tasks included. Mandatory tasks count as they are.
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.weight
    }

    /// When it ends, in seconds.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.ready_s.last().copied().unwrap_or(0.0)
    }

    /// When the work of each step is ready at the earliest, in seconds.
    #[must_use]
    pub fn ready_s(&self) -> &[f64] {
        &self.ready_s
    }

    /// Whether a task is done.
    #[must_use]
    pub fn does(&self, task: u32) -> bool {
        self.step_of[task as usize] != NOWHERE
    }

    /// The index of the step that does a task.
    #[must_use]
    pub fn step_of(&self, task: u32) -> Option<usize> {
        let at = self.step_of[task as usize];
        (at != NOWHERE).then_some(at as usize)
    }

    /// Whether a node is on the tour.
    #[must_use]
    pub fn visits(&self, node: u32) -> bool {
        self.first_at[node as usize] != NOWHERE
    }

    /// Replaces the steps `from..to` by others if the tour stays feasible; else nothing changes.
    pub fn splice(
        &mut self,
        tables: &TimedNetwork<'_>,
        (from, to): (usize, usize),
        steps: &[Step],
    ) -> bool {
        let mut spare = std::mem::take(&mut self.spare);
        spare.clear();
        spare.extend_from_slice(&self.steps[..from]);
        spare.extend_from_slice(steps);
        spare.extend_from_slice(&self.steps[to..]);
        self.unindex();
        std::mem::swap(&mut self.steps, &mut spare);
        self.index();
        let holds = self.refresh(tables);
        if !holds {
            self.unindex();
            std::mem::swap(&mut self.steps, &mut spare);
            self.index();
            self.refresh(tables);
        }
        self.spare = spare;
        holds
    }

    /// Becomes a copy of another tour of the same problem.
    pub fn copy_from(&mut self, other: &Self) {
        self.unindex();
        self.steps.clone_from(&other.steps);
        self.ready_s.clone_from(&other.ready_s);
        self.latest_s.clone_from(&other.latest_s);
        self.hold_s.clone_from(&other.hold_s);
        self.weight = other.weight;
        self.index();
    }

    fn unindex(&mut self) {
        for step in &self.steps {
            self.first_at[step.node as usize] = NOWHERE;
            if step.works() {
                self.step_of[step.task as usize] = NOWHERE;
            }
        }
    }

    fn index(&mut self) {
        for (i, step) in self.steps.iter().enumerate().rev() {
            self.first_at[step.node as usize] = i as u32;
            if step.works() {
                self.step_of[step.task as usize] = i as u32;
            }
        }
    }

    /// Computes the times again; whether the tour is feasible.
    fn refresh(&mut self, tables: &TimedNetwork<'_>) -> bool {
        let count = self.steps.len();
        self.hold_s.clear();
        self.hold_s.resize(count, f64::NEG_INFINITY);
        if tables.has_rules && !keeps_rules(tables, &self.steps, &mut self.marks) {
            return false;
        }
        // Each pass delays a visit that would come too early for the next one.
        for _ in 0..=4 * count {
            if !self.forward(tables) {
                return false;
            }
            match self.delay_visits(tables) {
                None => return false,
                Some(true) => {}
                Some(false) => {
                    self.backward(tables);
                    self.weight = self.weigh(tables);
                    return true;
                }
            }
        }
        false
    }

    fn forward(&mut self, tables: &TimedNetwork<'_>) -> bool {
        self.ready_s.clear();
        let (mut at, mut ready_s) = (self.steps[0].node, 0.0);
        for (i, step) in self.steps.iter().enumerate() {
            let again = step.node != at && i >= 2 && self.passes_again(tables, i);
            let mut arrival_s = tables.arrival_s(at, step.node, ready_s);
            if again {
                arrival_s -= tables.own_s(at, step.node);
            }
            ready_s = tables.ready_s(step.task, arrival_s.max(self.hold_s[i]));
            at = step.node;
            self.ready_s.push(ready_s);
        }
        ready_s <= tables.problem.time_available_s + TIME_TOLERANCE_S
    }

    /// Whether the leg to step `i` passes the edge of the leg before: start, node, start.
    fn passes_again(&self, tables: &TimedNetwork<'_>, i: usize) -> bool {
        let to = self.steps[i].node;
        to == self.steps[0].node && {
            let at = self.steps[i - 1].node;
            let before = self.steps[..i].iter().rev().find(|step| step.node != at);
            before.is_some_and(|step| step.node == to) && tables.leads_back(to, at)
        }
    }

    fn backward(&mut self, tables: &TimedNetwork<'_>) {
        let count = self.steps.len();
        self.latest_s.resize(count, 0.0);
        let mut ready_s = tables.problem.time_available_s;
        for i in (0..count).rev() {
            let step = self.steps[i];
            self.latest_s[i] = tables.latest_arrival_s(step.task, ready_s);
            if i > 0 {
                let from = self.steps[i - 1].node;
                ready_s = tables.latest_departure_s(from, step.node, self.latest_s[i]);
            }
        }
    }

    /// Makes visits later that come too early for the next one. Whether any changed; `None` if they
    /// cannot all be kept.
    fn delay_visits(&mut self, tables: &TimedNetwork<'_>) -> Option<bool> {
        let Some(visits) = &tables.model.visits else {
            return Some(false);
        };
        let most_s = visits.every_s + TIME_TOLERANCE_S;
        let mut next_s = self.end_s();
        let mut changed = false;
        for i in (0..self.steps.len()).rev() {
            let Some(visit_s) = self.visit_s(tables, i) else {
                continue;
            };
            if next_s - visit_s > most_s {
                if i == 0 || !tables.model.may_wait {
                    return None;
                }
                let arrival_s = tables.arrival_s(
                    self.steps[i - 1].node,
                    self.steps[i].node,
                    self.ready_s[i - 1],
                );
                let late_s = next_s - visits.every_s - visit_s;
                self.hold_s[i] = arrival_s.max(self.hold_s[i]) + late_s;
                changed = true;
            }
            next_s = visit_s;
        }
        (next_s <= most_s).then_some(changed)
    }

    /// When the place of step `i` is met, if the step begins a visit to a place to be met again: after
    /// the tasks of the edge that leads there.
    fn visit_s(&self, tables: &TimedNetwork<'_>, i: usize) -> Option<f64> {
        let step = self.steps[i];
        if !tables.is_visit(step.node) || (i > 0 && self.steps[i - 1].node == step.node) {
            return None;
        }
        if i == 0 {
            return Some(0.0);
        }
        let on_edge = |s: &&Step| {
            s.node == step.node && s.works() && tables.works[s.task as usize].is_on_edge
        };
        let edge_steps = self.steps[i..].iter().take_while(on_edge).count();
        if edge_steps > 0 {
            return Some(self.ready_s[i + edge_steps - 1]);
        }
        let from = self.steps[i - 1].node;
        let arrival_s = tables.arrival_s(from, step.node, self.ready_s[i - 1]);
        Some(arrival_s.max(self.hold_s[i]))
    }

    fn weigh(&self, tables: &TimedNetwork<'_>) -> f64 {
        let works = self.steps.iter().filter(|step| step.works());
        let tasks: f64 = works
            .map(|step| tables.works[step.task as usize].weight)
            .sum();
        if !tables.has_own_weights {
            return tasks;
        }
        let mut own = 0.0;
        for i in 1..self.steps.len() {
            let (from, to) = (self.steps[i - 1].node, self.steps[i].node);
            if from != to && !(i >= 2 && self.passes_again(tables, i)) {
                own += tables.own_weight(from, to);
            }
        }
        tasks + own
    }

    /// The route with its times and totals.
    #[must_use]
    pub fn answer(&self, tables: &TimedNetwork<'_>) -> (Route, Schedule, RouteTotals) {
        let network = tables.problem.network;
        let (mut nodes, mut schedule) = (Vec::new(), Schedule::default());
        let mut totals = RouteTotals::default();
        let mut passed = Vec::new();
        let (mut at, mut ready_s) = (NOWHERE, 0.0);
        for (i, step) in self.steps.iter().enumerate() {
            let mut arrival_s = ready_s;
            if at != step.node {
                if at != NOWHERE {
                    arrival_s = tables.arrival_s(at, step.node, ready_s).max(self.hold_s[i]);
                    let held_s = tables.latest_departure_s(at, step.node, arrival_s);
                    let is_held = self.hold_s[i] > f64::NEG_INFINITY;
                    schedule.departures_s.push(if is_held {
                        held_s.max(ready_s)
                    } else {
                        ready_s
                    });
                    if let Some(arc) = network.arc_between(NodeId(at), NodeId(step.node)) {
                        let arc = &network.arcs()[arc.index()];
                        if passed.contains(&arc.edge) {
                            totals.distance_m += arc.distance_m;
                            arrival_s -= tables.own_s(at, step.node);
                        } else {
                            passed.push(arc.edge);
                            totals.add(arc, network.task(arc.edge), 0.0);
                        }
                    }
                }
                nodes.push(NodeId(step.node));
                at = step.node;
            }
            if step.works() {
                let task = step.task as usize;
                let start_s = tables.start_s(step.task, arrival_s);
                schedule.done.push(TaskDone { task, start_s });
                let known = tables.model.tasks[task].task;
                totals.weight += known.weight();
                totals.tasks += 1;
                totals.priority += known.priority;
                totals.risk += known.risk;
                if known.priority > 0.0 {
                    totals.risk_per_priority += known.risk / known.priority;
                }
            }
            ready_s = self.ready_s[i];
        }
        schedule.end_s = self.end_s();
        totals.time_s = schedule.end_s;
        (Route::new(nodes), schedule, totals)
    }

    /// Mandatory tasks that it does not do.
    #[must_use]
    pub fn missing(&self, tables: &TimedNetwork<'_>) -> usize {
        let mandatory =
            |(i, work): &(usize, &super::TimedWork)| work.is_mandatory && !self.does(*i as u32);
        tables.works.iter().enumerate().filter(mandatory).count()
    }
}
