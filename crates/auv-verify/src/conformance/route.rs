//! What any route planner must do.

use super::any_planner::{checks_of_any_planner, figures_are_sound};
use super::checks::{CheckResult, FailedCheck, FailedChecks, ensure, run_all};
use super::drawn_network::drawn_network;
use super::route_in_time::in_time_or_declined;
use super::watch::ended_within;
use crate::{RouteViolation, verify_route};
use auv_graph::{Edge, EdgeSet, Network, NodeId, Route, Task, Waypoint};
use auv_planning::{
    Budget, PlanError, Planned, RoutePlanner, RouteProblem, Run, Score, baseline::GreedyRoute,
};
use auv_types::{Point3, Seed};
use std::sync::Arc;
use std::time::Duration;

/// Runs all checks on a route planner; some seconds at most for a planner of 100,000 evaluations
/// a second. A planner that never ends makes it hang: see [`route_planner_within`].
///
/// # Errors
/// Every check that fails, with what happened instead.
pub fn route_planner(planner: &dyn RoutePlanner) -> Result<(), FailedChecks> {
    checked(planner, &|_| ())
}

/// [`route_planner`] on a thread of its own. Where a check has not ended within `limit`, that check fails,
/// and the thread is left behind.
///
/// # Errors
/// Every check that fails, with what happened instead.
pub fn route_planner_within(
    planner: Arc<dyn RoutePlanner>,
    limit: Duration,
) -> Result<(), FailedChecks> {
    ended_within(limit, move |began| checked(&planner, began))
}

fn checked(planner: &dyn RoutePlanner, began: &dyn Fn(&'static str)) -> Result<(), FailedChecks> {
    let network = |seed, nodes, density| {
        drawn_network(seed, nodes, density, false).map_err(|reason| {
            FailedChecks(vec![FailedCheck {
                check: "the kit's own network is sound",
                reason,
            }])
        })
    };
    let (small, large) = (network(1, 25, 0.5)?, network(6, 60, 0.6)?);
    let (easy, hard) = (small.problem(), large.problem());
    let of_any_planner =
        checks_of_any_planner(began, &|run| planner.plan_route(run, &easy), &|run| {
            planner.plan_route(run, &hard)
        });
    FailedChecks::joined([of_any_planner, checks_of_routes(planner, began)])
}

fn checks_of_routes(planner: &dyn RoutePlanner, began: &dyn Fn(&'static str)) -> Vec<FailedCheck> {
    run_all(
        began,
        &[
            ("a plan called feasible is", &|| plans_are_valid(planner)),
            ("removed edges are not used", &|| {
                removed_edges_are_not_used(planner)
            }),
            ("changed times are honoured", &|| {
                changed_times_are_honoured(planner)
            }),
            ("an incumbent is never made worse", &|| {
                incumbent_is_kept(planner)
            }),
            ("start and destination may be one node", &|| {
                start_may_be_destination(planner)
            }),
            ("tiny networks are solved", &|| {
                tiny_networks_are_solved(planner)
            }),
            ("an unreachable destination is an error", &|| {
                unreachable_is_an_error(planner)
            }),
            ("too little time gives the quickest route", &|| {
                too_little_time_gives_quickest(planner)
            }),
            ("malformed input is refused", &|| {
                malformed_is_refused(planner)
            }),
            ("routes in time are planned or declined", &|| {
                in_time_or_declined(planner)
            }),
        ],
    )
}

fn run(evaluations: u64) -> Run<'static> {
    Run::new(Seed(11), Budget::evaluations(evaluations))
}

fn plan(
    planner: &dyn RoutePlanner,
    evaluations: u64,
    problem: &RouteProblem<'_>,
) -> Result<Planned<Route>, String> {
    planner
        .plan_route(&mut run(evaluations), problem)
        .map_err(|error| format!("gives an error for a sound problem: {error}"))
}

/// The plan's claims equal the verifier's figures.
fn is_as_claimed(problem: &RouteProblem<'_>, plan: &Planned<Route>) -> CheckResult {
    figures_are_sound(plan)?;
    let report = verify_route(problem, &plan.best);
    let is_late = |v: &RouteViolation| matches!(v, RouteViolation::TooLong { .. });
    let hard = report.violations.iter().find(|v| !is_late(v));
    ensure(hard.is_none(), || format!("{:?}: {:?}", plan.best, hard))?;
    ensure((plan.violation == 0.0) == report.is_valid(), || {
        format!(
            "claims violation {} for a route of {} s in {} s",
            plan.violation, report.time_s, problem.time_available_s
        )
    })?;
    let totals = problem
        .network
        .evaluate(&plan.best, problem.removed, problem.times)
        .map_err(|error| error.to_string())?;
    let cost = problem.objective.cost(&totals, problem.time_available_s);
    ensure(
        (plan.cost - cost).abs() <= 1e-9 * (1.0 + cost.abs()),
        || format!("claims cost {} for a route of cost {cost}", plan.cost),
    )?;
    let is_bound = plan
        .bound
        .is_none_or(|bound| bound <= plan.cost + 1e-9 * (1.0 + cost.abs()));
    ensure(is_bound, || {
        format!("claims bound {:?} above its cost {}", plan.bound, plan.cost)
    })
}

fn plans_are_valid(planner: &dyn RoutePlanner) -> CheckResult {
    for (seed, nodes) in (0..).zip([3, 5, 8, 13, 20, 30]) {
        for (density, is_directed) in [(1.0, false), (0.4, false), (0.6, true)] {
            let drawn = drawn_network(100 + seed, nodes, density, is_directed)?;
            for evaluations in [1, 10, 400] {
                let problem = drawn.problem();
                let plan = plan(planner, evaluations, &problem)?;
                is_as_claimed(&problem, &plan).map_err(|reason| {
                    format!("{nodes} nodes, {evaluations} evaluations: {reason}")
                })?;
            }
        }
    }
    Ok(())
}

fn removed_edges_are_not_used(planner: &dyn RoutePlanner) -> CheckResult {
    let drawn = drawn_network(2, 20, 0.6, true)?;
    let problem = drawn.problem();
    let removed = edges_used(planner, &problem)?;
    let without = RouteProblem {
        removed: &removed,
        ..problem
    };
    is_as_claimed(&without, &plan(planner, 300, &without)?)
}

/// The edges of the route that a planner takes.
fn edges_used(planner: &dyn RoutePlanner, problem: &RouteProblem<'_>) -> Result<EdgeSet, String> {
    let network = problem.network;
    let route = plan(planner, 300, problem)?.best;
    let used = route.legs().filter_map(|(a, b)| network.arc_between(a, b));
    Ok(used.map(|arc| network.arcs()[arc.index()].edge).collect())
}

fn changed_times_are_honoured(planner: &dyn RoutePlanner) -> CheckResult {
    let drawn = drawn_network(2, 20, 0.6, true)?;
    let problem = drawn.problem();
    let used = edges_used(planner, &problem)?;
    let arcs = drawn.network.arcs();
    let uneven: Vec<_> = (0..)
        .zip(arcs)
        .map(|(i, arc)| arc.time_s * f64::from(1 + i % 2))
        .collect();
    let closed: Vec<_> = arcs
        .iter()
        .map(|arc| {
            if used.contains(arc.edge) {
                f64::INFINITY
            } else {
                arc.time_s
            }
        })
        .collect();
    for times in [uneven, closed] {
        let changed = RouteProblem {
            times: Some(&times),
            ..problem
        };
        is_as_claimed(&changed, &plan(planner, 300, &changed)?)?;
    }
    Ok(())
}

fn incumbent_is_kept(planner: &dyn RoutePlanner) -> CheckResult {
    for seed in 0..5 {
        let drawn = drawn_network(200 + seed, 25, 0.5, seed % 2 == 0)?;
        let problem = drawn.problem();
        let candidates = [
            plan(planner, 2_000, &problem)?,
            plan(&GreedyRoute, 1, &problem)?,
        ];
        for good in candidates.iter().filter(|plan| plan.violation == 0.0) {
            let problem = RouteProblem {
                incumbent: Some(&good.best),
                ..problem
            };
            let again = plan(planner, 1, &problem)?;
            is_as_claimed(&problem, &again)?;
            let no_worse = Score::feasible(good.cost + 1e-12 * good.cost.abs());
            ensure(again.score() <= no_worse, || {
                format!(
                    "cost {} and violation {} after an incumbent of cost {}",
                    again.cost, again.violation, good.cost
                )
            })?;
        }
    }
    Ok(())
}

fn start_may_be_destination(planner: &dyn RoutePlanner) -> CheckResult {
    let drawn = drawn_network(3, 10, 0.6, false)?;
    let problem = RouteProblem::new(&drawn.network, NodeId(4), NodeId(4), 0.0);
    let plan = plan(planner, 10, &problem)?;
    ensure(plan.best.nodes() == [NodeId(4)], || {
        format!("plans {:?}", plan.best)
    })?;
    is_as_claimed(&problem, &plan)
}

fn tiny_networks_are_solved(planner: &dyn RoutePlanner) -> CheckResult {
    let places = [0.0, 300.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 0.0)));
    let edge = [Edge::directed(0, 1, Task::TRANSIT)];
    for (count, edges) in [(1, &edge[..0]), (2, &edge[..])] {
        let network = Network::new(&places[..count], edges, 3.0).map_err(|e| e.to_string())?;
        let destination = NodeId(count as u32 - 1);
        let problem = RouteProblem::new(&network, NodeId(0), destination, 100.0);
        for evaluations in [1, 100] {
            // Another than the only route is not valid.
            is_as_claimed(&problem, &plan(planner, evaluations, &problem)?)?;
        }
    }
    Ok(())
}

fn unreachable_is_an_error(planner: &dyn RoutePlanner) -> CheckResult {
    let places = [0.0, 300.0, 600.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 0.0)));
    let edges = [
        Edge::undirected(0, 1, Task::TRANSIT),
        Edge::directed(2, 1, Task::TRANSIT),
    ];
    let network = Network::new(&places, &edges, 3.0).map_err(|e| e.to_string())?;
    let problem = RouteProblem::new(&network, NodeId(0), NodeId(2), 1e6);
    match planner.plan_route(&mut run(100), &problem) {
        Err(PlanError::Unreachable {
            start: 0,
            destination: 2,
        }) => Ok(()),
        other => Err(format!("gives {other:?}")),
    }
}

fn too_little_time_gives_quickest(planner: &dyn RoutePlanner) -> CheckResult {
    for seed in 0..4 {
        let drawn = drawn_network(300 + seed, 15, 0.5, seed % 2 == 0)?;
        let (_, quickest) = drawn.problem().quickest().map_err(|e| e.to_string())?;
        for time_available_s in [quickest.time_s * 0.9, quickest.time_s * 0.1, 0.0] {
            let problem = RouteProblem {
                time_available_s,
                ..drawn.problem()
            };
            let plan = plan(planner, 200, &problem)?;
            is_as_claimed(&problem, &plan)?;
            let time_s = verify_route(&problem, &plan.best).time_s;
            ensure(
                plan.violation > 0.0 && time_s <= quickest.time_s * (1.0 + 1e-12),
                || {
                    format!(
                        "takes {time_s} s where the quickest takes {} s",
                        quickest.time_s
                    )
                },
            )?;
        }
        // Just enough time is enough.
        let problem = RouteProblem {
            time_available_s: quickest.time_s * (1.0 + 1e-12),
            ..drawn.problem()
        };
        let plan = plan(planner, 200, &problem)?;
        is_as_claimed(&problem, &plan)?;
        ensure(plan.violation == 0.0, || {
            "misses the quickest route, which just fits".into()
        })?;
    }
    Ok(())
}

fn malformed_is_refused(planner: &dyn RoutePlanner) -> CheckResult {
    let drawn = drawn_network(4, 6, 1.0, false)?;
    let problem = drawn.problem();
    let times = vec![f64::NAN; drawn.network.arcs().len()];
    let [no_time, negative_time] = [f64::NAN, -5.0].map(|time_available_s| RouteProblem {
        time_available_s,
        ..problem
    });
    let all_times = RouteProblem {
        times: Some(&times),
        ..problem
    };
    let one_time = RouteProblem {
        times: Some(&times[..1]),
        ..problem
    };
    let start = RouteProblem {
        start: NodeId(77),
        ..problem
    };
    for (what, problem) in [
        ("time", no_time),
        ("negative time", negative_time),
        ("times", all_times),
        ("times of one arc", one_time),
        ("start", start),
    ] {
        match planner.plan_route(&mut run(50), &problem) {
            Err(PlanError::Invalid(_)) => {}
            other => return Err(format!("malformed {what}: gives {other:?}")),
        }
    }
    Ok(())
}
