//! The simplest planners that pass the conformance kit: for tests, comparisons and as a fallback.

use crate::motion::least_clearance;
use crate::{
    PathPlanner, PathProblem, PlanError, Planned, RoutePlanner, RouteProblem, Run, Score,
    StopReason, Trajectory, polyline::turn_radius_m,
};
use auv_graph::{QuickestTo, Route};
use auv_obstacles::ObstacleId;
use auv_types::libm;

/// Goes on along the arc of greatest weight per time as long as the quickest way to the destination
/// stays affordable.
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

/// Flies straight to the target through whatever is in the way, and names what blocks.
#[derive(Clone, Copy, Debug, Default)]
pub struct StraightPath;

impl PathPlanner for StraightPath {
    fn name(&self) -> &str {
        "straight"
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        problem.validate().into_result()?;
        run.grant(1);
        let line = [problem.start, problem.target];
        let (trajectory, not_made_good_m) = match problem.timed(&line) {
            Ok(trajectory) => (trajectory, 0.0),
            // The current is too strong: the plan for still water, its whole length in violation.
            Err(_) => {
                let points = PathProblem {
                    current: None,
                    ..*problem
                }
                .timed(&line);
                let trajectory = points.map_err(|error| PlanError::Failed {
                    planner: self.name().into(),
                    reason: error.to_string(),
                })?;
                let length_m = trajectory.length_m();
                (trajectory, length_m)
            }
        };
        let (penetration_m, blocked_by) = deepest_penetration(problem, &trajectory);
        let violation = penetration_m + not_made_good_m + excess(problem, &trajectory);
        let cost = trajectory.duration_s();
        run.end_generation(Score::new(violation, cost), &[], &[]);
        let mut planned =
            Planned::new(trajectory, cost, violation, run.stats(StopReason::Finished));
        planned.blocked_by = blocked_by;
        Ok(planned)
    }
}

/// How far a trajectory falls short of the clearance, and the region where it does most.
fn deepest_penetration(
    problem: &PathProblem<'_>,
    trajectory: &Trajectory,
) -> (f64, Option<ObstacleId>) {
    let always = (f64::NEG_INFINITY, f64::INFINITY);
    let nearest = least_clearance(trajectory, problem.regions, always, problem.clearance_m);
    let blocked_by = nearest.region.map(|i| problem.regions[i].obstacle);
    (problem.clearance_m - nearest.clearance_m, blocked_by)
}

/// The sum of the excesses of a straight path over box and depth (metres), pitch (radians) and turn
/// radius at its start (metres).
fn excess(problem: &PathProblem<'_>, trajectory: &Trajectory) -> f64 {
    let (start, way) = (problem.start, problem.target - problem.start);
    let length_m = way.norm();
    let out_m = problem.bounds.map_or(0.0, |bounds| {
        bounds
            .excess_m(&start)
            .max(bounds.excess_m(&problem.target))
    });
    let pitch_rad = libm::atan2(way.z.abs(), libm::hypot(way.x, way.y));
    let turn_short_m = match (problem.start_velocity, trajectory.points().get(1)) {
        (Some(velocity), Some(next)) if velocity.norm() > 0.0 => {
            let behind = start - velocity.normalize() * length_m;
            problem.vehicle.turn_radius_m - turn_radius_m(&behind, &start, &next.position)
        }
        _ => 0.0,
    };
    out_m
        + (pitch_rad - problem.vehicle.max_pitch_rad).max(0.0)
        + turn_short_m.max(0.0)
        + too_deep_m(problem, trajectory)
}

/// How much too deep a trajectory may be, metres: sampled every 5 m, with the bed rising between
/// samples as steeply as it can.
fn too_deep_m(problem: &PathProblem<'_>, trajectory: &Trajectory) -> f64 {
    let Some(bed) = problem.sea_bed else {
        return 0.0;
    };
    let start = trajectory.start();
    let mut worst_m = 0.0_f64;
    for (from, to) in trajectory.segments().chain([(&start, &start)]) {
        let way = to.position - from.position;
        let pieces = (way.norm() / 5.0).ceil().max(1.0);
        let reach_m = 0.5 * libm::hypot(way.x, way.y) / pieces;
        for k in 0..pieces as usize {
            let middle = from.position + way * ((k as f64 + 0.5) / pieces);
            let rise_m = reach_m * bed.max_slope_near(middle.x, middle.y, reach_m);
            let deepest_m = problem.deepest_at(middle.x, middle.y) - rise_m;
            worst_m = worst_m.max(middle.z + 0.5 * way.z.abs() / pieces - deepest_m);
        }
    }
    worst_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Budget, Vehicle};
    use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
    use auv_obstacles::Region;
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

    #[test]
    fn straight_path_names_what_blocks_it() {
        let vehicle = Vehicle::paper();
        let mut region = Region::ball(Point3::new(50.0, 0.0, 0.0), 10.0);
        region.obstacle = ObstacleId(7);
        let regions = [region];
        let problem = PathProblem {
            regions: &regions,
            ..PathProblem::new(Point3::origin(), Point3::new(100.0, 0.0, 0.0), &vehicle)
        };
        let plan = StraightPath
            .plan_path(&mut Run::new(Seed(0), Budget::evaluations(1)), &problem)
            .unwrap();
        assert_eq!(
            (plan.violation, plan.blocked_by),
            (10.0, Some(ObstacleId(7)))
        );
        assert!(plan.feasible().is_err());
    }
}
