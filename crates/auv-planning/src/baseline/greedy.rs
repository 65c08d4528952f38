//! A route planner that takes the best arc each time.

use crate::timed::{fill, pieces, plan_in_time};
use crate::{PlanError, Planned, RoutePlanner, RouteProblem, Run, Score, StopReason};
use auv_graph::{QuickestTo, Route};

/// Goes on along the arc of greatest weight per time as long as the quickest way to the destination
/// stays affordable. In time, inserts what earns the most weight for the delay that it causes.
#[derive(Clone, Copy, Debug, Default)]
pub struct GreedyRoute;

impl RoutePlanner for GreedyRoute {
    fn name(&self) -> &str {
        "greedy"
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        if let Some(model) = problem.time_model {
            return plan_in_time(run, problem, model, self.name(), |run, tables, tour| {
                run.grant(1);
                fill(tables, tour, &pieces(tables));
                run.end_generation(Score::feasible(-tour.weight()), &[], &[]);
                StopReason::Finished
            });
        }
        let quickest = problem.prepare()?;
        run.grant(1);
        let (mut score, mut best) = (quickest.score, quickest.route);
        if score.is_feasible() {
            let greedy = greedy(problem, &quickest.home);
            let candidates = [Some(&greedy), problem.incumbent];
            for route in candidates.into_iter().flatten() {
                if let Ok(totals) = problem.check(route)
                    && problem.score(&totals) < score
                {
                    (score, best) = (problem.score(&totals), route.clone());
                }
            }
        }
        run.end_generation(score, &[], &[]);
        let stats = run.stats(StopReason::Finished);
        Ok(Planned::new(best, score.cost, score.violation, stats))
    }
}

/// Appends the arc of greatest weight per time as long as the quickest way to the destination, given
/// by `home`, visits no node again and is affordable; then follows that way. The route keeps the
/// time available whenever the quickest route does.
///
/// Complexity: O(m) for most networks: the arcs out of each node visited.
#[must_use]
pub fn greedy(problem: &RouteProblem<'_>, home: &QuickestTo) -> Route {
    let network = problem.network;
    let (heads, weights) = (network.heads(), network.weights());
    let times_s = problem.times.unwrap_or(network.times_s());
    let mut is_on = vec![false; network.num_nodes()];
    let (mut nodes, mut at, mut time_s) = (Vec::new(), problem.start, 0.0);
    loop {
        nodes.push(at);
        is_on[at.index()] = true;
        let is_usable = |arc: usize| {
            let mut way = home.way_from(heads[arc]).into_iter().flatten();
            way.all(|node| !is_on[node.index()])
                && !problem.removed.contains(network.arcs()[arc].edge)
        };
        let mut best: Option<(f64, usize)> = None;
        for arc in network.range_from(at) {
            let (head, arc_s) = (heads[arc], times_s[arc]);
            let whole_s = time_s + arc_s + home.time_from_s(head);
            // The small term orders arcs without weight by time, the quickest first.
            let score = (weights[arc] + 1e-9) / arc_s.max(1e-9);
            if whole_s <= problem.time_available_s
                && whole_s < f64::INFINITY
                && head != problem.destination
                && best.is_none_or(|(most, _)| score > most)
                && is_usable(arc)
            {
                best = Some((score, arc));
            }
        }
        let Some((_, arc)) = best else { break };
        at = heads[arc];
        time_s += times_s[arc];
    }
    nodes.extend(home.way_from(at).into_iter().flatten().skip(1));
    Route::new(nodes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Budget;
    use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
    use auv_types::{Point3, Seed};

    #[test]
    fn greedy_stays_within_the_budget_and_earns_more_than_the_quickest() {
        let waypoints: Vec<_> = (0..6)
            .map(|i| {
                Waypoint::at(Point3::new(
                    100.0 * f64::from(i),
                    50.0 * f64::from(i % 2),
                    10.0,
                ))
            })
            .collect();
        let task = Task {
            priority: 3.0,
            risk: 2.0,
            completion_time_s: 10.0,
        };
        let edges: Vec<_> = (0..6)
            .flat_map(|i| (i + 1..6).map(move |j| Edge::undirected(i, j, task)))
            .collect();
        let network = Network::new(&waypoints, &edges, 3.0).unwrap();
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(5), 260.0);
        let plan = GreedyRoute
            .plan_route(&mut Run::new(Seed(0), Budget::evaluations(1)), &problem)
            .unwrap();
        let totals = problem.check(&plan.best).unwrap();
        assert!(totals.weight > 1.5 && plan.violation == 0.0);
        let short = RouteProblem {
            time_available_s: 5.0,
            ..problem
        };
        let plan = GreedyRoute
            .plan_route(&mut Run::new(Seed(0), Budget::evaluations(1)), &short)
            .unwrap();
        assert!(plan.violation > 0.0 && plan.best.nodes().len() == 2);
    }
}
