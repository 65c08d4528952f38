//! What a route in time keeps to.

use crate::ids::{EdgeId, NodeId};
use crate::network::Network;
use crate::profile::Profiles;
use crate::timed_task::{TaskPlace, TimedTask};
use auv_types::Violations;
use std::collections::BTreeMap;

/// What a route in time keeps to, beside its network: tasks with windows and order, travel times by
/// departure, places to be met again and again, several destinations.
///
/// The edges' own tasks stay as they are: done when the edge is first passed, at its far end, before
/// other tasks of that edge. Node tasks are done after the arrival and before the departure. A route
/// visits no node twice, but may end where it starts.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeModel {
    /// Tasks at nodes and on edges, each done once or not at all.
    pub tasks: Vec<TimedTask>,
    /// Chains of tasks.
    pub chains: Vec<Chain>,
    /// Travel times by departure.
    pub profiles: Profiles,
    /// Places that must be met again and again.
    pub visits: Option<Visits>,
    /// Where the route may end, any of these; none: at the destination of the problem.
    pub destinations: Vec<NodeId>,
    /// Whether the vehicle may wait at nodes, before a task or before it leaves.
    pub may_wait: bool,
    /// What passing the place of a task means.
    pub passing: Passing,
}

/// Tasks that are done one after the other, in the order of [`TimeModel::tasks`] or all reversed, with no
/// other of these tasks between.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Its name.
    pub name: String,
    /// Whether any run of neighbours may be done; otherwise all or none.
    pub may_split: bool,
}

/// From the start, between arrivals at any of the nodes, and to the end at most `every_s` seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Visits {
    /// The nodes.
    pub nodes: Vec<NodeId>,
    /// Most time between two arrivals in seconds.
    pub every_s: f64,
}

/// What passing the place of a task means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Passing {
    /// A task is done only if the planner chooses.
    #[default]
    Free,
    /// A route may pass a node only if it does the tasks there (orienteering with time windows).
    DoesTasks,
}

impl Default for TimeModel {
    fn default() -> Self {
        Self {
            tasks: Vec::new(),
            chains: Vec::new(),
            profiles: Profiles::default(),
            visits: None,
            destinations: Vec::new(),
            may_wait: true,
            passing: Passing::Free,
        }
    }
}

impl TimeModel {
    /// The tasks of a chain in the order listed, by index.
    pub fn chain_tasks(&self, chain: usize) -> impl DoubleEndedIterator<Item = usize> + '_ {
        let of_chain = move |&task: &usize| self.tasks[task].chain == Some(chain);
        (0..self.tasks.len()).filter(of_chain)
    }

    /// Everything in the model that its network does not allow.
    #[must_use]
    pub fn validate(&self, network: &Network) -> Violations {
        let mut violations = Violations::new();
        let mut names = BTreeMap::new();
        for (i, task) in self.tasks.iter().enumerate() {
            let place = format!("tasks[{i}] ({})", task.name);
            if let Some(first) = names.insert(&task.name, i) {
                violations.push(&*place, format!("has the id of tasks[{first}]; rename one"));
            }
            self.check_task(task, &place, network, &mut violations);
        }
        self.check_order(&mut violations);
        if let Some(visits) = &self.visits {
            violations.require_positive(visits.every_s, "visits.every_s");
            require_nodes(network, &visits.nodes, "visits.nodes", &mut violations);
        }
        require_nodes(network, &self.destinations, "destinations", &mut violations);
        for (arc, _) in self.profiles.arcs() {
            violations.require(arc.index() < network.arcs().len(), "profiles", || {
                format!("names arc {}, which the network does not have", arc.0)
            });
        }
        violations
    }

    fn check_task(
        &self,
        task: &TimedTask,
        place: &str,
        network: &Network,
        violations: &mut Violations,
    ) {
        match task.place {
            TaskPlace::Node(node) => {
                require_nodes(network, &[node], &format!("{place}.node"), violations);
            }
            TaskPlace::Edge(EdgeId(edge)) => {
                let last = network.num_edges();
                violations.require((edge as usize) < last, &format!("{place}.edge"), || {
                    format!("is edge {edge}; the network has {last} edges, from 0")
                });
            }
        }
        let most = 1e12;
        let known = &task.task;
        let values = [
            (known.priority, 0.0, "rho"),
            (known.risk, 1e-12, "xi"),
            (known.completion_time_s, 0.0, "delta"),
        ];
        for (value, least, field) in values {
            let ok = (least..=most).contains(&value);
            violations.require(ok, &format!("{place}.{field}"), || {
                format!("is {value}; give a number from {least} to {most}")
            });
        }
        let apart = task.windows.iter().all(|[a, b]| a <= b)
            && task.windows.windows(2).all(|pair| pair[0][1] < pair[1][0]);
        violations.require(apart, &format!("{place}.windows"), || {
            "are not in order; give [from, to] in seconds, ascending and apart".into()
        });
        for &before in &task.after {
            violations.require(before < self.tasks.len(), &format!("{place}.after"), || {
                format!("names task {before}, which is not listed")
            });
        }
        violations.require(
            task.chain.is_none_or(|chain| chain < self.chains.len()),
            &format!("{place}.chain"),
            || "is not a chain of this model".into(),
        );
    }

    /// Whether the tasks can be put in an order that keeps every `after`.
    fn check_order(&self, violations: &mut Violations) {
        let count = self.tasks.len();
        let mut is_placed = vec![false; count];
        loop {
            let ready = |&i: &usize| {
                let before = &self.tasks[i].after;
                !is_placed[i] && before.iter().all(|&b| b >= count || is_placed[b])
            };
            let next: Vec<_> = (0..count).filter(ready).collect();
            if next.is_empty() {
                break;
            }
            for i in next {
                is_placed[i] = true;
            }
        }
        let stuck = (0..count).filter(|&i| !is_placed[i]);
        let names: Vec<_> = stuck.map(|i| self.tasks[i].name.to_string()).collect();
        violations.require(names.is_empty(), "tasks", || {
            let names = names.join(", ");
            format!("come after each other in a circle: {names}; remove one `after`")
        });
    }
}

fn require_nodes(network: &Network, nodes: &[NodeId], place: &str, violations: &mut Violations) {
    for &node in nodes {
        violations.require(network.has_node(node), place, || {
            let last = network.num_nodes() - 1;
            format!("names node {}; nodes are 0 to {last}", node.0)
        });
    }
}
