//! The arcs that can belong to a route within the budget, in compact adjacency.

use auv_graph::{NodeId, QuickestTo};
use auv_planning::{Deadline, RouteProblem};

/// Arcs by tail. No arc leads into the start or out of the destination.
#[derive(Clone, Debug)]
pub(crate) struct Digraph {
    pub(crate) start: usize,
    pub(crate) destination: usize,
    /// Arcs out of node `v` are `first[v]..first[v + 1]`.
    pub(crate) first: Vec<usize>,
    pub(crate) head: Vec<usize>,
    pub(crate) time_s: Vec<f64>,
    pub(crate) weight: Vec<f64>,
    /// Quickest time to the destination, by node; infinite if there is no way.
    pub(crate) home_s: Vec<f64>,
}

impl Digraph {
    /// The arcs over which the quickest walk from start to destination is in time. `None` if the
    /// deadline passes.
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
        // The tolerance keeps arcs for which the sum rounds differently in another order.
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

    /// The arcs for which `keep(tail, arc)` is true. `None` if the deadline passes.
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

    /// An upper bound of the arcs of a route within `limit_s`: it has one arc out of each node but the
    /// last, and none takes less than the quickest one out of its node.
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

    /// Least time from the start, by node. `None` if the deadline passes.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{digraph, routes};
    use auv_graph::{EdgeId, EdgeSet, Terrain, Topology};
    use auv_types::Seed;

    #[test]
    fn arcs_are_kept_exactly_if_the_quickest_walk_over_them_is_in_time() {
        let terrain = Terrain {
            topology: Topology::Directed,
            ..Terrain::paper(20, 250)
        };
        let network = terrain.draw(Seed(1)).unwrap().network;
        let removed: EdgeSet = (0..50).map(|i| EdgeId(5 * i)).collect();
        let home = network.quickest_to(NodeId(19), &removed, None);
        let limit_s = 4.0 * home.time_from_s(NodeId(0));
        let problem = RouteProblem {
            removed: &removed,
            ..RouteProblem::new(&network, NodeId(0), NodeId(19), limit_s)
        };
        let graph = Digraph::new(&problem, &home, Deadline::default()).unwrap();
        let mut kept = 0;
        for arc in network.arcs() {
            let to_tail = network.quickest_to(arc.tail, &removed, None);
            let walk_s = to_tail.time_from_s(NodeId(0)) + arc.time_s + home.time_from_s(arc.head);
            let expected = arc.head != NodeId(0)
                && arc.tail != NodeId(19)
                && !removed.contains(arc.edge)
                && walk_s <= limit_s;
            let mut out = graph.arcs_from(arc.tail.index());
            let found = out.find(|&i| graph.head[i] == arc.head.index());
            assert_eq!(found.is_some(), expected, "{arc:?}");
            if let Some(i) = found {
                assert_eq!((graph.time_s[i], graph.weight[i]), (arc.time_s, arc.weight));
                kept += 1;
            }
        }
        assert_eq!(kept, graph.num_arcs());
        assert!(kept > 0 && kept < 200, "{kept}");
    }

    #[test]
    fn no_route_has_more_arcs_than_the_bound() {
        let mut is_tight = false;
        for seed in 0..20 {
            let limit_s = 6_000.0;
            let graph = digraph(7, 36, seed, limit_s);
            let bound = graph.most_arcs(limit_s);
            let most = routes(&graph, limit_s).iter().map(Vec::len).max();
            if let Some(most) = most {
                assert!(most <= bound, "seed {seed}");
                is_tight |= most == bound;
            }
        }
        assert!(is_tight);
    }
}
