//! A route problem in time, in tables for quick lookup.

use crate::RouteProblem;
use auv_graph::{
    ArcId, NetworkArc, NodeId, Passing, Profile, TIME_TOLERANCE_S, TaskPlace, TimeModel,
};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::OnceLock;

/// No task: the step only passes its node.
pub const NO_TASK: u32 = u32::MAX;

/// A step of a route in time: a node, and at most one task done there or on the edge that leads there.
/// Steps at one node that follow each other are one visit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Step {
    /// The node.
    pub node: u32,
    /// The index of the task, or [`NO_TASK`].
    pub task: u32,
}

impl Step {
    /// A step that passes a node.
    #[must_use]
    pub const fn pass(node: u32) -> Self {
        Self {
            node,
            task: NO_TASK,
        }
    }

    /// Whether it does a task.
    #[must_use]
    pub const fn works(&self) -> bool {
        self.task != NO_TASK
    }
}

/// What the search needs of a task.
#[derive(Clone, Copy, Debug)]
pub struct TimedWork {
    /// Its weight.
    pub weight: f64,
    /// Its completion time in seconds.
    pub delta_s: f64,
    /// From when to when it may begin, if there is one window only; else the whole of time.
    pub window: [f64; 2],
    /// Whether it has several windows.
    pub has_more_windows: bool,
    /// The ends of its edge; of a node task the node twice.
    pub ends: [u32; 2],
    /// Whether it is done on an edge.
    pub is_on_edge: bool,
    /// Whether its edge is passed from the first end to the second only.
    pub is_one_way: bool,
    /// Whether it is mandatory.
    pub is_mandatory: bool,
}

impl TimedWork {
    /// Whether it is on the edge that leads from one node to another.
    #[must_use]
    pub fn is_along(&self, from: u32, to: u32) -> bool {
        let [a, b] = self.ends;
        self.is_on_edge && ((from, to) == (a, b) || (!self.is_one_way && (from, to) == (b, a)))
    }
}

/// The usable arcs and the tasks of a problem in time. Lookup by pair is O(1) up to
/// [`TimedNetwork::DENSE_NODES`] nodes.
#[derive(Debug)]
pub struct TimedNetwork<'a> {
    /// The problem.
    pub problem: &'a RouteProblem<'a>,
    /// Its model.
    pub model: &'a TimeModel,
    /// Where the route may end.
    pub destinations: Vec<u32>,
    /// The tasks.
    pub works: Vec<TimedWork>,
    /// Tasks at each node.
    pub at_node: Vec<Vec<u32>>,
    /// Whether an edge's own task has a weight.
    pub has_own_weights: bool,
    /// Whether there are several destinations, or more than at most one task with one window at each node
    /// between the ends.
    pub has_rules: bool,
    /// Whether a task is mandatory.
    pub has_mandatory: bool,
    nodes: usize,
    /// Time in seconds by `tail * nodes + head`, infinite where there is no usable arc.
    dense_s: Vec<f64>,
    /// The least time at any departure by the same pairs; none where no arc has a profile.
    dense_least_s: Vec<f64>,
    has_profiles: bool,
    /// The arc by the same pairs, `u32::MAX` where there is none.
    dense_arc: Vec<u32>,
    /// The profile of each arc; none at all where no arc has one.
    profiles: Vec<Option<Profile<'a>>>,
    is_visited_again: Vec<bool>,
    /// By pair of nodes, computed when first asked for.
    least_ways_s: OnceLock<Vec<f64>>,
}

impl<'a> TimedNetwork<'a> {
    /// Largest network for which a table of all pairs is kept (8 bytes a pair).
    pub const DENSE_NODES: usize = 2_000;

    /// The tables of a valid problem.
    #[must_use]
    pub fn new(problem: &'a RouteProblem<'a>, model: &'a TimeModel) -> Self {
        let network = problem.network;
        let nodes = network.num_nodes();
        let mut at_node = vec![Vec::new(); nodes];
        let works: Vec<_> = (0..model.tasks.len())
            .map(|i| work(problem, model, i))
            .collect();
        for (i, work) in works.iter().enumerate() {
            if !work.is_on_edge {
                at_node[work.ends[0] as usize].push(i as u32);
            }
        }
        let destinations = match &model.destinations[..] {
            [] => vec![problem.destination.0],
            given => given.iter().map(|node| node.0).collect(),
        };
        let mut is_visited_again = vec![false; nodes];
        for node in model.visits.iter().flat_map(|visits| &visits.nodes) {
            is_visited_again[node.index()] = true;
        }
        let is_ordered = model
            .tasks
            .iter()
            .any(|t| !t.after.is_empty() || t.chain.is_some());
        let has_own_weights = network.weights().iter().any(|&weight| weight > 0.0);
        let is_closed = destinations.contains(&problem.start.0);
        let mut tables = Self {
            problem,
            model,
            has_own_weights,
            has_rules: is_closed
                || destinations.len() > 1
                || has_own_weights
                || model.visits.is_some()
                || !model.may_wait
                || !model.profiles.is_empty()
                || is_ordered
                || (0..nodes as u32).any(|node| {
                    let most =
                        usize::from(node != problem.start.0 && !destinations.contains(&node));
                    at_node[node as usize].len() > most
                })
                || works.iter().any(|w| w.has_more_windows || w.is_on_edge),
            destinations,
            at_node,
            has_mandatory: works.iter().any(|work| work.is_mandatory),
            works,
            nodes,
            dense_s: Vec::new(),
            dense_least_s: Vec::new(),
            has_profiles: !model.profiles.is_empty(),
            dense_arc: Vec::new(),
            profiles: Vec::new(),
            is_visited_again,
            least_ways_s: OnceLock::new(),
        };
        tables.fill();
        tables
    }

    /// Fills the tables of pairs and the profiles.
    fn fill(&mut self) {
        let (network, nodes) = (self.problem.network, self.nodes);
        let pair = |arc: &NetworkArc| arc.tail.index() * nodes + arc.head.index();
        if nodes <= Self::DENSE_NODES {
            self.dense_s = vec![f64::INFINITY; nodes * nodes];
            for (i, arc) in network.arcs().iter().enumerate() {
                self.dense_s[pair(arc)] = self.arc_s(ArcId(i as u32));
            }
            if self.has_profiles || self.has_own_weights {
                self.dense_arc = vec![u32::MAX; nodes * nodes];
                for (i, arc) in network.arcs().iter().enumerate() {
                    self.dense_arc[pair(arc)] = i as u32;
                }
            }
        }
        if self.has_profiles {
            let arcs = 0..network.arcs().len() as u32;
            let profile = |arc| self.model.profiles.of(ArcId(arc));
            self.profiles = arcs.map(profile).collect();
            if nodes <= Self::DENSE_NODES {
                let pairs = (0..nodes * nodes).map(|pair| [pair / nodes, pair % nodes]);
                let least_s =
                    |[from, to]: [usize; 2]| self.searched_least_s(from as u32, to as u32);
                self.dense_least_s = pairs.map(least_s).collect();
            }
        }
    }

    /// Time of an arc without profile in seconds, its edge's task included; infinite if not usable.
    fn arc_s(&self, arc: ArcId) -> f64 {
        let problem = self.problem;
        let edge = problem.network.arcs()[arc.index()].edge;
        if problem.removed.contains(edge) {
            f64::INFINITY
        } else {
            problem.network.arc_time_s(arc, problem.times)
        }
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Whether a node is one of those to be met again and again.
    #[must_use]
    pub fn is_visit(&self, node: u32) -> bool {
        self.is_visited_again[node as usize]
    }

    /// Whether passing a node does its tasks.
    #[must_use]
    pub fn passing_works(&self) -> bool {
        self.model.passing == Passing::DoesTasks
    }

    /// Whether a task has a window that opens after the start: there one may arrive too early.
    #[must_use]
    pub fn opens_late(&self) -> bool {
        let opens_late =
            |work: &TimedWork| work.has_more_windows || work.window[0] > TIME_TOLERANCE_S;
        self.works.iter().any(opens_late)
    }

    /// Whether travel times depend on the departure.
    #[must_use]
    pub fn has_profiles(&self) -> bool {
        self.has_profiles
    }

    /// Arrival after a departure in seconds, the task of the edge included; infinite if there is no arc.
    #[inline]
    #[must_use]
    pub fn arrival_s(&self, from: u32, to: u32, departure_s: f64) -> f64 {
        if from == to {
            return departure_s;
        }
        let plain_s = self.plain_s(from, to);
        if !self.has_profiles || plain_s == f64::INFINITY {
            return departure_s + plain_s;
        }
        match self.profile(from, to) {
            Some((profile, own_s)) => departure_s + profile.travel_s(departure_s) + own_s,
            None => departure_s + plain_s,
        }
    }

    /// The latest departure for an arrival in seconds, the inverse of [`TimedNetwork::arrival_s`].
    #[inline]
    #[must_use]
    pub fn latest_departure_s(&self, from: u32, to: u32, arrival_s: f64) -> f64 {
        if from == to {
            return arrival_s;
        }
        let plain_s = self.plain_s(from, to);
        if !self.has_profiles || plain_s == f64::INFINITY {
            return arrival_s - plain_s;
        }
        match self.profile(from, to) {
            Some((profile, own_s)) => profile.latest_departure_s(arrival_s - own_s),
            None => arrival_s - plain_s,
        }
    }

    /// Least time from one node to the next at any departure, in seconds.
    #[must_use]
    #[inline]
    pub fn least_s(&self, from: u32, to: u32) -> f64 {
        match self
            .dense_least_s
            .get(from as usize * self.nodes + to as usize)
        {
            Some(&least_s) => least_s,
            None => self.searched_least_s(from, to),
        }
    }

    fn searched_least_s(&self, from: u32, to: u32) -> f64 {
        let plain_s = self.plain_s(from, to);
        if plain_s == f64::INFINITY {
            return plain_s;
        }
        match self.profile(from, to) {
            Some((profile, own_s)) => profile.least_s() + own_s,
            None => plain_s,
        }
    }

    /// Least time of any way from one node to another, at any departures, without the work on edges, in seconds;
    /// infinite where there is none.
    #[must_use]
    pub fn least_way_s(&self, from: u32, to: u32) -> f64 {
        let all = self.least_ways_s.get_or_init(|| {
            let from_each = (0..self.nodes).flat_map(|from| least_times_s(self, from));
            from_each.collect()
        });
        all[from as usize * self.nodes + to as usize]
    }

    #[inline]
    fn plain_s(&self, from: u32, to: u32) -> f64 {
        if let Some(&time_s) = self.dense_s.get(from as usize * self.nodes + to as usize) {
            return time_s;
        }
        let arc = self.problem.network.arc_between(NodeId(from), NodeId(to));
        arc.map_or(f64::INFINITY, |arc| self.arc_s(arc))
    }

    /// The arc between two nodes, usable or not.
    #[inline]
    fn arc(&self, from: u32, to: u32) -> Option<ArcId> {
        let pair = from as usize * self.nodes + to as usize;
        match self.dense_arc.get(pair) {
            Some(&arc) => (arc != u32::MAX).then_some(ArcId(arc)),
            None => self.problem.network.arc_between(NodeId(from), NodeId(to)),
        }
    }

    /// The profile of an arc, and the completion time of its edge's own task.
    #[inline]
    fn profile(&self, from: u32, to: u32) -> Option<(Profile<'a>, f64)> {
        let arc = self.arc(from, to)?;
        let network = self.problem.network;
        let own = network.task(network.arcs()[arc.index()].edge);
        let profile = (*self.profiles.get(arc.index())?)?;
        Some((profile, own.completion_time_s))
    }

    /// Completion time of the task that the edge between two nodes has of its own, in seconds.
    #[must_use]
    pub fn own_s(&self, from: u32, to: u32) -> f64 {
        let network = self.problem.network;
        let task = |arc: ArcId| network.task(network.arcs()[arc.index()].edge);
        let arc = self.arc(from, to);
        arc.map_or(0.0, |arc| task(arc).completion_time_s)
    }

    /// Whether one edge leads from a node to another and back.
    #[must_use]
    pub fn leads_back(&self, from: u32, to: u32) -> bool {
        let network = self.problem.network;
        let edge = |tail: u32, head: u32| {
            let arc = self.arc(tail, head)?;
            Some(network.arcs()[arc.index()].edge)
        };
        edge(from, to).is_some_and(|there| edge(to, from) == Some(there))
    }

    /// Whether there is a usable arc.
    #[inline]
    #[must_use]
    pub fn connects(&self, from: u32, to: u32) -> bool {
        self.plain_s(from, to) < f64::INFINITY
    }

    /// The own weight of the edge between two nodes; 0 where there is none.
    #[must_use]
    pub fn own_weight(&self, from: u32, to: u32) -> f64 {
        let arc = self.arc(from, to);
        arc.map_or(0.0, |arc| self.problem.network.weights()[arc.index()])
    }

    /// When the work of a step is ready after an arrival; infinite if it cannot begin.
    #[inline]
    #[must_use]
    pub fn ready_s(&self, task: u32, arrival_s: f64) -> f64 {
        if task == NO_TASK {
            return arrival_s;
        }
        let work = &self.works[task as usize];
        self.start_s(task, arrival_s) + work.delta_s
    }

    /// When steps are ready one after the other, after leaving a node at a time in seconds; infinite if one of
    /// them cannot be done then.
    #[inline]
    #[must_use]
    pub fn ready_along_s(&self, steps: &[Step], from: u32, leave_s: f64) -> f64 {
        let (mut at, mut ready_s) = (from, leave_s);
        for step in steps {
            ready_s = self.ready_s(step.task, self.arrival_s(at, step.node, ready_s));
            at = step.node;
        }
        ready_s
    }

    /// When a task begins after an arrival; infinite if it cannot.
    #[inline]
    #[must_use]
    pub fn start_s(&self, task: u32, arrival_s: f64) -> f64 {
        let work = &self.works[task as usize];
        if work.has_more_windows || !self.model.may_wait {
            let task = &self.model.tasks[task as usize];
            let start_s = task.earliest_start_s(arrival_s).unwrap_or(f64::INFINITY);
            let waits = start_s > arrival_s + TIME_TOLERANCE_S;
            return if waits && !self.model.may_wait {
                f64::INFINITY
            } else {
                start_s
            };
        }
        if arrival_s > work.window[1] + TIME_TOLERANCE_S {
            return f64::INFINITY;
        }
        arrival_s.max(work.window[0])
    }

    /// The latest arrival at a step so that its work is ready by `ready_s`; minus infinity if there is
    /// none.
    #[inline]
    #[must_use]
    pub fn latest_arrival_s(&self, task: u32, ready_s: f64) -> f64 {
        if task == NO_TASK {
            return ready_s;
        }
        let work = &self.works[task as usize];
        let start_s = ready_s - work.delta_s;
        if work.has_more_windows {
            let task = &self.model.tasks[task as usize];
            return task.latest_start_s(start_s).unwrap_or(f64::NEG_INFINITY);
        }
        if start_s < work.window[0] - TIME_TOLERANCE_S {
            return f64::NEG_INFINITY;
        }
        start_s.min(work.window[1])
    }
}

fn work(problem: &RouteProblem<'_>, model: &TimeModel, i: usize) -> TimedWork {
    let task = &model.tasks[i];
    let (ends, edge) = match task.place {
        TaskPlace::Node(node) => ([node.0; 2], None),
        TaskPlace::Edge(edge) => {
            let edge = &problem.network.edges()[edge.index()];
            ([edge.from, edge.to], Some(edge))
        }
    };
    let window = match task.windows[..] {
        [window] => window,
        _ => [f64::NEG_INFINITY, f64::INFINITY],
    };
    TimedWork {
        weight: task.task.weight(),
        delta_s: task.task.completion_time_s,
        window,
        has_more_windows: task.windows.len() > 1,
        ends,
        is_on_edge: edge.is_some(),
        is_one_way: edge.is_some_and(|edge| edge.directed),
        is_mandatory: task.mandatory,
    }
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
        for arc in network.range_from(NodeId(at)) {
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
