//! What any route planner must do.

use super::any_planner::{
    ends_soon_when_cancelled, figures_are_sound, gives_a_plan_when_cancelled,
    gives_a_plan_without_time, is_deterministic, keeps_the_budget,
};
use super::checks::{CheckResult, FailedCheck, FailedChecks, ensure, run_all};
use super::drawn_network::drawn_network;
use super::route_in_time::in_time_or_declined;
use crate::{RouteViolation, verify_route};
use auv_graph::{Edge, EdgeSet, Network, NodeId, Route, Task, Waypoint};
use auv_planning::{
    Budget, PlanError, Planned, RoutePlanner, RouteProblem, Run, Score, baseline::GreedyRoute,
};
use auv_types::{Point3, Seed};

/// Runs all checks on a route planner; a few seconds at most for a planner of 100,000 evaluations
/// a second.
///
/// # Errors
/// Every check that fails, with what happened instead.
pub fn route_planner(planner: &dyn RoutePlanner) -> Result<(), FailedChecks> {
    let drawn = drawn_network(1, 25, 0.5, false).map_err(|reason| {
        FailedChecks(vec![FailedCheck {
            check: "the kit's own network is sound",
            reason,
        }])
    })?;
    let problem = drawn.problem();
    let plan = |run: &mut Run<'_>| planner.plan_route(run, &problem);
    run_all(&[
        ("same seed and budget give the same bits", &|| {
            is_deterministic(&plan)
        }),
        ("the evaluation budget is exact", &|| {
            keeps_the_budget(&plan)
        }),
        ("a cancelled run gives a plan", &|| {
            gives_a_plan_when_cancelled(&plan)
        }),
        ("a run ends soon after it is cancelled", &|| {
            ends_soon_when_cancelled(&plan)
        }),
        ("a run without time gives a plan", &|| {
            gives_a_plan_without_time(&plan)
        }),
        ("a plan called feasible is", &|| plans_are_valid(planner)),
        ("removed edges and changed times are honoured", &|| {
            changes_are_honoured(planner)
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
        ("a NaN is refused", &|| nan_is_refused(planner)),
        ("routes in time are planned or declined", &|| {
            in_time_or_declined(planner)
        }),
    ])
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

fn changes_are_honoured(planner: &dyn RoutePlanner) -> CheckResult {
    let drawn = drawn_network(2, 20, 0.6, true)?;
    let problem = drawn.problem();
    let first = plan(planner, 300, &problem)?.best;
    let used = first
        .legs()
        .filter_map(|(a, b)| drawn.network.arc_between(a, b));
    let removed: EdgeSet = used
        .map(|arc| drawn.network.arcs()[arc.index()].edge)
        .collect();
    let times: Vec<_> = (0..)
        .zip(drawn.network.arcs())
        .map(|(i, arc)| arc.time_s * f64::from(1 + i % 2))
        .collect();
    let changed = RouteProblem {
        removed: &removed,
        times: Some(&times),
        ..problem
    };
    is_as_claimed(&changed, &plan(planner, 300, &changed)?)?;
    let blocked: Vec<_> = drawn
        .network
        .arcs()
        .iter()
        .map(|arc| {
            if removed.contains(arc.edge) {
                f64::INFINITY
            } else {
                arc.time_s
            }
        })
        .collect();
    let blocked = RouteProblem {
        times: Some(&blocked),
        ..problem
    };
    is_as_claimed(&blocked, &plan(planner, 300, &blocked)?)
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
            let plan = plan(planner, evaluations, &problem)?;
            is_as_claimed(&problem, &plan)?;
            ensure(plan.violation == 0.0, || {
                format!("misses the only route of {count} nodes")
            })?;
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
        for time_available_s in [quickest.time_s * 0.9, quickest.time_s * 0.1, 0.0, -5.0] {
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

fn nan_is_refused(planner: &dyn RoutePlanner) -> CheckResult {
    let drawn = drawn_network(4, 6, 1.0, false)?;
    let problem = drawn.problem();
    let times = vec![f64::NAN; drawn.network.arcs().len()];
    let time = RouteProblem {
        time_available_s: f64::NAN,
        ..problem
    };
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
        ("time", time),
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
