//! The steps that may follow a partial route.

use super::label::{Label, Place, Running, Stage};
use crate::timed::timed_network::{Step, TimedNetwork};
use std::collections::BTreeMap;

/// Most tasks that later rules ask for, and most tasks at a node and on one edge.
const MOST_KNOWN: usize = 64;
const MOST_HERE: usize = 32;

/// The tasks of a problem by place.
#[derive(Debug)]
pub(super) struct Extension<'a> {
    pub(super) tables: &'a TimedNetwork<'a>,
    /// By task: its bit among those that later rules ask for; 0 for the others.
    known: Vec<u64>,
    /// By task: the bits of those that it comes after.
    after: Vec<u64>,
    /// The bits of the mandatory tasks.
    mandatory: u64,
    /// By chain: its tasks in the order listed, and their bits.
    chains: Vec<(Vec<usize>, u64)>,
    /// Tasks of each edge, by the nodes that it leads from and to.
    on_edge: BTreeMap<[u32; 2], Vec<u32>>,
    is_round: bool,
}

impl<'a> Extension<'a> {
    /// `None` if there are too many tasks at one place or with rules.
    pub(super) fn new(tables: &'a TimedNetwork<'a>) -> Option<Self> {
        let tasks = &tables.model.tasks;
        let start = tables.problem.start.0;
        let is_round = tables.destinations.contains(&start);
        let mut is_asked = vec![false; tasks.len()];
        for (i, task) in tasks.iter().enumerate() {
            let at_start = is_round && tables.works[i].ends.contains(&start);
            is_asked[i] |= task.mandatory || task.chain.is_some() || at_start;
            for &before in &task.after {
                is_asked[before] = true;
            }
        }
        let asked: Vec<_> = (0..tasks.len()).filter(|&task| is_asked[task]).collect();
        if asked.len() > MOST_KNOWN {
            return None;
        }
        let mut known = vec![0; tasks.len()];
        for (bit, &task) in asked.iter().enumerate() {
            known[task] = 1 << bit;
        }
        let bits = |list: &[usize]| list.iter().fold(0, |bits, &task| bits | known[task]);
        let mut on_edge: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for (i, work) in tables
            .works
            .iter()
            .enumerate()
            .filter(|(_, work)| work.is_on_edge)
        {
            let [a, b] = work.ends;
            for [from, to] in [[a, b], [b, a]] {
                if work.is_along(from, to) {
                    on_edge.entry([from, to]).or_default().push(i as u32);
                }
            }
        }
        let most = |lists: usize| lists <= MOST_HERE / 2;
        if !tables.at_node.iter().all(|list| most(list.len()))
            || !on_edge.values().all(|list| most(list.len()))
        {
            return None;
        }
        let mandatory: Vec<_> = (0..tasks.len())
            .filter(|&task| tasks[task].mandatory)
            .collect();
        let chain = |chain| {
            let list: Vec<usize> = tables.model.chain_tasks(chain).collect();
            let bits = bits(&list);
            (list, bits)
        };
        Some(Self {
            after: tasks.iter().map(|task| bits(&task.after)).collect(),
            mandatory: bits(&mandatory),
            chains: (0..tables.model.chains.len()).map(chain).collect(),
            known,
            on_edge,
            is_round,
            tables,
        })
    }

    /// The partial route that begins at the start.
    pub(super) fn root(&self) -> Label {
        let node = self.tables.problem.start.0;
        let visits = self.tables.model.visits.as_ref();
        Label {
            ready_s: 0.0,
            weight: 0.0,
            since_s: 0.0,
            due_s: visits.map_or(f64::INFINITY, |visits| visits.every_s),
            visited: 1 << node,
            shut: 0,
            most: f64::INFINITY,
            earns_less_back: false,
            step: Step::pass(node),
            parent: u32::MAX,
            place: Place {
                node,
                known: 0,
                here: 0,
                edge: None,
                stage: Stage::Node,
                chain: None,
                has_worked: false,
                is_closed: false,
            },
            rivals: u32::MAX,
        }
    }

    /// Whether a route may end with this step.
    pub(super) fn ends(&self, label: &Label) -> bool {
        let place = &label.place;
        let is_there = self.tables.destinations.contains(&place.node);
        let is_open = place.chain.is_some_and(|chain| self.must_go_on(chain));
        is_there
            && !is_open
            && place.known & self.mandatory == self.mandatory
            && self.may_leave(label)
    }

    /// Whether the route may come back to the start.
    pub(super) fn closes(&self, label: &Label) -> bool {
        self.is_round && !label.place.is_closed
    }

    /// The tasks at its node that are done, by their place in the list.
    pub(super) fn done(&self, place: &Place) -> usize {
        (place.here >> (MOST_HERE / 2)) as usize
    }

    /// Weight of the tasks on the edge that leads to a place.
    pub(super) fn edge_weight(&self, place: &Place) -> f64 {
        let tasks = place
            .edge
            .and_then(|from| self.on_edge.get(&[from, place.node]));
        let tasks = tasks.into_iter().flatten();
        tasks.fold(0.0, |sum, &task| {
            sum + self.tables.works[task as usize].weight
        })
    }

    /// Whether nothing keeps the route at its node.
    fn may_leave(&self, label: &Label) -> bool {
        let node_tasks = self.tables.at_node[label.place.node as usize].len();
        let done = (label.place.here >> (MOST_HERE / 2)).count_ones() as usize;
        !self.tables.passing_works() || done == node_tasks
    }

    fn must_go_on(&self, running: Running) -> bool {
        !self.tables.model.chains[running.chain].may_split
    }

    /// All partial routes of one step more. `is_out_and_back`: whether the route has gone from the start to this
    /// node and nowhere else.
    pub(super) fn of(
        &self,
        label: &Label,
        id: u32,
        is_out_and_back: impl Fn(u32) -> bool,
    ) -> Vec<Label> {
        let mut found = Vec::new();
        let place = &label.place;
        if place.stage == Stage::Edge {
            let edge_tasks = place
                .edge
                .and_then(|from| self.on_edge.get(&[from, place.node]));
            for (i, &task) in edge_tasks.into_iter().flatten().enumerate() {
                found.extend(self.with_task(label, id, (task, 1 << i), Stage::Edge));
            }
        }
        for (i, &task) in self.tables.at_node[place.node as usize].iter().enumerate() {
            let bit = 1 << (i + MOST_HERE / 2);
            found.extend(self.with_task(label, id, (task, bit), Stage::Node));
        }
        if place.is_closed || !self.may_leave(label) {
            return found;
        }
        let network = self.tables.problem.network;
        for arc in network.range_from(auv_graph::NodeId(place.node)) {
            let head = network.heads()[arc].0;
            let is_new = label.visited >> head & 1 == 0;
            let closes = self.is_round && head == self.tables.problem.start.0;
            if (is_new || closes) && self.tables.connects(place.node, head) {
                let is_again = closes
                    && is_out_and_back(place.node)
                    && self.tables.leads_back(head, place.node);
                found.extend(self.at_head(label, id, head, (closes, is_again)));
            }
        }
        found
    }

    fn at_head(
        &self,
        label: &Label,
        id: u32,
        head: u32,
        (closes, is_again): (bool, bool),
    ) -> Option<Label> {
        let (tables, tail) = (self.tables, label.place.node);
        let mut ready_s = tables.arrival_s(tail, head, label.ready_s);
        let mut own = tables.own_weight(tail, head);
        let mut least_s = tables.least_s(tail, head);
        if is_again {
            // The edge is passed back: its own task is done.
            ready_s -= tables.own_s(tail, head);
            least_s -= tables.own_s(tail, head);
            own = 0.0;
        }
        let [since_s, due_s] =
            self.visits_s(head, ready_s, [label.since_s + least_s, label.due_s])?;
        let has_tasks = self.on_edge.contains_key(&[tail, head]);
        // Tasks of an edge that is passed back count as done on the way out, unless one at its end came between.
        let on_way_out = is_again && label.place.stage == Stage::Edge;
        (ready_s < f64::INFINITY).then(|| Label {
            ready_s,
            weight: label.weight + own,
            since_s,
            due_s,
            visited: label.visited | 1 << head,
            shut: 0,
            most: f64::INFINITY,
            earns_less_back: false,
            step: Step::pass(head),
            parent: id,
            place: Place {
                node: head,
                here: 0,
                edge: has_tasks.then_some(tail),
                stage: if on_way_out || !has_tasks {
                    Stage::Node
                } else {
                    Stage::Edge
                },
                is_closed: closes,
                ..label.place
            },
            rivals: u32::MAX,
        })
    }

    /// The time since a place to be met again and the latest time for the next, after the arrival at a node; `None`
    /// if it is too late.
    fn visits_s(&self, node: u32, arrival_s: f64, [since_s, due_s]: [f64; 2]) -> Option<[f64; 2]> {
        let model = self.tables.model;
        let Some(visits) = &model.visits else {
            return Some([0.0, f64::INFINITY]);
        };
        let late_s = auv_graph::TIME_TOLERANCE_S;
        if since_s > visits.every_s + late_s || arrival_s > due_s + late_s {
            return None;
        }
        let is_met = self.tables.is_visit(node);
        // With waiting it may be met as late as it is due.
        let met_s = if model.may_wait { due_s } else { arrival_s };
        Some(if is_met {
            [0.0, met_s + visits.every_s]
        } else {
            [since_s, due_s]
        })
    }

    /// Whether a task is done before its place counts as met: those of the edge that leads there are.
    fn is_before_visit(&self, place: &Place, stage: Stage) -> bool {
        stage == Stage::Edge && self.tables.is_visit(place.node)
    }

    fn with_task(
        &self,
        label: &Label,
        id: u32,
        (task, here): (u32, u32),
        stage: Stage,
    ) -> Option<Label> {
        let (i, place) = (task as usize, &label.place);
        let is_at_start = stage == Stage::Node && place.node == self.tables.problem.start.0;
        let is_done = place.here & here != 0 || place.known & self.known[i] != 0;
        let is_early = self.after[i] & !place.known != 0;
        // At the start again, it would count as done when the route began.
        let counts_before = place.is_closed && is_at_start && !place.has_worked;
        if is_done || is_early || counts_before {
            return None;
        }
        let chain = self.chain_after(place, i)?;
        let ready_s = self.tables.ready_s(task, label.ready_s);
        let delta_s = self.tables.works[i].delta_s;
        let [before_s, after_s] = match &self.tables.model.visits {
            None => [0.0, 0.0],
            Some(_) if self.is_before_visit(place, stage) => [delta_s, 0.0],
            Some(_) => [0.0, delta_s],
        };
        (ready_s < f64::INFINITY).then(|| Label {
            ready_s,
            weight: label.weight + self.tables.works[i].weight,
            since_s: label.since_s + after_s,
            due_s: label.due_s + before_s,
            step: Step {
                node: place.node,
                task,
            },
            parent: id,
            place: Place {
                known: place.known | self.known[i],
                here: place.here | here,
                stage,
                chain,
                has_worked: place.has_worked || !is_at_start,
                ..*place
            },
            ..label.clone()
        })
    }

    /// The chain being done after a task; `None` if it may not follow.
    fn chain_after(&self, place: &Place, task: usize) -> Option<Option<Running>> {
        let of_task = self.tables.model.tasks[task].chain;
        if let Some(running) = place.chain {
            let (list, _) = &self.chains[running.chain];
            let next = |forwards: bool| {
                let at = if forwards {
                    Some(running.at + 1)
                } else {
                    running.at.checked_sub(1)
                };
                at.filter(|&at| list.get(at) == Some(&task))
                    .map(|at| (at, forwards))
            };
            let goes = match running.forwards {
                Some(forwards) => next(forwards),
                None => next(true).or_else(|| next(false)),
            };
            if let Some((at, forwards)) = goes {
                let is_over = if forwards {
                    at + 1 == list.len()
                } else {
                    at == 0
                };
                let running = Running {
                    at,
                    forwards: Some(forwards),
                    ..running
                };
                return Some((!is_over).then_some(running));
            }
            if self.must_go_on(running) {
                return None;
            }
        }
        let Some(chain) = of_task else {
            return Some(None);
        };
        let (list, bits) = &self.chains[chain];
        let at = list.iter().position(|&other| other == task)?;
        let is_end = at == 0 || at + 1 == list.len();
        if place.known & bits != 0 || !(is_end || self.tables.model.chains[chain].may_split) {
            return None;
        }
        let forwards = match () {
            () if self.tables.model.chains[chain].may_split => None,
            () => Some(at == 0),
        };
        let running = Running {
            chain,
            at,
            forwards,
        };
        Some((list.len() > 1).then_some(running))
    }
}
