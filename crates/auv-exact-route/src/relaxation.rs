//! The relaxation that bounds routes: walks that may return to a node once they have forgotten it
//! (ng-routes, Baldacci, Mingozzi and Roberti 2011), at a price for time and for visits.

use crate::digraph::Digraph;
use auv_planning::{Deadline, Run};

/// Lagrange multipliers: what a second and a visit cost, in weight.
#[derive(Clone, Debug)]
pub(crate) struct Prices {
    pub(crate) per_second: f64,
    /// By node; 0 for start and destination.
    pub(crate) visit: Vec<f64>,
}

impl Prices {
    /// What every route is credited: the budget's and all visits' prices.
    pub(crate) fn credit(&self, limit_s: f64) -> f64 {
        self.per_second * limit_s + self.visit.iter().sum::<f64>()
    }

    /// An arc's weight less its time's price and its head's.
    pub(crate) fn reduced(&self, graph: &Digraph) -> Vec<f64> {
        let arcs = 0..graph.num_arcs();
        arcs.map(|arc| {
            graph.weight[arc] - self.per_second * graph.time_s[arc] - self.visit[graph.head[arc]]
        })
        .collect()
    }
}

const FORBIDDEN: u16 = u16::MAX;

/// Which nodes a walk remembers at each node, and how memories carry over the arcs.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    pub(crate) bits: usize,
    /// Nodes remembered at a node, `bits` at most.
    pub(crate) near: Vec<Vec<usize>>,
    /// For the walk seen from its end: memory at an arc's tail by arc and memory at its head.
    carried: Vec<u16>,
}

impl Memory {
    /// Remembers at each node those of `near`, `bits` at most; nothing where the deadline passes.
    pub(crate) fn new(
        graph: &Digraph,
        near: &[Vec<usize>],
        bits: usize,
        deadline: Deadline<'_>,
    ) -> Option<Self> {
        let states = 1 << bits;
        let mut carried = Vec::with_capacity(graph.num_arcs() * states);
        let mut kept = Vec::with_capacity(bits);
        for tail in 0..graph.num_nodes() {
            if deadline.passed() {
                return None;
            }
            let bit_at_tail = |node| near[tail].iter().position(|&other| other == node);
            for arc in graph.arcs_from(tail) {
                let head = graph.head[arc];
                let own = bit_at_tail(head).map_or(0, |bit| 1_u16 << bit);
                let bits = near[head].iter().map(|&node| bit_at_tail(node));
                kept.clear();
                kept.extend(bits.map(|bit| bit.map_or(0, |bit| 1 << bit)));
                let returns = near[head].iter().position(|&node| node == tail);
                carried.extend((0..states).map(|memory| {
                    if returns.is_some_and(|bit| memory >> bit & 1 == 1) {
                        return FORBIDDEN;
                    }
                    let bits = (0..kept.len()).filter(|bit| memory >> bit & 1 == 1);
                    bits.fold(own, |all, bit| all | kept[bit])
                }));
            }
        }
        Some(Self {
            bits,
            near: near.to_vec(),
            carried,
        })
    }
}

/// Best values of walks to the destination by number of arcs, node and memory.
#[derive(Debug)]
pub(crate) struct Walks {
    pub(crate) layers: usize,
    states: usize,
    nodes: usize,
    value: Vec<f64>,
    /// The first arc and the memory behind it, by the same index.
    next: Vec<(u32, u16)>,
}

impl Walks {
    /// How many values and choices [`Walks::new`] would keep.
    pub(crate) fn size(graph: &Digraph, layers: usize, bits: usize) -> usize {
        ((layers + 1) * graph.num_nodes()) << bits
    }

    /// All walks of up to `layers` arcs; `None` when the run has to end. Charges one evaluation for
    /// each node of a layer.
    pub(crate) fn new(
        run: &mut Run<'_>,
        graph: &Digraph,
        memory: &Memory,
        reduced: &[f64],
        layers: usize,
    ) -> Option<Self> {
        let (nodes, states) = (graph.num_nodes(), 1 << memory.bits);
        let size = Self::size(graph, layers, memory.bits);
        let mut walks = Self {
            layers,
            states,
            nodes,
            value: Vec::with_capacity(size),
            next: Vec::with_capacity(size),
        };
        // Layer by layer: fresh memory takes longest when touched first.
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
            for v in 0..nodes {
                if deadline.passed() {
                    return None;
                }
                for arc in graph.arcs_from(v) {
                    let head = graph.head[arc];
                    let carried = &memory.carried[arc * states..][..states];
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
            for (v, in_use) in in_use.iter_mut().enumerate() {
                keep_undominated(&mut here[v * states..][..states], in_use);
            }
        }
        Some(walks)
    }

    fn index(&self, layer: usize, node: usize, memory: usize) -> usize {
        (layer * self.nodes + node) * self.states + memory
    }

    /// The best walk from the start: its value and its arcs.
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

    /// Best value from each node with exactly so many arcs, whatever is remembered.
    pub(crate) fn best_from(&self, layer: usize, node: usize) -> f64 {
        let begin = self.index(layer, node, 0);
        let values = self.value[begin..begin + self.states].iter();
        values.copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// The best completions of partial routes; nothing where the deadline passes.
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
                // Best over all memories within a set ...
                for bit in (0..).map(|b| 1 << b).take_while(|&bit| bit < self.states) {
                    for set in (0..self.states).filter(|set| set & bit != 0) {
                        block[set] = block[set].max(block[set ^ bit]);
                    }
                }
                // ... hence best over all that share nothing with what was visited.
                for set in 0..=full / 2 {
                    block.swap(set, full ^ set);
                }
            }
            // With as many arcs or less.
            let before = before.rchunks_exact(layer_size).next().unwrap_or_default();
            for (here, &before) in here.iter_mut().zip(before) {
                *here = here.max(before);
            }
        }
        Some(Completions(self))
    }
}

/// Drops memories whose subset does as well; lists those left.
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

/// The best reduced weight with which a partial route can be completed.
#[derive(Debug)]
pub(crate) struct Completions(Walks);

impl Completions {
    /// From `node` with at most `arcs` arcs, where `visited` holds those of the node's memory that
    /// the route has been to.
    pub(crate) fn best(&self, arcs: usize, node: usize, visited: usize) -> f64 {
        let Self(walks) = self;
        walks.value[walks.index(arcs.min(walks.layers), node, visited)]
    }
}
