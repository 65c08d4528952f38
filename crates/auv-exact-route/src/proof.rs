//! The stages of a proof: bound, search, remove arcs, widen.

use crate::arc_fixing::fix_arcs;
use crate::digraph::Digraph;
use crate::incumbent::Incumbent;
use crate::knapsack::knapsack_bound;
use crate::labels::{Bounding, Searched, search};
use crate::memory::{Memory, choose_memory};
use crate::prices::Prices;
use crate::settings::ExactSettings;
use crate::subgradient::{PricedBound, StageLimits, lower_bound};
use crate::walks::Walks;
use auv_graph::QuickestTo;
use auv_planning::{Run, Score};
use std::ops::ControlFlow;

/// Most values of relaxed walks kept at a time (16 bytes each).
const MOST_WALKS: usize = 1 << 22;
/// Most nodes that walks are computed for: tables of pairs of nodes take 16 bytes a pair.
const MOST_NODES: usize = 2000;

/// Improves the route and its bound until they meet, the settings allow no more, or the run has to
/// stop; `None` if it stopped in the middle of a step.
pub(crate) fn prove(
    settings: &ExactSettings,
    run: &mut Run<'_>,
    incumbent: &mut Incumbent<'_>,
    home: &QuickestTo,
) -> Option<()> {
    let limit_s = incumbent.problem.time_available_s;
    let graph = Digraph::new(incumbent.problem, home, run.deadline())?;
    incumbent.gain = least_gain(&graph);
    let layers = graph.most_arcs(limit_s);
    let (bound, per_second) = knapsack_bound(run, &graph, limit_s)?;
    incumbent.bound = bound;
    let n = graph.num_nodes();
    if n > MOST_NODES || run.should_stop() {
        return Some(());
    }
    let mut proof = OptimalityProof {
        settings,
        limit_s,
        layers,
        graph,
        priced: PricedBound {
            prices: Prices {
                per_second,
                visit: vec![0.0; n],
            },
            bound,
            cycles: vec![0.0; n * n],
        },
        near: vec![Vec::new(); n],
        width: settings.first_labels,
    };
    let mut stage = 0;
    while proof.run_stage(run, incumbent, stage)?.is_continue() {
        stage += 1;
    }
    Some(())
}

/// What one stage leaves to the next.
struct OptimalityProof<'a> {
    settings: &'a ExactSettings,
    limit_s: f64,
    /// Most arcs of a route.
    layers: usize,
    /// The arcs that may belong to a better route.
    graph: Digraph,
    priced: PricedBound,
    /// The nodes that walks remember at each node.
    near: Vec<Vec<usize>>,
    /// Labels kept in a layer.
    width: usize,
}

impl OptimalityProof<'_> {
    /// Lowers the bound, searches, removes arcs and widens the search. Breaks off when the proof ends,
    /// with or without success. `None` if the run has to stop in the middle of a step.
    fn run_stage(
        &mut self,
        run: &mut Run<'_>,
        incumbent: &mut Incumbent<'_>,
        stage: usize,
    ) -> Option<ControlFlow<()>> {
        let last = self.settings.memory.len() - 1;
        let Some(bits) = self.affordable_bits(self.settings.memory[stage.min(last)]) else {
            return Some(ControlFlow::Break(()));
        };
        let deadline = run.deadline();
        let reduced = self.priced.prices.reduced(&self.graph);
        let known = (&reduced[..], &self.priced.cycles[..]);
        let near = std::mem::take(&mut self.near);
        self.near = choose_memory(&self.graph, known, near, bits, deadline)?;
        let memory = Memory::new(&self.graph, &self.near, bits, deadline)?;
        if stage <= last {
            self.lower_bound(run, incumbent, &memory, stage == 0)?;
            if incumbent.is_proven() {
                return Some(ControlFlow::Break(()));
            }
        }
        let searched = self.search(run, incumbent, &memory)?;
        incumbent.bound = incumbent.bound.min(searched.left_out.max(incumbent.weight));
        run.end_generation(Score::feasible(-incumbent.weight), &[], &[]);
        let is_over = searched.stopped || run.should_stop() || incumbent.is_proven();
        let is_widest = self.width == self.settings.most_labels && stage >= last;
        if is_over || is_widest {
            return Some(ControlFlow::Break(()));
        }
        self.width = (4 * self.width).min(self.settings.most_labels);
        Some(ControlFlow::Continue(()))
    }

    /// As many of the wanted memory bits as the walks have room for.
    fn affordable_bits(&self, wanted: usize) -> Option<usize> {
        let fits = |bits: &usize| Walks::size(&self.graph, self.layers, *bits) <= MOST_WALKS;
        (0..=wanted).rev().find(fits)
    }

    fn lower_bound(
        &mut self,
        run: &mut Run<'_>,
        incumbent: &mut Incumbent<'_>,
        memory: &Memory,
        is_first: bool,
    ) -> Option<()> {
        // The first stage is short, so that large networks soon have a good route.
        let share = if is_first { 8 } else { 1 };
        let limits = StageLimits {
            limit_s: self.limit_s,
            layers: self.layers,
            updates: self.settings.price_updates.div_ceil(share),
        };
        let graph = &self.graph;
        let result = lower_bound(run, graph, memory, limits, &mut self.priced, |arcs| {
            let heads = arcs.iter().map(|&arc| graph.head[arc]);
            incumbent.offer_nodes(std::iter::once(graph.start).chain(heads))
        });
        incumbent.bound = incumbent.bound.min(self.priced.bound);
        result
    }

    /// Searches at the prices found, then takes out the arcs that cannot belong to a better route.
    fn search(
        &mut self,
        run: &mut Run<'_>,
        incumbent: &mut Incumbent<'_>,
        memory: &Memory,
    ) -> Option<Searched> {
        let deadline = run.deadline();
        let (graph, prices) = (&self.graph, &self.priced.prices);
        let reduced = prices.reduced(graph);
        let walks = Walks::new(run, graph, memory, &reduced, self.layers)?;
        let question = (self.limit_s, incumbent.weight + incumbent.gain);
        let fixed = fix_arcs(graph, &walks, prices, question, deadline)?;
        let bounding = Bounding {
            graph,
            memory,
            prices,
            completions: &walks.completions(deadline)?,
            limit_s: self.limit_s,
            layers: self.layers,
        };
        let (mut known, gain) = (incumbent.weight, incumbent.gain);
        let searched = search(run, &bounding, self.width, &mut known, gain, |nodes| {
            incumbent.offer_nodes(nodes)
        });
        self.graph = fixed;
        Some(searched)
    }
}

/// The least difference of two routes' weights: half a unit if all weights are multiples of one half
/// (scores on nodes), else a relative 1e-9 for rounding.
fn least_gain(graph: &Digraph) -> f64 {
    let halves = graph
        .weight
        .iter()
        .all(|w| (2.0 * w).fract() == 0.0 && *w < 1e9);
    let most: f64 = graph.weight.iter().copied().fold(0.0, f64::max);
    if halves {
        0.5 - 1e-6
    } else {
        1e-9 * most.max(1e-9)
    }
}
