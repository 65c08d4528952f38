//! The arcs that can belong to a route within the budget, in compact adjacency.

use auv_graph::{NodeId, QuickestTo};
use auv_planning::{Deadline, RouteProblem};

/// Arcs by tail; none leads into the start or out of the destination.
#[derive(Clone, Debug)]
pub(crate) struct Digraph {
    pub(crate) start: usize,
    pub(crate) destination: usize,
    /// Arcs out of node `v` are `first[v]..first[v + 1]`.
    pub(crate) first: Vec<usize>,
    pub(crate) head: Vec<usize>,
    pub(crate) time_s: Vec<f64>,
    pub(crate) weight: Vec<f64>,
    /// Quickest time to the destination, by node; `+inf` where there is no way.
    pub(crate) home_s: Vec<f64>,
}

impl Digraph {
    /// The arcs over which the quickest way from start to destination fits the budget; nothing where
    /// the deadline passes.
    pub(crate) fn new(
        problem: &RouteProblem<'_>,
        home: &QuickestTo,
        deadline: Deadline<'_>,
    ) -> Option<Self> {
        let network = problem.network;
        let times_s = problem.times.unwrap_or(network.times_s());
        let mut all = Self {
            start: problem.start.index(),
            destination: problem.destination.index(),
            first: vec![0],
            head: Vec::new(),
            time_s: Vec::new(),
            weight: Vec::new(),
            home_s: home.times_s().to_vec(),
        };
        for tail in 0..network.num_nodes() {
            if deadline.passed() {
                return None;
            }
            let tail = NodeId(tail as u32);
            for arc in network.range_from(tail) {
                let (head, time_s) = (network.heads()[arc], times_s[arc]);
                let useful = head != problem.start
                    && tail != problem.destination
                    && time_s + all.home_s[head.index()] <= problem.time_available_s
                    && !problem.removed.contains(network.arcs()[arc].edge);
                if useful {
                    all.head.push(head.index());
                    all.time_s.push(time_s);
                    all.weight.push(network.weights()[arc]);
                }
            }
            all.first.push(all.head.len());
        }
        let from_start_s = all.quickest_from_start(deadline)?;
        let through_s = |tail: usize, arc: usize| {
            from_start_s[tail] + all.time_s[arc] + all.home_s[all.head[arc]]
        };
        // A hair of slack: the same sum in another order must not cost an arc.
        let limit_s = problem.time_available_s * (1.0 + 1e-12);
        all.retain(deadline, |tail, arc| through_s(tail, arc) <= limit_s)
    }

    pub(crate) fn num_nodes(&self) -> usize {
        self.home_s.len()
    }

    pub(crate) fn num_arcs(&self) -> usize {
        self.head.len()
    }

    pub(crate) fn arcs_from(&self, node: usize) -> std::ops::Range<usize> {
        self.first[node]..self.first[node + 1]
    }

    /// The arcs for which `keep(tail, arc)` holds; nothing where the deadline passes.
    pub(crate) fn retain(
        &self,
        deadline: Deadline<'_>,
        keep: impl Fn(usize, usize) -> bool,
    ) -> Option<Self> {
        let mut left = Self {
            first: vec![0],
            head: Vec::new(),
            time_s: Vec::new(),
            weight: Vec::new(),
            home_s: self.home_s.clone(),
            ..*self
        };
        for tail in 0..self.num_nodes() {
            if deadline.passed() {
                return None;
            }
            for arc in self.arcs_from(tail).filter(|&arc| keep(tail, arc)) {
                left.head.push(self.head[arc]);
                left.time_s.push(self.time_s[arc]);
                left.weight.push(self.weight[arc]);
            }
            left.first.push(left.head.len());
        }
        Some(left)
    }

    /// The most arcs a route within `limit_s` can have: one out of each of its nodes but the last.
    pub(crate) fn most_arcs(&self, limit_s: f64) -> usize {
        let quickest_out = |v| {
            let times = self.arcs_from(v).map(|arc| self.time_s[arc]);
            times.fold(f64::INFINITY, f64::min)
        };
        let others = (0..self.num_nodes()).filter(|&v| v != self.start);
        let mut quickest: Vec<f64> = others.map(quickest_out).filter(|t| t.is_finite()).collect();
        quickest.sort_unstable_by(f64::total_cmp);
        let mut time_s = quickest_out(self.start);
        let mut arcs = 1;
        for &next_s in &quickest {
            time_s += next_s;
            if time_s > limit_s * (1.0 + 1e-9) {
                break;
            }
            arcs += 1;
        }
        arcs
    }

    fn quickest_from_start(&self, deadline: Deadline<'_>) -> Option<Vec<f64>> {
        let n = self.num_nodes();
        let mut time_s = vec![f64::INFINITY; n];
        let mut done = vec![false; n];
        time_s[self.start] = 0.0;
        while !deadline.passed() {
            let open = (0..n).filter(|&v| !done[v] && time_s[v].is_finite());
            let Some(v) = open.min_by(|&a, &b| time_s[a].total_cmp(&time_s[b])) else {
                return Some(time_s);
            };
            done[v] = true;
            for arc in self.arcs_from(v) {
                let through_s = time_s[v] + self.time_s[arc];
                let head = self.head[arc];
                time_s[head] = time_s[head].min(through_s);
            }
        }
        None
    }
}
