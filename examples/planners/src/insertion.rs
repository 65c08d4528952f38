//! Routes by insertion, ruin and recreate (Schrimpf and others 2000).

use auv_planning::graph::{ArcId, NodeId, Route};
use auv_planning::types::rand::{Rng, RngExt};
use auv_planning::{PlanError, Planned, RoutePlanner, RouteProblem, Run, Score, StopReason};

/// Starts from the quickest route and inserts the waypoint of greatest weight for its time, again and
/// again; then takes out a random part and fills up again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Insertion {
    /// Times that a part is taken out, in a run without limits.
    pub rounds: u64,
    /// Most waypoints taken out at once, at least 1.
    pub ruined: usize,
}

impl Default for Insertion {
    fn default() -> Self {
        Self {
            rounds: 1_000,
            ruined: 6,
        }
    }
}

impl RoutePlanner for Insertion {
    fn name(&self) -> &str {
        "insertion"
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        problem.validate().into_result()?;
        if problem.time_model.is_some() {
            return Err(PlanError::NotInTime);
        }
        let mut random = run.seed().stream(0);
        let (quickest, _) = problem.quickest()?;
        let mut best = scored(problem, quickest);
        if let Some(incumbent) = problem.incumbent {
            best = better(best, scored(problem, incumbent.clone()));
        }
        for round in 0..=self.rounds {
            let mut nodes = best.1.nodes().to_vec();
            if round > 0 {
                self.ruin(&mut nodes, &mut random);
            }
            let all = fill(run, problem, &mut nodes);
            best = better(best, scored(problem, Route::new(nodes)));
            if !all {
                break;
            }
            run.end_generation(best.0, &[], &[]);
        }
        let stats = run.stats(StopReason::Finished);
        Ok(Planned::new(best.1, best.0.cost, best.0.violation, stats))
    }
}

type Scored = (Score, Route);

/// A route that does not hold together is the worst of all.
fn scored(problem: &RouteProblem<'_>, route: Route) -> Scored {
    let totals = problem
        .network
        .evaluate(&route, problem.removed, problem.times);
    let ends = (problem.start, problem.destination);
    let has_ends = route
        .nodes()
        .first()
        .copied()
        .zip(route.nodes().last().copied())
        == Some(ends);
    let score = match totals {
        Ok(totals) if has_ends => Score::new(
            problem.violation(totals.time_s),
            problem.objective.cost(&totals, problem.time_available_s),
        ),
        _ => Score::new(f64::INFINITY, f64::INFINITY),
    };
    (score, route)
}

fn better(a: Scored, b: Scored) -> Scored {
    if b.0 < a.0 { b } else { a }
}

impl Insertion {
    /// Takes out some consecutive inner nodes.
    fn ruin(&self, nodes: &mut Vec<NodeId>, random: &mut impl Rng) {
        if nodes.len() > 2 {
            let from = random.random_range(1..nodes.len() - 1);
            let count = random
                .random_range(1..=self.ruined)
                .min(nodes.len() - 1 - from);
            nodes.drain(from..from + count);
        }
    }
}

/// Inserts while something fits. A node tried is an evaluation. False when the run has to end.
fn fill(run: &mut Run<'_>, problem: &RouteProblem<'_>, nodes: &mut Vec<NodeId>) -> bool {
    loop {
        let wanted = problem.network.num_nodes() as u64;
        let granted = run.grant(wanted);
        match best_insertion(problem, nodes, granted as u32) {
            Some((node, place)) => nodes.insert(place, node),
            None => return granted == wanted,
        }
        if granted < wanted {
            return false;
        }
    }
}

/// Of the first `tried` nodes the one of greatest weight for its time, and its place in the route.
fn best_insertion(
    problem: &RouteProblem<'_>,
    nodes: &[NodeId],
    tried: u32,
) -> Option<(NodeId, usize)> {
    let network = problem.network;
    let arc = |from, to| {
        let arc: ArcId = network.arc_between(from, to)?;
        let is_removed = problem.removed.contains(network.arcs()[arc.index()].edge);
        let time_s = network.arc_time_s(arc, problem.times);
        (!is_removed && time_s.is_finite()).then(|| (time_s, network.weights()[arc.index()]))
    };
    // Where an arc is missing the part taken out is closed by an insertion, which saves no time.
    let direct = |place: usize| arc(nodes[place - 1], nodes[place]).unwrap_or((0.0, 0.0));
    let time_s: f64 = (1..nodes.len()).map(|place| direct(place).0).sum();
    let spare_s = problem.time_available_s - time_s;
    let mut best: Option<(f64, NodeId, usize)> = None;
    for node in (0..tried).map(NodeId).filter(|node| !nodes.contains(node)) {
        for place in 1..nodes.len() {
            let legs = arc(nodes[place - 1], node).zip(arc(node, nodes[place]));
            let Some((to, on)) = legs else { continue };
            let (saved_s, lost) = direct(place);
            let (added_s, gain) = (to.0 + on.0 - saved_s, to.1 + on.1 - lost);
            let worth = gain / added_s.max(1.0);
            if added_s <= spare_s && gain > 0.0 && best.is_none_or(|(most, ..)| worth > most) {
                best = Some((worth, node, place));
            }
        }
    }
    best.map(|(_, node, place)| (node, place))
}
