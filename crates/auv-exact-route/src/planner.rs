//! The planner: bound, search, shrink, widen.

use crate::ExactSettings;
use crate::digraph::Digraph;
use crate::labels::{Bounding, search};
use crate::prices::{Priced, improve};
use crate::relaxation::{Memory, Prices, Walks};
use auv_graph::{NodeId, QuickestTo, Route};
use auv_planning::baseline::greedy;
use auv_planning::{
    Deadline, Objective, PlanError, Planned, RoutePlanner, RouteProblem, Run, Score, StopReason,
};

/// Finds the route of most weight and proves it, or says how much more there might be.
///
/// # Algorithm
/// Upper bounds come from walks that may return to a node once they have forgotten it, at prices
/// for time and visits that a subgradient method lowers the bound with. A search over partial
/// routes, layer by layer, keeps those with the highest bounds; what it drops bounds what it may
/// have missed, so a search that drops nothing above the best route is a proof. Between searches
/// arcs that cannot belong to a better route are taken out, walks remember more, and the layers
/// widen.
///
/// # Budget
/// Above 2000 nodes it gives the greedy route and the bound of a knapsack with one arc out of each
/// node.
///
/// One evaluation is one label, or one node of one layer of relaxed walks, extended over its arcs.
/// Stopped early it gives the best route so far, the greedy one at least; [`Planned::bound`] is minus
/// a proven upper bound of the weight (none when the time had passed before there was one). Ends by
/// itself with [`StopReason::Optimal`], or with [`StopReason::Finished`] when
/// [`ExactSettings::most_labels`] do not suffice for a proof.
///
/// # Determinism
/// Equal problems and evaluation budgets give equal bits; nothing is random and one thread is used.
///
/// # References
/// Baldacci, Mingozzi and Roberti, Operations Research 59(5), 2011 (ng-routes); Righini and Salani,
/// Computers and Operations Research 36(4), 2009 (orienteering by decremental relaxation).
#[derive(Clone, Debug, Default)]
pub struct ExactRoute {
    settings: ExactSettings,
}

impl ExactRoute {
    /// A planner with these settings.
    #[must_use]
    pub const fn new(settings: ExactSettings) -> Self {
        Self { settings }
    }

    /// Its settings.
    #[must_use]
    pub const fn settings(&self) -> &ExactSettings {
        &self.settings
    }
}

/// Most values of relaxed walks kept at a time (16 bytes each).
const MOST_WALKS: usize = 1 << 22;
/// Most nodes that walks are computed for: tables of pairs of nodes take 16 bytes a pair.
const MOST_NODES: usize = 2000;

/// The best route so far and the proven bound of its weight.
struct State<'a> {
    problem: &'a RouteProblem<'a>,
    route: Route,
    weight: f64,
    bound: f64,
    /// Two different weights differ by at least this.
    gain: f64,
}

impl State<'_> {
    /// Takes a route if it is feasible and earns more.
    fn offer(&mut self, route: &Route) {
        if let Ok(totals) = self.problem.check(route)
            && totals.weight > self.weight
        {
            self.weight = totals.weight;
            self.route = route.clone();
        }
    }

    fn offer_nodes(&mut self, nodes: impl IntoIterator<Item = usize>) -> f64 {
        let nodes = nodes.into_iter().map(|node| NodeId(node as u32));
        self.offer(&Route::new(nodes.collect()));
        self.weight
    }

    fn is_proven(&self) -> bool {
        self.bound <= self.weight || self.bound < self.weight + self.gain
    }
}

impl RoutePlanner for ExactRoute {
    fn name(&self) -> &str {
        "exact"
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        problem.validate().into_result()?;
        self.settings.validate().into_result()?;
        if problem.objective != Objective::MostWeight {
            return Err(PlanError::Unsupported {
                planner: self.name().into(),
                what: "objectives other than the most weight".into(),
            });
        }
        let home = problem
            .network
            .quickest_to(problem.destination, problem.removed, problem.times);
        let unreachable = || PlanError::Unreachable {
            start: problem.start.0,
            destination: problem.destination.0,
        };
        let quickest = home.route_from(problem.start).ok_or_else(unreachable)?;
        let totals = problem
            .network
            .evaluate(&quickest, problem.removed, problem.times)
            .map_err(|_| unreachable())?;
        let violation = problem.violation(totals.time_s);
        if violation > 0.0 {
            run.end_generation(Score::new(violation, -totals.weight), &[], &[]);
            let stats = run.stats(StopReason::Finished);
            return Ok(Planned::new(quickest, -totals.weight, violation, stats));
        }
        let mut state = State {
            problem,
            route: quickest,
            weight: totals.weight,
            bound: f64::INFINITY,
            gain: 0.0,
        };
        if problem.start == problem.destination {
            state.bound = state.weight;
        } else {
            if let Some(incumbent) = problem.incumbent {
                state.offer(incumbent);
            }
            run.grant(1);
            state.offer(&greedy(problem, &home));
            if self.prove(run, &mut state, &home).is_none() {
                // Given up in the middle of a step: say why.
                run.should_stop();
            }
        }
        let proven = state.is_proven();
        run.end_generation(Score::feasible(-state.weight), &[], &[]);
        let stats = run.stats(StopReason::Finished);
        let mut planned = Planned::new(state.route, -state.weight, 0.0, stats);
        let bound = state.bound.max(state.weight);
        planned.bound = bound.is_finite().then_some(-bound);
        if proven {
            planned.bound = Some(planned.cost);
            planned.stats.stop = StopReason::Optimal;
        }
        Ok(planned)
    }
}

impl ExactRoute {
    /// Improves the route and its bound until they meet or the run has to end; nothing where that
    /// was in the middle of a step.
    fn prove(&self, run: &mut Run<'_>, state: &mut State<'_>, home: &QuickestTo) -> Option<()> {
        let deadline = run.deadline();
        let limit_s = state.problem.time_available_s;
        let mut graph = Digraph::new(state.problem, home, deadline)?;
        state.gain = least_gain(&graph);
        let layers = graph.most_arcs(limit_s);
        let (bound, per_second) = knapsack_bound(run, &graph, limit_s)?;
        state.bound = bound;
        let n = graph.num_nodes();
        if n > MOST_NODES || run.should_stop() {
            return Some(());
        }
        let mut priced = Priced {
            prices: Prices {
                per_second,
                visit: vec![0.0; n],
            },
            bound,
            cycles: vec![0.0; n * n],
        };
        let mut width = self.settings.first_labels;
        let mut near = vec![Vec::new(); n];
        for stage in 0.. {
            let last = self.settings.memory.len() - 1;
            let mut bits = self.settings.memory[stage.min(last)];
            while bits > 0 && Walks::size(&graph, layers, bits) > MOST_WALKS {
                bits -= 1;
            }
            if Walks::size(&graph, layers, bits) > MOST_WALKS {
                return Some(());
            }
            near = remembered(&graph, &priced, near, bits, deadline)?;
            let memory = Memory::new(&graph, &near, bits, deadline)?;
            if stage <= last {
                // A first glance, so that large networks soon have a good route.
                let share = if stage == 0 { 8 } else { 1 };
                let updates = self.settings.price_updates.div_ceil(share);
                let question = (limit_s, layers, updates);
                let going_on = improve(run, &graph, &memory, question, &mut priced, |arcs| {
                    let heads = arcs.iter().map(|&arc| graph.head[arc]);
                    state.offer_nodes(std::iter::once(graph.start).chain(heads))
                });
                state.bound = state.bound.min(priced.bound);
                if going_on.is_none() || state.is_proven() {
                    return going_on;
                }
            }
            let reduced = priced.prices.reduced(&graph);
            let walks = Walks::new(run, &graph, &memory, &reduced, layers)?;
            let wanted = state.weight + state.gain;
            let shrunk = shrink(&graph, &walks, &priced, (limit_s, wanted), deadline)?;
            let completions = walks.completions(deadline)?;
            let bounding = Bounding {
                graph: &graph,
                memory: &memory,
                prices: &priced.prices,
                completions: &completions,
                limit_s,
                layers,
            };
            let mut known = state.weight;
            let gain = state.gain;
            let searched = search(run, &bounding, width, &mut known, gain, |nodes| {
                state.offer_nodes(nodes)
            });
            state.bound = state.bound.min(searched.left_out.max(state.weight));
            run.end_generation(Score::feasible(-state.weight), &[], &[]);
            if searched.stopped || run.should_stop() || state.is_proven() {
                return Some(());
            }
            if width == self.settings.most_labels && stage >= last {
                return Some(());
            }
            width = (4 * width).min(self.settings.most_labels);
            graph = shrunk;
        }
        Some(())
    }
}

/// What each node remembers: what it did before, so that bounds never get worse, then nodes in
/// whose cycles it was seen, then those with the most attractive way there and back. Nothing where
/// the deadline passes.
fn remembered(
    graph: &Digraph,
    priced: &Priced,
    mut near: Vec<Vec<usize>>,
    bits: usize,
    deadline: Deadline<'_>,
) -> Option<Vec<Vec<usize>>> {
    let reduced = priced.prices.reduced(graph);
    let n = graph.num_nodes();
    let mut there = vec![f64::NEG_INFINITY; n * n];
    for (tail, there) in there.chunks_exact_mut(n).enumerate() {
        for arc in graph.arcs_from(tail) {
            there[graph.head[arc]] = reduced[arc];
        }
        if deadline.passed() {
            return None;
        }
    }
    for (v, near) in near.iter_mut().enumerate() {
        if deadline.passed() {
            return None;
        }
        let other = |u: &usize| ![v, graph.start, graph.destination].contains(u);
        let rank = |u: usize| {
            let both = there[v * n + u] + there[u * n + v];
            (priced.cycles[v * n + u], both, u)
        };
        let others = (0..n).filter(|u| other(u) && !near.contains(u));
        let mut others: Vec<_> = others.map(rank).collect();
        let order = |a: &(f64, f64, usize), b: &(f64, f64, usize)| {
            let less = b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1));
            less.then(a.2.cmp(&b.2))
        };
        let wanted = bits.saturating_sub(near.len());
        if wanted < others.len() {
            others.select_nth_unstable_by(wanted, order);
            others.truncate(wanted);
        }
        others.sort_unstable_by(order);
        near.extend(others.iter().map(|&(.., u)| u));
        near.truncate(bits);
    }
    Some(near)
}

/// The arcs over which some relaxed walk is worth at least `wanted`; nothing where the deadline
/// passes.
fn shrink(
    graph: &Digraph,
    walks: &Walks,
    priced: &Priced,
    (limit_s, wanted): (f64, f64),
    deadline: Deadline<'_>,
) -> Option<Digraph> {
    let reduced = priced.prices.reduced(graph);
    let n = graph.num_nodes();
    let layers = walks.layers;
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
    // Best from a node with at most so many arcs.
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
    let credit = priced.prices.credit(limit_s);
    graph.retain(deadline, |tail, arc| {
        (0..layers).any(|layer| {
            let rest = best_from[layers - layer][graph.head[arc]];
            best_to[layer][tail] + reduced[arc] + rest + credit >= wanted
        })
    })
}

/// The least difference of two routes' weights: half a unit where all weights are halves (scores
/// on nodes), else a relative 1e-9 for rounding.
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

/// An upper bound with at most one arc out of each node, and the price of a second that gives it.
/// Any price gives a bound, so it may be stopped at any time; nothing where there was no time for
/// the first.
fn knapsack_bound(run: &mut Run<'_>, graph: &Digraph, limit_s: f64) -> Option<(f64, f64)> {
    let deadline = run.deadline();
    let at_price = |per_second: f64| {
        let value = |arc| graph.weight[arc] - per_second * graph.time_s[arc];
        let mut bound = 0.0;
        for v in 0..graph.num_nodes() {
            if deadline.passed() {
                return None;
            }
            bound += graph.arcs_from(v).map(value).fold(0.0, f64::max);
        }
        Some(bound + per_second * limit_s)
    };
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
