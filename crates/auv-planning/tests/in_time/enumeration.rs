//! All routes in time and all orders of their tasks, each begun as early as possible.

use auv_graph::{EdgeId, NodeId, TIME_TOLERANCE_S, TaskPlace, TimeModel};
use auv_planning::RouteProblem;

/// The most weight of all that keep every rule; `None` if none does.
pub(crate) fn most_weight(problem: &RouteProblem<'_>) -> Option<f64> {
    let mut all = Enumeration {
        problem,
        model: problem.time_model.unwrap(),
        nodes: vec![problem.start],
        arrivals_s: vec![0.0],
        done: Vec::new(),
        passed: Vec::new(),
        most: None,
    };
    all.at(TaskPlace::Node(problem.start), 0.0);
    all.most
}

struct Enumeration<'a> {
    problem: &'a RouteProblem<'a>,
    model: &'a TimeModel,
    nodes: Vec<NodeId>,
    arrivals_s: Vec<f64>,
    /// Tasks by index, in their order.
    done: Vec<usize>,
    passed: Vec<EdgeId>,
    most: Option<f64>,
}

impl Enumeration<'_> {
    /// Tries every continuation at a place: end, go on, or do one more task there.
    fn at(&mut self, place: TaskPlace, time_s: f64) {
        if time_s > self.problem.time_available_s + TIME_TOLERANCE_S {
            return;
        }
        for (i, task) in self.model.tasks.iter().enumerate() {
            let is_ready = task.after.iter().all(|before| self.done.contains(before));
            if self.done.contains(&i) || task.place != place || !is_ready {
                continue;
            }
            let Some(start_s) = task.earliest_start_s(time_s) else {
                continue;
            };
            if self.model.may_wait || start_s <= time_s + TIME_TOLERANCE_S {
                self.done.push(i);
                self.at(place, start_s + task.task.completion_time_s);
                self.done.pop();
            }
        }
        let here = *self.nodes.last().unwrap();
        if matches!(place, TaskPlace::Edge(_)) {
            self.at(TaskPlace::Node(here), time_s);
            return;
        }
        self.judge(time_s);
        if self.nodes.len() == 1 || here != self.nodes[0] {
            self.go_on(here, time_s);
        }
    }

    fn go_on(&mut self, here: NodeId, time_s: f64) {
        for (id, arc) in self.problem.network.arcs_from(here) {
            if self.nodes[1..].contains(&arc.head) {
                continue;
            }
            let profile = self.model.profiles.of(id);
            let travel_s = profile.map_or(arc.distance_m / 2.0, |p| p.travel_s(time_s));
            let is_first = !self.passed.contains(&arc.edge);
            let own_s = self.problem.network.task(arc.edge).completion_time_s;
            let arrival_s = time_s + travel_s + if is_first { own_s } else { 0.0 };
            self.nodes.push(arc.head);
            self.arrivals_s.push(arrival_s);
            self.passed.push(arc.edge);
            self.at(TaskPlace::Edge(arc.edge), arrival_s);
            self.passed.pop();
            self.arrivals_s.pop();
            self.nodes.pop();
        }
    }

    fn judge(&mut self, end_s: f64) {
        let end = self.nodes.last().unwrap();
        let is_end = match &self.model.destinations[..] {
            [] => *end == self.problem.destination,
            ends => ends.contains(end),
        };
        let tasks = self.model.tasks.iter().enumerate();
        let is_missing = tasks
            .filter(|(_, task)| task.mandatory)
            .any(|(i, _)| !self.done.contains(&i));
        if !is_end || is_missing || !self.keeps_chains() || !self.meets_places(end_s) {
            return;
        }
        let weight = self.weight();
        if self.most.is_none_or(|most| weight > most) {
            self.most = Some(weight);
        }
    }

    /// The tasks of a chain are neighbours in its order or reversed, all of them or, where it may be
    /// split, any run.
    fn keeps_chains(&self) -> bool {
        (0..self.model.chains.len()).all(|chain| {
            let listed: Vec<usize> = self.model.chain_tasks(chain).collect();
            let is_of_chain = |task: &&usize| listed.contains(task);
            let count = self.done.iter().filter(is_of_chain).count();
            if count == 0 {
                return true;
            }
            let back: Vec<usize> = listed.iter().rev().copied().collect();
            let runs = listed.windows(count).chain(back.windows(count));
            let mut is_kept = runs.map(|run| self.done.windows(count).any(|done| done == run));
            (self.model.chains[chain].may_split || count == listed.len())
                && is_kept.any(|kept| kept)
        })
    }

    /// No two arrivals at places to be met are further apart than allowed.
    fn meets_places(&self, end_s: f64) -> bool {
        let Some(visits) = &self.model.visits else {
            return true;
        };
        let met = self.nodes.iter().zip(&self.arrivals_s).skip(1);
        let met = met.filter(|(node, _)| visits.nodes.contains(node));
        let mut last_s = 0.0;
        met.map(|(_, at_s)| *at_s).chain([end_s]).all(|at_s| {
            let gap_s = at_s - std::mem::replace(&mut last_s, at_s);
            gap_s <= visits.every_s + TIME_TOLERANCE_S
        })
    }

    fn weight(&self) -> f64 {
        let mut edges = self.passed.clone();
        edges.sort();
        edges.dedup();
        let own = edges.iter().map(|edge| self.problem.network.task(*edge));
        let done = self.done.iter().map(|&i| self.model.tasks[i].task);
        own.chain(done).map(|task| task.weight()).sum()
    }
}
