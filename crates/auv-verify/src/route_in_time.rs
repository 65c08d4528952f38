//! The check of a route in time, from the network's waypoints and edges and the model's tasks.

use crate::route::{RouteReport, edges_of_legs, length_m};
use crate::sum::Sum;
use auv_graph::{EdgeId, NodeId, Route, TaskPlace, TimeModel};
use auv_planning::{RouteProblem, Schedule};
use std::collections::BTreeMap;
use thiserror::Error;

/// Differences of sums of times below this, in seconds, are rounding.
const ROUNDING_S: f64 = 1e-6;

/// A rule that a route in time breaks.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TimeViolation {
    /// It has no nodes, a node that is not in the network, or departures that do not fit its legs.
    #[error("is not a route with one departure for each leg")]
    Malformed,
    /// It does not start at the start, or does not end at a destination.
    #[error("begins at node {first} and ends at node {last}", first = first.0, last = last.0)]
    WrongEnds {
        /// Its first node.
        first: NodeId,
        /// Its last node.
        last: NodeId,
    },
    /// It visits a node again that is not start and end.
    #[error("visits node {node} again", node = node.0)]
    RepeatedNode {
        /// The node.
        node: NodeId,
    },
    /// No usable edge leads from one node to the next.
    #[error("no edge leads from node {from} to node {to}", from = from.0, to = to.0)]
    MissingEdge {
        /// Where the edge would start.
        from: NodeId,
        /// Where it would end.
        to: NodeId,
    },
    /// It leaves a node before it is ready.
    #[error("leaves node {node} at {departure_s} s and is ready at {ready_s} s", node = node.0)]
    LeavesEarly {
        /// The node.
        node: NodeId,
        /// When it leaves.
        departure_s: f64,
        /// When it could.
        ready_s: f64,
    },
    /// It waits where waiting is not allowed.
    #[error("waits at node {node}", node = node.0)]
    Waits {
        /// The node.
        node: NodeId,
    },
    /// A task begins before the vehicle is there, outside its windows, or is done twice.
    #[error("task {task} begins at {start_s} s: {why}")]
    WrongStart {
        /// The task.
        task: usize,
        /// When it begins.
        start_s: f64,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A task is said to be done where the route does not pass.
    #[error("task {task} is not on the way at its place in the order")]
    NotOnTheWay {
        /// The task.
        task: usize,
    },
    /// A task is done before one that it comes after.
    #[error("task {task} comes before task {before}")]
    WrongOrder {
        /// The task.
        task: usize,
        /// The task that comes first.
        before: usize,
    },
    /// A mandatory task is not done, or one at a node whose passing does its tasks.
    #[error("task {task} is not done")]
    NotDone {
        /// The task.
        task: usize,
    },
    /// A chain is done in part, out of order, or with another task between.
    #[error("chain {chain} is not kept")]
    BrokenChain {
        /// The chain.
        chain: usize,
    },
    /// More than the allowed time lies between two visits.
    #[error("{gap_s} s lie between two visits")]
    LateVisit {
        /// The time between them.
        gap_s: f64,
    },
    /// It takes longer than the time available.
    #[error("takes {time_s} s of {available_s} s available")]
    TooLong {
        /// Time of the route in seconds.
        time_s: f64,
        /// Time available in seconds.
        available_s: f64,
    },
}

/// Checks a route in time with its schedule against the problem and adds it up again; every rule that it
/// breaks, in the order met along the route.
///
/// Nothing of the planners' own bookkeeping is used, as in [`verify_route`](crate::verify_route). The
/// problem itself is taken to be valid. Complexity: O(m log k) for m edges and k legs.
#[must_use]
pub fn verify_route_in_time(
    problem: &RouteProblem<'_>,
    route: &Route,
    schedule: &Schedule,
) -> (RouteReport, Vec<TimeViolation>) {
    let no_model = TimeModel::default();
    let model = problem.time_model.unwrap_or(&no_model);
    let nodes = route.nodes();
    let known = nodes.iter().all(|&node| problem.network.has_node(node));
    let tasks_known = schedule
        .done
        .iter()
        .all(|done| done.task < model.tasks.len());
    if !known || !tasks_known || nodes.len() != schedule.departures_s.len() + 1 {
        return (RouteReport::default(), vec![TimeViolation::Malformed]);
    }
    let mut check = Check {
        problem,
        model,
        schedule,
        edges: edges_of_legs(problem.network, nodes),
        time_s: 0.0,
        next_done: 0,
        finished: Vec::new(),
        visits_s: vec![0.0],
        weight: Sum::default(),
        report: RouteReport::default(),
        found: Vec::new(),
    };
    check.ends_and_nodes(nodes);
    check.walk(nodes);
    check.rules(nodes);
    check.report.weight = check.weight.total();
    check.report.time_s = check.time_s;
    (check.report, check.found)
}

struct Check<'a> {
    problem: &'a RouteProblem<'a>,
    model: &'a TimeModel,
    schedule: &'a Schedule,
    edges: BTreeMap<(NodeId, NodeId), Option<EdgeId>>,
    time_s: f64,
    /// The next of the schedule's tasks.
    next_done: usize,
    finished: Vec<usize>,
    visits_s: Vec<f64>,
    weight: Sum,
    report: RouteReport,
    found: Vec<TimeViolation>,
}

impl Check<'_> {
    fn ends_and_nodes(&mut self, nodes: &[NodeId]) {
        let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
        let ends = &self.model.destinations;
        let is_end = ends.contains(&last) || (ends.is_empty() && last == self.problem.destination);
        if first != self.problem.start || !is_end {
            self.found.push(TimeViolation::WrongEnds { first, last });
        }
        let closes = usize::from(nodes.len() > 1 && first == last);
        let mut sorted = nodes[closes..].to_vec();
        sorted.sort_unstable();
        for pair in sorted.windows(2).filter(|pair| pair[0] == pair[1]) {
            self.found
                .push(TimeViolation::RepeatedNode { node: pair[0] });
        }
    }

    fn walk(&mut self, nodes: &[NodeId]) {
        let mut passed = Vec::new();
        for (k, &node) in nodes.iter().enumerate() {
            if self
                .model
                .visits
                .as_ref()
                .is_some_and(|visits| visits.nodes.contains(&node))
            {
                self.visits_s.push(self.time_s);
            }
            self.work(TaskPlace::Node(node), node);
            let Some(&next) = nodes.get(k + 1) else { break };
            self.leave(node, self.schedule.departures_s[k]);
            let edge = self.edges.get(&(node, next)).copied().flatten();
            let Some(edge) = edge.filter(|&edge| !self.problem.removed.contains(edge)) else {
                self.found.push(TimeViolation::MissingEdge {
                    from: node,
                    to: next,
                });
                continue;
            };
            let is_first = !passed.contains(&edge);
            passed.push(edge);
            self.pass(edge, (node, next), is_first);
            self.work(TaskPlace::Edge(edge), next);
        }
        if let Some(done) = self.schedule.done.get(self.next_done) {
            self.found
                .push(TimeViolation::NotOnTheWay { task: done.task });
        }
    }

    fn leave(&mut self, node: NodeId, departure_s: f64) {
        let ready_s = self.time_s;
        // Written so that a NaN is too early.
        if !(departure_s >= ready_s - ROUNDING_S) {
            self.found.push(TimeViolation::LeavesEarly {
                node,
                departure_s,
                ready_s,
            });
        } else if departure_s > ready_s + ROUNDING_S && !self.model.may_wait {
            self.found.push(TimeViolation::Waits { node });
        }
        self.time_s = self.time_s.max(departure_s);
    }

    /// Passes an edge; its own task is done the first time.
    fn pass(&mut self, id: EdgeId, (from, to): (NodeId, NodeId), is_first: bool) {
        let network = self.problem.network;
        let edge = &network.edges()[id.index()];
        let length_m = length_m(network, edge);
        self.report.distance_m += length_m;
        let own_s = edge.task.completion_time_s;
        let arcs = network.arcs();
        let at = arcs.binary_search_by_key(&(from, to), |arc| (arc.tail, arc.head));
        let mut travel_s = length_m / network.speed_mps();
        if let (Some(times), Ok(arc)) = (self.problem.times, at) {
            travel_s = times[arc] - own_s;
        }
        if let Some(row) = self
            .model
            .profiles
            .arcs()
            .find(|(arc, _)| Ok(arc.index()) == at)
        {
            travel_s = between(self.model.profiles.times_s(), row.1, self.time_s);
        }
        self.time_s += travel_s;
        if is_first {
            self.time_s += own_s;
            Sum::add(&mut self.weight, edge.task.priority / edge.task.risk);
            self.report.tasks += usize::from(edge.task.priority > 0.0);
        }
    }

    /// Does the tasks that the schedule lists next, as long as they are at this place.
    fn work(&mut self, place: TaskPlace, node: NodeId) {
        while let Some(done) = self.schedule.done.get(self.next_done) {
            let task = &self.model.tasks[done.task];
            if task.place != place {
                break;
            }
            self.next_done += 1;
            let start_s = done.start_s;
            let is_open = task.windows.is_empty()
                || task
                    .windows
                    .iter()
                    .any(|w| w[0] - ROUNDING_S <= start_s && start_s <= w[1] + ROUNDING_S);
            let wrong = [
                (
                    !(start_s >= self.time_s - ROUNDING_S),
                    "before the vehicle is there",
                ),
                (!is_open, "outside its windows"),
                (self.finished.contains(&done.task), "again"),
            ];
            for (_, why) in wrong.into_iter().filter(|(is_wrong, _)| *is_wrong) {
                self.found.push(TimeViolation::WrongStart {
                    task: done.task,
                    start_s,
                    why,
                });
            }
            if start_s > self.time_s + ROUNDING_S && !self.model.may_wait {
                self.found.push(TimeViolation::Waits { node });
            }
            for &before in task
                .after
                .iter()
                .filter(|before| !self.finished.contains(before))
            {
                self.found.push(TimeViolation::WrongOrder {
                    task: done.task,
                    before,
                });
            }
            self.time_s = self.time_s.max(start_s) + task.task.completion_time_s;
            Sum::add(&mut self.weight, task.task.priority / task.task.risk);
            self.report.tasks += 1;
            self.finished.push(done.task);
        }
    }

    fn rules(&mut self, nodes: &[NodeId]) {
        let passing_works = self.model.passing == auv_graph::Passing::DoesTasks;
        for (i, task) in self.model.tasks.iter().enumerate() {
            let passed = match task.place {
                TaskPlace::Node(node) => passing_works && nodes.contains(&node),
                TaskPlace::Edge(_) => false,
            };
            if (task.mandatory || passed) && !self.finished.contains(&i) {
                self.found.push(TimeViolation::NotDone { task: i });
            }
        }
        for chain in 0..self.model.chains.len() {
            if !self.keeps_chain(chain) {
                self.found.push(TimeViolation::BrokenChain { chain });
            }
        }
        self.visits_s.push(self.time_s);
        if let Some(visits) = &self.model.visits {
            for pair in self.visits_s.windows(2) {
                let gap_s = pair[1] - pair[0];
                if !(gap_s <= visits.every_s + ROUNDING_S) {
                    self.found.push(TimeViolation::LateVisit { gap_s });
                }
            }
        }
        let (time_s, available_s) = (self.time_s, self.problem.time_available_s);
        // Written so that a NaN is too long.
        if !(time_s <= available_s + ROUNDING_S) {
            self.found.push(TimeViolation::TooLong {
                time_s,
                available_s,
            });
        }
    }

    /// Whether the tasks done of a chain are a run of it, one after the other, forwards or backwards.
    fn keeps_chain(&self, chain: usize) -> bool {
        let tasks = &self.model.tasks;
        let listed: Vec<_> = (0..tasks.len())
            .filter(|&i| tasks[i].chain == Some(chain))
            .collect();
        let in_chain = |task: &usize| listed.contains(task);
        let Some(first) = self.finished.iter().position(in_chain) else {
            return true;
        };
        let count = self.finished.iter().filter(|task| in_chain(task)).count();
        let Some(run) = self.finished.get(first..first + count) else {
            return false;
        };
        let reversed: Vec<_> = run.iter().rev().copied().collect();
        let is_run = |run: &[usize]| listed.windows(count).any(|part| part == run);
        (is_run(run) || is_run(&reversed))
            && (self.model.chains[chain].may_split || count == listed.len())
    }
}

/// The value at a departure of a line through points, constant outside.
fn between(times_s: &[f64], travel_s: &[f64], at_s: f64) -> f64 {
    let last = times_s.len() - 1;
    if at_s <= times_s[0] {
        return travel_s[0];
    }
    for k in 0..last {
        if at_s <= times_s[k + 1] {
            let share = (at_s - times_s[k]) / (times_s[k + 1] - times_s[k]);
            return travel_s[k] + (travel_s[k + 1] - travel_s[k]) * share;
        }
    }
    travel_s[last]
}
