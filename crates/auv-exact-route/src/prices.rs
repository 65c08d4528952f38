//! Finding the prices with which the relaxation bounds best: a deflected subgradient method.

use crate::digraph::Digraph;
use crate::relaxation::{Memory, Prices, Walks};
use auv_planning::Run;

/// The best bound found, and what it rests on.
pub(crate) struct Priced {
    pub(crate) prices: Prices,
    /// Upper bound of the weight.
    pub(crate) bound: f64,
    /// How often a walk passed `u` between two visits of `v`, by `u * nodes + v`.
    pub(crate) cycles: Vec<f64>,
}

/// Lowers `priced.bound` by at most `updates` price updates; `found` is shown every relaxed walk
/// and returns the weight of the best route known. Nothing when the run has to end.
pub(crate) fn improve(
    run: &mut Run<'_>,
    graph: &Digraph,
    memory: &Memory,
    (limit_s, layers, updates): (f64, usize, usize),
    priced: &mut Priced,
    mut found: impl FnMut(&[usize]) -> f64,
) -> Option<()> {
    let mut prices = priced.prices.clone();
    // Times in units of a typical leg, so that a late walk and a repeated visit weigh alike.
    let unit_s = (limit_s / layers as f64).max(1e-9);
    let mut direction = vec![0.0; graph.num_nodes() + 1];
    let mut step = 1.0;
    let mut patience = 0;
    // With a larger memory the old prices bound anew.
    let mut best_here = f64::INFINITY;
    for _ in 0..updates {
        let reduced = prices.reduced(graph);
        let walks = Walks::new(run, graph, memory, &reduced, layers)?;
        let (value, arcs) = walks.best(graph);
        let bound = value + prices.credit(limit_s);
        let known = found(&arcs);
        if bound < best_here - 1e-4 * (best_here - known).abs().min(1.0) {
            patience = 0;
        } else {
            patience += 1;
        }
        best_here = best_here.min(bound);
        if bound < priced.bound {
            priced.bound = bound;
            priced.prices = prices.clone();
        }
        if priced.bound <= known {
            break;
        }
        if patience >= 6 {
            step *= 0.6;
            patience = 0;
            prices = priced.prices.clone();
            direction.fill(0.0);
            if step < 0.01 {
                break;
            }
            continue;
        }

        let mut slack = vec![1.0; graph.num_nodes() + 1];
        let time_s: f64 = arcs.iter().map(|&arc| graph.time_s[arc]).sum();
        slack[graph.num_nodes()] = (limit_s - time_s) / unit_s;
        slack[graph.start] = 0.0;
        for &arc in &arcs {
            slack[graph.head[arc]] -= 1.0;
        }
        slack[graph.destination] = 0.0;
        count_cycles(graph, &arcs, &mut priced.cycles);
        for (v, &slack) in slack.iter().enumerate().take(graph.num_nodes()) {
            // A free node that is not visited cannot get cheaper.
            let useless = slack > 0.0 && prices.visit[v] <= 0.0;
            direction[v] = if useless {
                0.0
            } else {
                0.7 * slack + 0.3 * direction[v]
            };
        }
        let last = graph.num_nodes();
        direction[last] = 0.7 * slack[last] + 0.3 * direction[last];
        let length: f64 = direction.iter().map(|d| d * d).sum();
        if length <= 0.0 {
            break;
        }
        let stride = step * (bound - known).max(1e-6) / length;
        for (price, d) in prices.visit.iter_mut().zip(&direction) {
            *price = (*price - stride * d).max(0.0);
        }
        prices.per_second = (prices.per_second - stride * direction[last] / unit_s).max(0.0);
    }
    Some(())
}

/// Notes what lies between two visits of a node: nodes that should have remembered it.
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
