//! Removal of arcs that cannot belong to a better route (reduced-cost fixing).

use crate::digraph::Digraph;
use crate::prices::Prices;
use crate::walks::Walks;
use auv_planning::Deadline;

/// The arcs over which some relaxed walk is worth at least `wanted`. `None` if the deadline passes.
pub(crate) fn fix_arcs(
    graph: &Digraph,
    walks: &Walks,
    prices: &Prices,
    (limit_s, wanted): (f64, f64),
    deadline: Deadline<'_>,
) -> Option<Digraph> {
    let reduced = prices.reduced(graph);
    let n = graph.num_nodes();
    let layers = walks.layers;
    let best_to = best_to(graph, &reduced, layers, deadline)?;
    // At index k, the most reduced weight from each node with fewer than k arcs.
    let mut best_from = vec![vec![f64::NEG_INFINITY; n]];
    for layer in 0..layers {
        if deadline.passed() {
            return None;
        }
        let best: Vec<_> = (0..n)
            .map(|v| best_from[layer][v].max(walks.best_from(layer, v)))
            .collect();
        best_from.push(best);
    }
    let credit = prices.credit(limit_s);
    graph.retain(deadline, |tail, arc| {
        (0..layers).any(|layer| {
            let rest = best_from[layers - layer][graph.head[arc]];
            best_to[layer][tail] + reduced[arc] + rest + credit >= wanted
        })
    })
}

/// The most reduced weight of walks from the start to each node, by number of arcs. These walks
/// remember nothing. `None` if the deadline passes.
fn best_to(
    graph: &Digraph,
    reduced: &[f64],
    layers: usize,
    deadline: Deadline<'_>,
) -> Option<Vec<Vec<f64>>> {
    let n = graph.num_nodes();
    let mut best_to = vec![vec![f64::NEG_INFINITY; n]; layers + 1];
    best_to[0][graph.start] = 0.0;
    for layer in 0..layers {
        if deadline.passed() {
            return None;
        }
        for tail in 0..n {
            for arc in graph.arcs_from(tail) {
                let value = best_to[layer][tail] + reduced[arc];
                let head = graph.head[arc];
                best_to[layer + 1][head] = best_to[layer + 1][head].max(value);
            }
        }
    }
    Some(best_to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::Memory;
    use crate::testing::{digraph, prices, routes};
    use auv_planning::{Budget, Run};
    use auv_types::Seed;

    #[test]
    fn no_arc_of_a_route_worth_what_is_wanted_is_removed() {
        let mut removed = 0;
        for seed in 0..20 {
            let limit_s = 6_000.0;
            let graph = digraph(7, 36, seed, limit_s);
            let layers = graph.most_arcs(limit_s);
            let memory = Memory::new(&graph, &vec![Vec::new(); 7], 0, Deadline::default()).unwrap();
            let prices = prices(&graph, seed);
            let mut run = Run::new(Seed(0), Budget::to_the_cap());
            let reduced = prices.reduced(&graph);
            let walks = Walks::new(&mut run, &graph, &memory, &reduced, layers).unwrap();
            let routes = routes(&graph, limit_s);
            let weight = |arcs: &[usize]| arcs.iter().map(|&arc| graph.weight[arc]).sum::<f64>();
            let most = routes.iter().map(|arcs| weight(arcs)).fold(0.0, f64::max);
            let wanted = 0.9 * most;
            let question = (limit_s, wanted);
            let left = fix_arcs(&graph, &walks, &prices, question, Deadline::default()).unwrap();
            let has =
                |tail: usize, head: usize| left.arcs_from(tail).any(|arc| left.head[arc] == head);
            for arcs in routes.iter().filter(|arcs| weight(arcs) >= wanted) {
                let mut tail = graph.start;
                for &arc in arcs {
                    assert!(has(tail, graph.head[arc]), "seed {seed}");
                    tail = graph.head[arc];
                }
            }
            removed += graph.num_arcs() - left.num_arcs();
        }
        assert!(removed > 0);
    }
}
