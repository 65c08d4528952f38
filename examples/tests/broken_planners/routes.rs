//! Faults of route planners. Each is the default planner with its problem or its plan spoilt.

use super::faulty::Faulty;
use super::{assert_caught, assert_harmless, pause};
use auv_ga_route::GaRoute;
use auv_graph::Route;
use auv_planning::baseline::GreedyRoute;
use auv_planning::{PlanError, Planned, RoutePlanner, RouteProblem, Run};
use auv_pso_path::PsoPath;
use auv_verify::conformance;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

type Answer = Result<Planned<Route>, PlanError>;

fn sound(run: &mut Run<'_>, problem: &RouteProblem<'_>) -> Answer {
    GaRoute::default().plan_route(run, problem)
}

/// The kit catches the fault, and a mission flown with it hits nothing.
fn caught(check: &str, fault: impl Fn(&mut Run<'_>, &RouteProblem<'_>) -> Answer + Send + Sync) {
    let planner = Faulty(fault);
    assert_caught(conformance::route_planner(&planner), check);
    assert_harmless(&planner, &PsoPath::default(), check);
}

/// The default planner whose every plan is changed.
fn caught_in_plans(check: &str, spoil: impl Fn(&mut Planned<Route>) + Send + Sync) {
    caught(check, |run, problem| {
        let mut plan = sound(run, problem)?;
        spoil(&mut plan);
        Ok(plan)
    });
}

#[test]
fn a_panic() {
    caught("start and destination may be one node", |run, problem| {
        assert!(problem.start != problem.destination, "on purpose");
        sound(run, problem)
    });
}

#[test]
fn a_hang() {
    let planner = Arc::new(Faulty(|run: &mut Run<'_>, problem: &RouteProblem<'_>| {
        while problem.incumbent.is_some() {
            pause(50);
        }
        sound(run, problem)
    }));
    let outcome = conformance::route_planner_within(planner, Duration::from_secs(8));
    assert_caught(outcome, "an incumbent is never made worse");
}

#[test]
fn a_cost_or_violation_that_is_nan() {
    caught_in_plans("cost and violation are finite", |plan| plan.cost = f64::NAN);
    caught_in_plans("cost and violation are finite", |plan| {
        plan.violation = f64::NAN
    });
}

#[test]
fn an_answer_long_after_the_deadline() {
    let late = Faulty(|run: &mut Run<'_>, problem: &RouteProblem<'_>| {
        if run.has_deadline() {
            pause(3_200);
        }
        sound(run, problem)
    });
    let outcome = conformance::route_planner(&late);
    assert_caught(outcome, "a run ends soon after its deadline");
}

#[test]
fn a_seed_of_its_own() {
    let calls = AtomicU64::new(0);
    caught("same seed and budget give the same bits", |run, problem| {
        let index = calls.fetch_add(1, Ordering::Relaxed);
        run.stage(index, None, |run| sound(run, problem))
    });
}

#[test]
fn a_number_shared_by_calls_at_the_same_time() {
    let under_way = AtomicU64::new(0);
    caught("calls at the same time change nothing", |run, problem| {
        under_way.fetch_add(1, Ordering::SeqCst);
        pause(2);
        let plan = sound(run, problem);
        let others = under_way.fetch_sub(1, Ordering::SeqCst) - 1;
        let mut plan = plan?;
        plan.cost += 1e-9 * others as f64;
        Ok(plan)
    });
}

#[test]
fn the_answer_before() {
    let last = std::sync::Mutex::new((0_usize, 0_u64));
    caught(
        "another problem in between changes nothing",
        |run, problem| {
            let mut plan = sound(run, problem)?;
            let mut last = last.lock().unwrap();
            if last.0 != problem.network.num_nodes() {
                *last = (problem.network.num_nodes(), last.1 + 1);
            }
            plan.cost += 1e-9 * last.1 as f64;
            Ok(plan)
        },
    );
}

#[test]
fn removed_edges_and_changed_times_not_looked_at() {
    caught("removed edges are not used", |run, problem| {
        let whole = RouteProblem::new(
            problem.network,
            problem.start,
            problem.destination,
            problem.time_available_s,
        );
        sound(
            run,
            &RouteProblem {
                removed: whole.removed,
                ..*problem
            },
        )
    });
    caught("changed times are honoured", |run, problem| {
        sound(
            run,
            &RouteProblem {
                times: None,
                ..*problem
            },
        )
    });
}

#[test]
fn plans_worse_than_the_incumbent() {
    caught("an incumbent is never made worse", |run, problem| {
        sound(
            run,
            &RouteProblem {
                incumbent: None,
                ..*problem
            },
        )
    });
}

#[test]
fn wrong_ends_and_late_routes_called_feasible() {
    caught_in_plans("a plan called feasible is", |plan| {
        plan.best = Route::new(plan.best.nodes().iter().rev().copied().collect());
    });
    caught_in_plans("too little time gives the quickest route", |plan| {
        plan.violation = 0.0;
    });
}

#[test]
fn more_evaluations_than_granted() {
    caught_in_plans("the evaluation budget is exact", |plan| {
        plan.stats.evaluations += 1;
    });
}

#[test]
fn another_plan_for_each_number_of_threads() {
    let greedy: &dyn RoutePlanner = &GreedyRoute;
    let ga = GaRoute::default();
    let check = "the number of threads changes nothing";
    assert_caught(conformance::routes_on_threads(&[greedy, &ga]), check);
    assert!(conformance::routes_on_threads(&[&ga, &ga]).is_ok());
}
