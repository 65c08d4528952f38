//! The stages of a proof: a knapsack, the linear relaxation, branch and cut.

use crate::branch_and_cut::branch_and_cut;
use crate::digraph::Digraph;
use crate::incumbent::Incumbent;
use crate::knapsack::knapsack_bound;
use crate::relaxation::Relaxation;
use crate::root_bound::lower_bound;
use crate::settings::ExactSettings;
use auv_graph::QuickestTo;
use auv_planning::Run;

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
    let (bound, per_second) = knapsack_bound(run, &graph, limit_s)?;
    incumbent.bound = bound;
    if graph.num_nodes() > settings.most_nodes || run.should_stop() {
        return Some(());
    }
    let mut relaxation = Relaxation::new(&graph, incumbent, per_second, run.deadline())?;
    lower_bound(run, &mut relaxation, incumbent)?;
    if !incumbent.is_proven() {
        branch_and_cut(run, &mut relaxation, incumbent, settings.most_parts);
    }
    Some(())
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
