//! The relaxation that bounds routes: walks that may return to a node once they have forgotten it
//! (ng-routes, Baldacci, Mingozzi and Roberti 2011), at a price for time and for visits.

use crate::digraph::Digraph;
use crate::memory::{FORBIDDEN, Memory};
use auv_planning::{Deadline, Run};

/// The most reduced weight of walks to the destination, by number of arcs, first node and memory.
#[derive(Debug)]
pub(crate) struct Walks {
    pub(crate) layers: usize,
    states: usize,
    nodes: usize,
    value: Vec<f64>,
    /// The first arc and the memory at its head, by the same index.
    next: Vec<(u32, u16)>,
}

impl Walks {
    /// Number of values that [`Walks::new`] keeps.
    pub(crate) fn size(graph: &Digraph, layers: usize, bits: usize) -> usize {
        ((layers + 1) * graph.num_nodes()) << bits
    }

    /// All walks of up to `layers` arcs. Takes one evaluation for each node of a layer. `None` if the
    /// run has to stop.
    pub(crate) fn new(
        run: &mut Run<'_>,
        graph: &Digraph,
        memory: &Memory,
        reduced: &[f64],
        layers: usize,
    ) -> Option<Self> {
        let (nodes, states) = (graph.num_nodes(), memory.states());
        let size = Self::size(graph, layers, memory.bits);
        let mut walks = Self {
            layers,
            states,
            nodes,
            value: Vec::with_capacity(size),
            next: Vec::with_capacity(size),
        };
        // The vectors grow layer by layer, since the first access to fresh memory takes longest.
        walks.value.resize(nodes * states, f64::NEG_INFINITY);
        walks.next.resize(nodes * states, (0, 0));
        walks.value[graph.destination * states] = 0.0;
        let deadline = run.deadline();
        // The memories in use at each node of the layer before.
        let mut in_use: Vec<Vec<u16>> = vec![Vec::new(); nodes];
        in_use[graph.destination].push(0);
        for layer in 1..=layers {
            if run.grant(nodes as u64) < nodes as u64 {
                return None;
            }
            let reached = (layer + 1) * nodes * states;
            walks.value.resize(reached, f64::NEG_INFINITY);
            walks.next.resize(reached, (0, 0));
            let (before, here) = walks.value.split_at_mut(layer * nodes * states);
            let before = &before[(layer - 1) * nodes * states..];
            let next = &mut walks.next[layer * nodes * states..];
            let question = (graph, memory, reduced);
            extend_layer(question, &in_use, before, (here, next), deadline)?;
            for (v, in_use) in in_use.iter_mut().enumerate() {
                keep_undominated(&mut here[v * states..][..states], in_use);
            }
        }
        Some(walks)
    }

    fn index(&self, layer: usize, node: usize, memory: usize) -> usize {
        (layer * self.nodes + node) * self.states + memory
    }

    /// The walk of most reduced weight from the start: that weight, and its arcs.
    pub(crate) fn best(&self, graph: &Digraph) -> (f64, Vec<usize>) {
        let mut best = (f64::NEG_INFINITY, 0, 0);
        for layer in 1..=self.layers {
            for memory in 0..self.states {
                let value = self.value[self.index(layer, graph.start, memory)];
                if value > best.0 {
                    best = (value, layer, memory);
                }
            }
        }
        let (value, mut layer, mut memory) = best;
        let mut node = graph.start;
        let mut arcs = Vec::new();
        while layer > 0 {
            let (arc, after) = self.next[self.index(layer, node, memory)];
            arcs.push(arc as usize);
            node = graph.head[arc as usize];
            memory = after as usize;
            layer -= 1;
        }
        (value, arcs)
    }

    /// The most reduced weight from a node with exactly `layer` arcs.
    pub(crate) fn best_from(&self, layer: usize, node: usize) -> f64 {
        let first = self.index(layer, node, 0);
        let values = self.value[first..first + self.states].iter();
        values.copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// The best completions of partial routes. `None` if the deadline passes.
    pub(crate) fn completions(mut self, deadline: Deadline<'_>) -> Option<Completions> {
        let full = self.states - 1;
        let layer_size = self.nodes * self.states;
        for layer in 0..=self.layers {
            if deadline.passed() {
                return None;
            }
            let (before, here) = self.value.split_at_mut(layer * layer_size);
            let here = &mut here[..layer_size];
            for block in here.chunks_exact_mut(self.states) {
                // The most over all memories within a set ...
                for bit in (0..).map(|b| 1 << b).take_while(|&bit| bit < self.states) {
                    for set in (0..self.states).filter(|set| set & bit != 0) {
                        block[set] = block[set].max(block[set ^ bit]);
                    }
                }
                // ... and so the most over all that share no node with the visited ones.
                for set in 0..=full / 2 {
                    block.swap(set, full ^ set);
                }
            }
            // The most with at most `layer` arcs.
            let before = before.rchunks_exact(layer_size).next().unwrap_or_default();
            for (here, &before) in here.iter_mut().zip(before) {
                *here = here.max(before);
            }
        }
        Some(Completions(self))
    }
}

/// Extends the walks of one layer by the arcs that lead to their first nodes. `in_use` lists the
/// memories of each node in the layer before. `None` if the deadline passes.
fn extend_layer(
    (graph, memory, reduced): (&Digraph, &Memory, &[f64]),
    in_use: &[Vec<u16>],
    before: &[f64],
    (here, next): (&mut [f64], &mut [(u32, u16)]),
    deadline: Deadline<'_>,
) -> Option<()> {
    let states = memory.states();
    for v in 0..graph.num_nodes() {
        if deadline.passed() {
            return None;
        }
        for arc in graph.arcs_from(v) {
            let head = graph.head[arc];
            let carried = memory.carried(arc);
            for &m in &in_use[head] {
                let to = carried[m as usize];
                if to == FORBIDDEN {
                    continue;
                }
                let value = before[head * states + m as usize] + reduced[arc];
                let at = v * states + to as usize;
                if value > here[at] {
                    here[at] = value;
                    next[at] = (arc as u32, m);
                }
            }
        }
    }
    Some(())
}

/// Drops a memory if a subset of it is worth no less, and lists those left.
fn keep_undominated(values: &mut [f64], in_use: &mut Vec<u16>) {
    in_use.clear();
    let states = values.len();
    for set in 0..states {
        if values[set] == f64::NEG_INFINITY {
            continue;
        }
        let dominated = in_use
            .iter()
            .any(|&other| other as usize & !set == 0 && values[other as usize] >= values[set]);
        if dominated {
            values[set] = f64::NEG_INFINITY;
        } else {
            in_use.push(set as u16);
        }
    }
}

/// The most reduced weight with which a partial route can be completed.
#[derive(Debug)]
pub(crate) struct Completions(Walks);

impl Completions {
    /// The most reduced weight from `node` with at most `arcs` arcs. `visited` has the bits of the
    /// nodes in the node's memory that the route has visited.
    pub(crate) fn best(&self, arcs: usize, node: usize, visited: usize) -> f64 {
        let Self(walks) = self;
        walks.value[walks.index(arcs.min(walks.layers), node, visited)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{digraph, prices, routes};
    use auv_planning::Budget;
    use auv_types::Seed;
    use std::collections::BTreeSet;

    fn walks(graph: &Digraph, near: &[Vec<usize>], reduced: &[f64], layers: usize) -> Walks {
        let bits = near.iter().map(Vec::len).max().unwrap_or(0);
        let memory = Memory::new(graph, near, bits, Deadline::default()).unwrap();
        let mut run = Run::new(Seed(0), Budget::to_the_cap());
        Walks::new(&mut run, graph, &memory, reduced, layers).unwrap()
    }

    /// All nodes but the node itself and the ends.
    fn all_others(graph: &Digraph) -> Vec<Vec<usize>> {
        let n = graph.num_nodes();
        let others = |v: usize| (1..n - 1).filter(|&u| u != v).collect();
        (0..n).map(others).collect()
    }

    /// The most reduced weight of walks from the start, by trying each one backwards with its set of
    /// remembered nodes.
    fn by_enumeration(
        graph: &Digraph,
        near: &[Vec<usize>],
        reduced: &[f64],
        layers: usize,
        (at, remembered, value): (usize, &BTreeSet<usize>, f64),
    ) -> f64 {
        let mut most = if at == graph.start {
            value
        } else {
            f64::NEG_INFINITY
        };
        if layers == 0 {
            return most;
        }
        for tail in 0..graph.num_nodes() {
            for arc in graph.arcs_from(tail).filter(|&arc| graph.head[arc] == at) {
                if remembered.contains(&tail) {
                    continue;
                }
                let mut at_tail = remembered.clone();
                at_tail.insert(at);
                at_tail.retain(|u| near[tail].contains(u));
                let next = (tail, &at_tail, value + reduced[arc]);
                most = most.max(by_enumeration(graph, near, reduced, layers - 1, next));
            }
        }
        most
    }

    #[test]
    fn the_best_walk_is_that_of_an_enumeration() {
        let mut revisits = 0;
        for seed in 0..30 {
            let graph = digraph(6, 26, seed, 25_000.0);
            let reduced = prices(&graph, seed).reduced(&graph);
            let near: Vec<Vec<usize>> = (0..6)
                .map(|v| (1..5).filter(|&u| u != v && (u + v) % 2 == 1).collect())
                .collect();
            let (value, arcs) = walks(&graph, &near, &reduced, 5).best(&graph);
            let start = (graph.destination, &BTreeSet::new(), 0.0);
            let expected = by_enumeration(&graph, &near, &reduced, 5, start);
            assert!(
                (value - expected).abs() < 1e-9,
                "seed {seed}: {value} {expected}"
            );
            let sum: f64 = arcs.iter().map(|&arc| reduced[arc]).sum();
            assert!((value - sum).abs() < 1e-9);
            let heads: BTreeSet<_> = arcs.iter().map(|&arc| graph.head[arc]).collect();
            revisits += usize::from(heads.len() < arcs.len());
        }
        assert!(revisits > 0, "no walk returned to a node");
    }

    #[test]
    fn walks_that_remember_everything_are_routes() {
        for seed in 0..20 {
            let graph = digraph(7, 34, seed, 25_000.0);
            let reduced = prices(&graph, seed).reduced(&graph);
            let (value, _) = walks(&graph, &all_others(&graph), &reduced, 6).best(&graph);
            let sum = |arcs: &Vec<usize>| arcs.iter().map(|&arc| reduced[arc]).sum();
            let routes = routes(&graph, f64::INFINITY);
            let expected = routes.iter().map(sum).fold(f64::NEG_INFINITY, f64::max);
            assert!(
                (value - expected).abs() < 1e-9,
                "seed {seed}: {value} {expected}"
            );
        }
    }

    #[test]
    fn completions_avoid_what_was_visited() {
        let graph = digraph(6, 28, 3, 25_000.0);
        let reduced = prices(&graph, 3).reduced(&graph);
        let near = all_others(&graph);
        let layers = 5;
        let completions = walks(&graph, &near, &reduced, layers)
            .completions(Deadline::default())
            .unwrap();
        let mut compared = 0;
        for (node, near) in near.iter().enumerate().take(5).skip(1) {
            for visited in 0..1_usize << near.len() {
                let is_visited = |u: usize| {
                    u == graph.start
                        || near
                            .iter()
                            .enumerate()
                            .any(|(bit, &other)| other == u && visited >> bit & 1 == 1)
                };
                for arcs in 1..=layers {
                    let expected =
                        best_completion(&graph, &reduced, arcs, &mut vec![node], &is_visited);
                    let found = completions.best(arcs, node, visited);
                    assert!(found == expected || (found - expected).abs() < 1e-9);
                    compared += usize::from(expected.is_finite());
                }
            }
        }
        assert!(compared > 50, "{compared}");
    }

    /// The most reduced weight from the last of `nodes` to the destination over nodes not visited.
    fn best_completion(
        graph: &Digraph,
        reduced: &[f64],
        arcs_left: usize,
        nodes: &mut Vec<usize>,
        is_visited: &impl Fn(usize) -> bool,
    ) -> f64 {
        let at = nodes[nodes.len() - 1];
        if at == graph.destination {
            return 0.0;
        }
        let mut most = f64::NEG_INFINITY;
        for arc in graph.arcs_from(at).filter(|_| arcs_left > 0) {
            let head = graph.head[arc];
            if !nodes.contains(&head) && !is_visited(head) {
                nodes.push(head);
                let rest = best_completion(graph, reduced, arcs_left - 1, nodes, is_visited);
                most = most.max(reduced[arc] + rest);
                nodes.pop();
            }
        }
        most
    }

    #[test]
    fn a_memory_is_dropped_if_a_subset_is_worth_as_much() {
        let none = f64::NEG_INFINITY;
        // By memory: {}, {0}, {1}, {0, 1}.
        let mut values = [1.0, 2.0, 1.0, 2.5];
        let mut in_use = Vec::new();
        keep_undominated(&mut values, &mut in_use);
        assert_eq!(values, [1.0, 2.0, none, 2.5]);
        assert_eq!(in_use, [0, 1, 3]);
    }
}
