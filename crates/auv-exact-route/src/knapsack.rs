//! The first bound: a knapsack with at most one arc out of each node.

use crate::digraph::Digraph;
use auv_planning::{Deadline, Run};

/// A bound of the weight of every route, and the price of a second that gives it. `None` if the
/// deadline passes before the first bound.
///
/// Every price gives a bound, so the search for the best price may end at any time.
pub(crate) fn knapsack_bound(
    run: &mut Run<'_>,
    graph: &Digraph,
    limit_s: f64,
) -> Option<(f64, f64)> {
    let deadline = run.deadline();
    let at_price = |per_second| bound_at_price(graph, limit_s, per_second, deadline);
    let mut best = (at_price(0.0)?, 0.0);
    let rates = (0..graph.num_arcs()).map(|arc| graph.weight[arc] / graph.time_s[arc].max(1.0));
    let (mut low, mut high) = (0.0, rates.fold(0.0, f64::max));
    // The bound is convex in the price: a ternary search.
    for _ in 0..20 {
        let (a, b) = (low + 0.4 * (high - low), low + 0.6 * (high - low));
        if run.should_stop() {
            break;
        }
        let (Some(at_a), Some(at_b)) = (at_price(a), at_price(b)) else {
            break;
        };
        if at_a < at_b {
            high = b;
        } else {
            low = a;
        }
        for (bound, price) in [(at_a, a), (at_b, b)] {
            if bound < best.0 {
                best = (bound, price);
            }
        }
    }
    Some(best)
}

/// The most weight less price of one arc out of each node, and the price of all seconds.
fn bound_at_price(
    graph: &Digraph,
    limit_s: f64,
    per_second: f64,
    deadline: Deadline<'_>,
) -> Option<f64> {
    let value = |arc| graph.weight[arc] - per_second * graph.time_s[arc];
    let mut bound = 0.0;
    for v in 0..graph.num_nodes() {
        if deadline.passed() {
            return None;
        }
        bound += graph.arcs_from(v).map(value).fold(0.0, f64::max);
    }
    Some(bound + per_second * limit_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{digraph, routes};
    use auv_planning::Budget;
    use auv_types::Seed;

    #[test]
    fn no_route_weighs_more_than_the_bound_and_no_price_gives_a_much_lower_one() {
        for seed in 0..20 {
            let limit_s = 7_000.0;
            let graph = digraph(7, 30, seed, limit_s);
            let mut run = Run::new(Seed(0), Budget::to_the_cap());
            let (bound, price) = knapsack_bound(&mut run, &graph, limit_s).unwrap();
            for arcs in routes(&graph, limit_s) {
                let weight: f64 = arcs.iter().map(|&arc| graph.weight[arc]).sum();
                assert!(weight <= bound + 1e-9, "seed {seed}");
            }
            let at = |price| bound_at_price(&graph, limit_s, price, Deadline::default()).unwrap();
            assert_eq!(at(price), bound);
            let others = (0..500).map(|i| at(f64::from(i) * 1e-5));
            assert!(bound <= others.fold(f64::INFINITY, f64::min) * 1.01 + 1e-9);
        }
    }
}
