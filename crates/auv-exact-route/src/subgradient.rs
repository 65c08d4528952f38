//! The search for prices that give the lowest bound: a deflected subgradient method.

use crate::digraph::Digraph;
use crate::memory::Memory;
use crate::prices::Prices;
use crate::walks::Walks;
use auv_planning::Run;

/// The lowest bound found, and its prices.
pub(crate) struct PricedBound {
    pub(crate) prices: Prices,
    /// No route weighs more.
    pub(crate) bound: f64,
    /// How often a walk passed `u` between two visits of `v`, by `u * nodes + v`.
    pub(crate) cycles: Vec<f64>,
}

/// What a stage may do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StageLimits {
    pub(crate) limit_s: f64,
    /// Most arcs of a walk.
    pub(crate) layers: usize,
    /// Most price updates.
    pub(crate) updates: usize,
}

/// Lowers the bound by price updates. `found` is called with the arcs of every relaxed walk and returns
/// the weight of the best route known. `None` if the run has to stop.
pub(crate) fn lower_bound(
    run: &mut Run<'_>,
    graph: &Digraph,
    memory: &Memory,
    limits: StageLimits,
    priced: &mut PricedBound,
    mut found: impl FnMut(&[usize]) -> f64,
) -> Option<()> {
    let mut prices = priced.prices.clone();
    let mut subgradient = Subgradient::new(graph, limits);
    // With a larger memory even the old prices give another bound.
    let mut best_here = f64::INFINITY;
    for _ in 0..limits.updates {
        let reduced = prices.reduced(graph);
        let walks = Walks::new(run, graph, memory, &reduced, limits.layers)?;
        let (value, arcs) = walks.best(graph);
        let bound = value + prices.credit(limits.limit_s);
        let known = found(&arcs);
        let is_lower = bound < best_here - 1e-4 * (best_here - known).abs().min(1.0);
        best_here = best_here.min(bound);
        if bound < priced.bound {
            priced.bound = bound;
            priced.prices = prices.clone();
        }
        if priced.bound <= known {
            break;
        }
        if subgradient.has_stalled(is_lower) {
            prices = priced.prices.clone();
            if !subgradient.restart() {
                break;
            }
            continue;
        }
        count_cycles(graph, &arcs, &mut priced.cycles);
        if !subgradient.update(graph, &arcs, (bound - known).max(1e-6), &mut prices) {
            break;
        }
    }
    Some(())
}

/// Direction and step of the price updates.
struct Subgradient {
    limit_s: f64,
    /// A typical leg's time: in this unit a late walk and a repeated visit weigh alike.
    unit_s: f64,
    /// By node, and for time at the end.
    direction: Vec<f64>,
    step: f64,
    /// Updates in a row that did not lower the bound.
    stalled: u32,
}

impl Subgradient {
    const PATIENCE: u32 = 6;
    const STEP_FACTOR: f64 = 0.6;
    const LEAST_STEP: f64 = 0.01;

    fn new(graph: &Digraph, limits: StageLimits) -> Self {
        Self {
            limit_s: limits.limit_s,
            unit_s: (limits.limit_s / limits.layers as f64).max(1e-9),
            direction: vec![0.0; graph.num_nodes() + 1],
            step: 1.0,
            stalled: 0,
        }
    }

    fn has_stalled(&mut self, is_lower: bool) -> bool {
        self.stalled = if is_lower { 0 } else { self.stalled + 1 };
        self.stalled >= Self::PATIENCE
    }

    /// Starts again with a smaller step; returns whether that is worth it.
    fn restart(&mut self) -> bool {
        self.step *= Self::STEP_FACTOR;
        self.stalled = 0;
        self.direction.fill(0.0);
        self.step >= Self::LEAST_STEP
    }

    /// Changes the prices by a step against the violated constraints of a walk; returns whether there
    /// are any. `gap` is the distance of bound and best weight.
    fn update(&mut self, graph: &Digraph, arcs: &[usize], gap: f64, prices: &mut Prices) -> bool {
        let last = graph.num_nodes();
        let slack = self.slack(graph, arcs);
        let direction = &mut self.direction;
        for (v, &slack) in slack.iter().enumerate().take(last) {
            // The price of a node that is not visited cannot fall below 0.
            let useless = slack > 0.0 && prices.visit[v] <= 0.0;
            direction[v] = if useless {
                0.0
            } else {
                0.7 * slack + 0.3 * direction[v]
            };
        }
        direction[last] = 0.7 * slack[last] + 0.3 * direction[last];
        let length: f64 = direction.iter().map(|d| d * d).sum();
        if length <= 0.0 {
            return false;
        }
        let stride = self.step * gap / length;
        for (price, d) in prices.visit.iter_mut().zip(&*direction) {
            *price = (*price - stride * d).max(0.0);
        }
        prices.per_second = (prices.per_second - stride * direction[last] / self.unit_s).max(0.0);
        true
    }

    /// How far a walk is from breaking each constraint: one visit for each node, and at the end the
    /// time available.
    fn slack(&self, graph: &Digraph, arcs: &[usize]) -> Vec<f64> {
        let mut slack = vec![1.0; graph.num_nodes() + 1];
        let time_s: f64 = arcs.iter().map(|&arc| graph.time_s[arc]).sum();
        slack[graph.num_nodes()] = (self.limit_s - time_s) / self.unit_s;
        slack[graph.start] = 0.0;
        for &arc in arcs {
            slack[graph.head[arc]] -= 1.0;
        }
        slack[graph.destination] = 0.0;
        slack
    }
}

/// Counts the nodes between two visits of a node: they should have remembered it.
fn count_cycles(graph: &Digraph, arcs: &[usize], cycles: &mut [f64]) {
    let heads: Vec<_> = arcs.iter().map(|&arc| graph.head[arc]).collect();
    for (i, &v) in heads.iter().enumerate() {
        let Some(after) = heads[i + 1..].iter().position(|&u| u == v) else {
            continue;
        };
        for &u in &heads[i + 1..i + 1 + after] {
            cycles[u * graph.num_nodes() + v] += 1.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{digraph, routes};
    use auv_planning::{Budget, Deadline};
    use auv_types::Seed;

    /// The arcs along some nodes.
    fn arcs(graph: &Digraph, nodes: &[usize]) -> Vec<usize> {
        let arc = |pair: &[usize]| {
            let mut out = graph.arcs_from(pair[0]);
            out.find(|&arc| graph.head[arc] == pair[1]).unwrap()
        };
        nodes.windows(2).map(arc).collect()
    }

    #[test]
    fn the_bound_falls_and_stays_above_every_route() {
        for seed in 0..15 {
            let limit_s = 8_000.0;
            let graph = digraph(8, 48, seed, limit_s);
            let limits = StageLimits {
                limit_s,
                layers: graph.most_arcs(limit_s),
                updates: 60,
            };
            let memory = Memory::new(&graph, &vec![Vec::new(); 8], 0, Deadline::default()).unwrap();
            let start = f64::INFINITY;
            let mut priced = PricedBound {
                prices: Prices {
                    per_second: 0.0,
                    visit: vec![0.0; 8],
                },
                bound: start,
                cycles: vec![0.0; 64],
            };
            let mut run = Run::new(Seed(0), Budget::to_the_cap());
            let mut first = None;
            lower_bound(&mut run, &graph, &memory, limits, &mut priced, |walk| {
                first.get_or_insert(walk.iter().map(|&arc| graph.weight[arc]).sum::<f64>());
                0.0
            })
            .unwrap();
            // Without prices, the bound is the weight of the heaviest walk.
            assert!(priced.bound < first.unwrap(), "seed {seed}");
            let weight = |arcs: &Vec<usize>| arcs.iter().map(|&arc| graph.weight[arc]).sum();
            let most = routes(&graph, limit_s)
                .iter()
                .map(weight)
                .fold(0.0, f64::max);
            assert!(priced.bound >= most - 1e-9, "{} {most}", priced.bound);
            assert!(priced.prices.visit.iter().all(|&price| price >= 0.0));
        }
    }

    #[test]
    fn cycles_count_what_lies_between_two_visits() {
        let graph = digraph(6, 30, 1, 1e6);
        let mut cycles = vec![0.0; 36];
        count_cycles(&graph, &arcs(&graph, &[0, 1, 2, 3, 1, 5]), &mut cycles);
        let counted: Vec<_> = (0..36).filter(|&i| cycles[i] > 0.0).collect();
        assert_eq!(counted, [2 * 6 + 1, 3 * 6 + 1]);
    }

    #[test]
    fn prices_rise_on_repeated_visits_and_late_walks() {
        let graph = digraph(6, 30, 1, 1e6);
        let walk = arcs(&graph, &[0, 1, 2, 1, 5]);
        let time_s: f64 = walk.iter().map(|&arc| graph.time_s[arc]).sum();
        let limits = StageLimits {
            limit_s: 0.5 * time_s,
            layers: 4,
            updates: 1,
        };
        let mut prices = Prices {
            per_second: 1e-4,
            visit: vec![0.0, 0.2, 0.2, 0.2, 0.0, 0.0],
        };
        let before = prices.clone();
        assert!(Subgradient::new(&graph, limits).update(&graph, &walk, 1.0, &mut prices));
        assert!(prices.per_second > before.per_second);
        assert!(prices.visit[1] > before.visit[1], "visited twice");
        assert_eq!(prices.visit[2], before.visit[2], "visited once");
        assert!(prices.visit[3] < before.visit[3], "not visited");
        assert_eq!(prices.visit[4], 0.0);
    }
}
