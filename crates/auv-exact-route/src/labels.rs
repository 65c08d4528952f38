//! The search over partial routes, layer by layer. Each layer keeps the labels of highest bounds; the
//! bound of what it drops is recorded.

use crate::digraph::Digraph;
use crate::memory::Memory;
use crate::prices::Prices;
use crate::walks::Completions;
use auv_planning::Run;

/// What labels are bounded with.
pub(crate) struct Bounding<'a> {
    pub(crate) graph: &'a Digraph,
    pub(crate) memory: &'a Memory,
    pub(crate) prices: &'a Prices,
    pub(crate) completions: &'a Completions,
    pub(crate) limit_s: f64,
    pub(crate) layers: usize,
}

/// The result of a search.
pub(crate) struct Searched {
    /// Bound of the weight of every route that was dropped; `-inf` if none was.
    pub(crate) left_out: f64,
    /// Whether the run had to stop first.
    pub(crate) stopped: bool,
}

/// A partial route from the start.
#[derive(Clone, Copy, Debug)]
struct Label {
    node: u32,
    /// Index in the layer before.
    parent: u32,
    time_s: f64,
    weight: f64,
    /// Reduced weight.
    reduced: f64,
    /// No completion weighs more.
    bound: f64,
    /// Index of its set of visited nodes.
    set: u32,
}

/// The labels of one layer with their sets of visited nodes, as bits in words.
#[derive(Debug, Default)]
struct Layer {
    labels: Vec<Label>,
    sets: Vec<u64>,
}

impl Layer {
    /// The label of the start.
    fn start(graph: &Digraph, words: usize) -> Self {
        let mut layer = Self::default();
        let mut set = vec![0_u64; words];
        set[graph.start / 64] |= 1 << (graph.start % 64);
        layer.sets.extend_from_slice(&set);
        layer.labels.push(Label {
            node: graph.start as u32,
            parent: 0,
            time_s: 0.0,
            weight: 0.0,
            reduced: 0.0,
            bound: f64::INFINITY,
            set: 0,
        });
        layer
    }

    fn set(&self, label: &Label, words: usize) -> &[u64] {
        &self.sets[label.set as usize * words..][..words]
    }

    /// Drops a label if another with the same node and set is neither slower nor of less weight, and
    /// keeps of the rest the `most` with the highest bounds. Returns the highest bound
    /// among the labels beyond `most`.
    fn reduce(&mut self, words: usize, most: usize) -> f64 {
        let mut labels = std::mem::take(&mut self.labels);
        labels.sort_unstable_by(|a, b| {
            a.node
                .cmp(&b.node)
                .then_with(|| self.set(a, words).cmp(self.set(b, words)))
                .then(a.time_s.total_cmp(&b.time_s))
                .then(b.weight.total_cmp(&a.weight))
                .then(a.parent.cmp(&b.parent))
        });
        let mut kept: Vec<Label> = Vec::with_capacity(labels.len().min(most));
        for label in labels {
            let dominated = kept.last().is_some_and(|last| {
                last.node == label.node
                    && last.weight >= label.weight
                    && self.set(last, words) == self.set(&label, words)
            });
            if !dominated {
                kept.push(label);
            }
        }
        let mut dropped = f64::NEG_INFINITY;
        if kept.len() > most {
            // The sort is stable: equal bounds keep the order of node and set.
            kept.sort_by(|a, b| b.bound.total_cmp(&a.bound));
            dropped = kept[most].bound;
            kept.truncate(most);
        }
        let mut sets = Vec::with_capacity(kept.len() * words);
        for (i, label) in kept.iter_mut().enumerate() {
            sets.extend_from_slice(self.set(label, words));
            label.set = i as u32;
        }
        self.labels = kept;
        self.sets = sets;
        dropped
    }
}

/// The bits of the remembered nodes of `head` that are visited.
fn visited_bits(near: &[usize], visited: &[u64]) -> usize {
    let remembered = near.iter().enumerate();
    remembered
        .map(|(bit, &u)| ((visited[u / 64] >> (u % 64) & 1) as usize) << bit)
        .sum()
}

/// A search under way.
struct LabelSearch<'a> {
    bounding: &'a Bounding<'a>,
    reduced: Vec<f64>,
    credit: f64,
    words: usize,
    /// Node and parent of every label of the finished layers, to read routes from.
    trail: Vec<Vec<(u32, u32)>>,
}

impl LabelSearch<'_> {
    /// Extends label `i` of a layer by one arc to labels with `used` arcs. A label whose bound is below
    /// `known + gain` is dropped.
    #[inline]
    fn extend(
        &self,
        layer: &Layer,
        (i, used): (usize, usize),
        (known, gain): (&mut f64, f64),
        next: &mut Layer,
        found: &mut impl FnMut(Vec<usize>) -> f64,
    ) {
        let bounding = self.bounding;
        let graph = bounding.graph;
        let label = &layer.labels[i];
        let visited = layer.set(label, self.words);
        for arc in graph.arcs_from(label.node as usize) {
            let head = graph.head[arc];
            let time_s = label.time_s + graph.time_s[arc];
            if visited[head / 64] >> (head % 64) & 1 == 1
                || time_s + graph.home_s[head] > bounding.limit_s
            {
                continue;
            }
            let weight = label.weight + graph.weight[arc];
            if head == graph.destination {
                if weight > *known {
                    *known = found(self.nodes_to(label, head));
                }
                continue;
            }
            let reduced = label.reduced + self.reduced[arc];
            let seen = visited_bits(&bounding.memory.near[head], visited);
            let arcs_left = bounding.layers - used;
            let completion = bounding.completions.best(arcs_left, head, seen);
            let bound = (reduced + completion + self.credit).min(label.bound);
            if bound < *known + gain {
                continue;
            }
            let at = next.sets.len();
            next.sets.extend_from_slice(visited);
            next.sets[at + head / 64] |= 1 << (head % 64);
            next.labels.push(Label {
                node: head as u32,
                parent: i as u32,
                time_s,
                weight,
                reduced,
                bound,
                set: (at / self.words) as u32,
            });
        }
    }

    /// The nodes of a label's route and then `last`.
    fn nodes_to(&self, label: &Label, last: usize) -> Vec<usize> {
        let mut nodes = vec![last, label.node as usize];
        let mut parent = label.parent;
        for layer in self.trail.iter().rev() {
            let (node, above) = layer[parent as usize];
            nodes.push(node as usize);
            parent = above;
        }
        nodes.reverse();
        nodes
    }
}

/// Searches all routes that may weigh at least `known + gain`, with at most `width` labels a layer.
/// `found` is called with the nodes of every route that weighs more than `known`, and returns its new
/// value. Takes one evaluation for each label that is extended.
pub(crate) fn search(
    run: &mut Run<'_>,
    bounding: &Bounding<'_>,
    width: usize,
    known: &mut f64,
    gain: f64,
    mut found: impl FnMut(Vec<usize>) -> f64,
) -> Searched {
    let words = bounding.graph.num_nodes().div_ceil(64);
    let mut search = LabelSearch {
        bounding,
        reduced: bounding.prices.reduced(bounding.graph),
        credit: bounding.prices.credit(bounding.limit_s),
        words,
        trail: Vec::new(),
    };
    let mut searched = Searched {
        left_out: f64::NEG_INFINITY,
        stopped: false,
    };
    let mut layer = Layer::start(bounding.graph, words);
    for used in 1..=bounding.layers {
        let mut next = Layer::default();
        for (i, label) in layer.labels.iter().enumerate() {
            if label.bound < *known + gain {
                continue;
            }
            if run.grant(1) == 0 {
                let open = layer.labels[i..].iter().chain(&next.labels);
                let bounds = open.map(|label| label.bound);
                searched.left_out = bounds.fold(searched.left_out, f64::max);
                searched.stopped = true;
                return searched;
            }
            search.extend(&layer, (i, used), (known, gain), &mut next, &mut found);
            if next.labels.len() > 4 * width + 4096 {
                searched.left_out = searched.left_out.max(next.reduce(words, width));
            }
        }
        searched.left_out = searched.left_out.max(next.reduce(words, width));
        let nodes = layer.labels.iter().map(|label| (label.node, label.parent));
        search.trail.push(nodes.collect());
        layer = next;
        if layer.labels.is_empty() {
            break;
        }
    }
    searched
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{digraph, prices, routes};
    use crate::walks::Walks;
    use auv_planning::{Budget, Deadline};
    use auv_types::Seed;

    /// The most weight that a search finds, the nodes of its last route, and its result.
    fn searched(
        graph: &Digraph,
        seed: u64,
        limit_s: f64,
        (width, budget): (usize, Budget),
    ) -> (f64, Vec<usize>, Searched) {
        let n = graph.num_nodes();
        let layers = graph.most_arcs(limit_s);
        let near: Vec<Vec<usize>> = (0..n)
            .map(|v| (1..n - 1).filter(|&u| u != v && (u + v) % 2 == 1).collect())
            .collect();
        let bits = near.iter().map(Vec::len).max().unwrap();
        let memory = Memory::new(graph, &near, bits, Deadline::default()).unwrap();
        let prices = prices(graph, seed);
        let mut run = Run::new(Seed(0), Budget::to_the_cap());
        let reduced = prices.reduced(graph);
        let walks = Walks::new(&mut run, graph, &memory, &reduced, layers).unwrap();
        let bounding = Bounding {
            graph,
            memory: &memory,
            prices: &prices,
            completions: &walks.completions(Deadline::default()).unwrap(),
            limit_s,
            layers,
        };
        let (mut known, mut best) = (0.0, Vec::new());
        let mut run = Run::new(Seed(0), budget);
        let result = search(&mut run, &bounding, width, &mut known, 1e-9, |nodes| {
            best.clone_from(&nodes);
            weight_along(graph, &nodes)
        });
        (known, best, result)
    }

    fn weight_along(graph: &Digraph, nodes: &[usize]) -> f64 {
        let arc = |pair: &[usize]| {
            let mut out = graph.arcs_from(pair[0]);
            out.find(|&arc| graph.head[arc] == pair[1]).unwrap()
        };
        nodes.windows(2).map(|pair| graph.weight[arc(pair)]).sum()
    }

    fn most_weight(graph: &Digraph, limit_s: f64) -> f64 {
        let weight = |arcs: &Vec<usize>| arcs.iter().map(|&arc| graph.weight[arc]).sum();
        routes(graph, limit_s)
            .iter()
            .map(weight)
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_wide_search_finds_the_optimum_of_an_enumeration_and_drops_nothing_better() {
        for seed in 0..25 {
            let limit_s = 8_000.0;
            let graph = digraph(8, 46, seed, limit_s);
            let expected = most_weight(&graph, limit_s);
            let all = (10_000, Budget::to_the_cap());
            let (known, best, result) = searched(&graph, seed, limit_s, all);
            assert!(
                (known - expected).abs() < 1e-9,
                "seed {seed}: {known} {expected}"
            );
            assert_eq!(
                (best[0], best[best.len() - 1]),
                (graph.start, graph.destination)
            );
            assert!(!result.stopped && result.left_out == f64::NEG_INFINITY);
        }
    }

    #[test]
    fn what_a_narrow_or_stopped_search_drops_is_bounded() {
        let mut missed = 0;
        for seed in 0..25 {
            let limit_s = 8_000.0;
            let graph = digraph(8, 46, seed, limit_s);
            let expected = most_weight(&graph, limit_s);
            for (width, budget) in [
                (1, Budget::to_the_cap()),
                (2, Budget::to_the_cap()),
                (10_000, Budget::evaluations(3)),
            ] {
                let (known, _, result) = searched(&graph, seed, limit_s, (width, budget));
                assert!(known <= expected + 1e-9);
                assert!(result.left_out.max(known) >= expected - 1e-9, "seed {seed}");
                missed += usize::from(known < expected - 1e-9);
            }
        }
        assert!(missed > 0, "every narrow search found the optimum");
    }

    #[test]
    fn a_label_is_dominated_only_by_one_of_equal_node_and_set() {
        let label = |node, time_s, weight, bound, set| Label {
            node,
            parent: 0,
            time_s,
            weight,
            reduced: 0.0,
            bound,
            set,
        };
        let mut layer = Layer {
            labels: vec![
                label(1, 5.0, 2.0, 9.0, 0),
                label(1, 6.0, 2.0, 8.0, 0),
                label(1, 7.0, 3.0, 7.0, 0),
                label(1, 6.0, 1.0, 6.0, 1),
                label(2, 6.0, 1.0, 5.0, 0),
            ],
            sets: vec![0b11, 0b101],
        };
        let mut all = Layer {
            labels: layer.labels.clone(),
            sets: layer.sets.clone(),
        };
        assert_eq!(all.reduce(1, 10), f64::NEG_INFINITY);
        let kept: Vec<_> = all.labels.iter().map(|label| label.bound).collect();
        assert_eq!(kept, [9.0, 7.0, 6.0, 5.0]);
        assert_eq!(all.sets, [0b11, 0b11, 0b101, 0b11]);
        assert_eq!(layer.reduce(1, 2), 6.0);
        let kept: Vec<_> = layer.labels.iter().map(|label| label.bound).collect();
        assert_eq!(kept, [9.0, 7.0]);
    }
}
