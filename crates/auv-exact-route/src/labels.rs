//! The search: partial routes layer by layer, the most promising kept, all others' bounds noted.

use crate::digraph::Digraph;
use crate::relaxation::{Completions, Memory, Prices};
use auv_planning::Run;

/// What the labels are bounded with.
pub(crate) struct Bounding<'a> {
    pub(crate) graph: &'a Digraph,
    pub(crate) memory: &'a Memory,
    pub(crate) prices: &'a Prices,
    pub(crate) completions: &'a Completions,
    pub(crate) limit_s: f64,
    pub(crate) layers: usize,
}

/// What a search came to.
pub(crate) struct Searched {
    /// No route that was left out earns more than this; `-inf` when none was.
    pub(crate) left_out: f64,
    /// Whether the run had to end on the way.
    pub(crate) stopped: bool,
}

#[derive(Clone, Copy, Debug)]
struct Label {
    node: u32,
    parent: u32,
    time_s: f64,
    weight: f64,
    reduced: f64,
    bound: f64,
    /// Where its set of visited nodes stands.
    set: u32,
}

/// Labels of one layer with their sets of visited nodes.
#[derive(Debug, Default)]
struct Layer {
    labels: Vec<Label>,
    sets: Vec<u64>,
}

impl Layer {
    fn set(&self, label: &Label, words: usize) -> &[u64] {
        &self.sets[label.set as usize * words..][..words]
    }

    /// Keeps of labels with equal node and set those neither slower nor poorer than another, and of
    /// these the `most` with the highest bounds; returns the highest bound dropped.
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

/// Searches all routes that may earn more than `known` (updated), keeping `width` labels a layer;
/// `found` is called with the nodes of every better route. Charges one evaluation for each label
/// extended.
pub(crate) fn search(
    run: &mut Run<'_>,
    bounding: &Bounding<'_>,
    width: usize,
    known: &mut f64,
    gain: f64,
    mut found: impl FnMut(Vec<usize>) -> f64,
) -> Searched {
    let graph = bounding.graph;
    let words = graph.num_nodes().div_ceil(64);
    let reduced = bounding.prices.reduced(graph);
    let credit = bounding.prices.credit(bounding.limit_s);
    let mut searched = Searched {
        left_out: f64::NEG_INFINITY,
        stopped: false,
    };
    let mut layer = Layer::default();
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
    // Node and parent of every label of the layers left, to read routes back from.
    let mut trail: Vec<Vec<(u32, u32)>> = Vec::new();
    for used in 1..=bounding.layers {
        let mut next = Layer::default();
        for (i, label) in layer.labels.iter().enumerate() {
            if label.bound < *known + gain {
                continue;
            }
            if run.grant(1) == 0 {
                let open = layer.labels[i..].iter().chain(&next.labels);
                let most = open
                    .map(|label| label.bound)
                    .fold(f64::NEG_INFINITY, f64::max);
                searched.left_out = searched.left_out.max(most);
                searched.stopped = true;
                return searched;
            }
            let visited = layer.set(label, words);
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
                        let mut nodes = vec![head, label.node as usize];
                        let mut parent = label.parent;
                        for layer in trail.iter().rev() {
                            let (node, above) = layer[parent as usize];
                            nodes.push(node as usize);
                            parent = above;
                        }
                        nodes.reverse();
                        *known = found(nodes);
                    }
                    continue;
                }
                let reduced = label.reduced + reduced[arc];
                let remembered = bounding.memory.near[head].iter().enumerate();
                let seen = remembered
                    .map(|(bit, &u)| ((visited[u / 64] >> (u % 64) & 1) as usize) << bit)
                    .sum();
                let completion = bounding
                    .completions
                    .best(bounding.layers - used, head, seen);
                let bound = (reduced + completion + credit).min(label.bound);
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
                    set: (at / words) as u32,
                });
            }
            if next.labels.len() > 4 * width + 4096 {
                searched.left_out = searched.left_out.max(next.reduce(words, width));
            }
        }
        searched.left_out = searched.left_out.max(next.reduce(words, width));
        trail.push(
            layer
                .labels
                .iter()
                .map(|label| (label.node, label.parent))
                .collect(),
        );
        layer = next;
        if layer.labels.is_empty() {
            break;
        }
    }
    searched
}
