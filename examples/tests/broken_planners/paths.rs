//! Faults of path planners. Each is the default planner with its problem or its plan spoilt.

use super::faulty::Faulty;
use super::misread::MISREAD;
use super::{assert_caught, assert_harmless, pause};
use auv_ga_route::GaRoute;
use auv_planning::{PathPlanner, PathProblem, PlanError, Planned, Run, Trajectory};
use auv_pso_path::PsoPath;
use auv_types::Seed;
use auv_verify::conformance;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

type Answer = Result<Planned<Trajectory>, PlanError>;

fn sound(run: &mut Run<'_>, problem: &PathProblem<'_>) -> Answer {
    PsoPath::default().plan_path(run, problem)
}

/// The kit catches the fault, and a mission flown with it hits nothing.
fn caught(check: &str, fault: impl Fn(&mut Run<'_>, &PathProblem<'_>) -> Answer + Send + Sync) {
    let planner = Faulty(fault);
    assert_caught(conformance::path_planner(&planner), check);
    assert_harmless(&GaRoute::default(), &planner, check);
}

/// The default planner whose every plan is changed.
fn caught_in_plans(
    check: &str,
    spoil: impl Fn(&mut Planned<Trajectory>, &PathProblem<'_>) + Send + Sync,
) {
    caught(check, |run, problem| {
        let mut plan = sound(run, problem)?;
        spoil(&mut plan, problem);
        Ok(plan)
    });
}

#[test]
fn the_sound_planner_complies_and_ends() {
    let planner = Arc::new(Faulty(sound));
    let outcome = conformance::path_planner_within(planner, Duration::from_secs(60));
    assert!(outcome.is_ok(), "{}", outcome.unwrap_err());
}

#[test]
fn a_panic() {
    caught("start and target may be one place", |run, problem| {
        assert!(problem.start != problem.target, "on purpose");
        sound(run, problem)
    });
}

#[test]
fn a_hang() {
    let planner = Arc::new(Faulty(|run: &mut Run<'_>, problem: &PathProblem<'_>| {
        while problem.warm_start.is_some() {
            pause(50);
        }
        sound(run, problem)
    }));
    let outcome = conformance::path_planner_within(planner, Duration::from_secs(8));
    assert_caught(outcome, "a warm start does no harm");
}

#[test]
fn a_cost_or_violation_that_is_nan() {
    caught_in_plans("cost and violation are finite", |plan, _| {
        plan.cost = f64::NAN
    });
    caught_in_plans("cost and violation are finite", |plan, _| {
        plan.violation = f64::NAN;
    });
}

#[test]
fn an_answer_long_after_the_deadline() {
    let late = Faulty(|run: &mut Run<'_>, problem: &PathProblem<'_>| {
        if run.has_deadline() {
            pause(3_200);
        }
        sound(run, problem)
    });
    let outcome = conformance::path_planner(&late);
    assert_caught(outcome, "a run ends soon after its deadline");
}

#[test]
fn another_answer_at_each_call() {
    let calls = AtomicU64::new(0);
    caught("same seed and budget give the same bits", |run, problem| {
        let mut plan = sound(run, problem)?;
        plan.cost += 1e-9 * calls.fetch_add(1, Ordering::Relaxed) as f64;
        Ok(plan)
    });
}

#[test]
fn a_seed_of_its_own_that_moves_on_with_each_problem() {
    // The same problem twice in a row gives the same plan: only another one in between shows it.
    let last = std::sync::Mutex::new((0_usize, 0_u64));
    caught(
        "another problem in between changes nothing",
        |run, problem| {
            let mut plan = sound(run, problem)?;
            let mut last = last.lock().unwrap();
            if last.0 != problem.regions.len() {
                *last = (problem.regions.len(), last.1 + 1);
            }
            plan.cost += 1e-9 * last.1 as f64;
            Ok(plan)
        },
    );
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
fn more_evaluations_than_granted() {
    caught_in_plans("the evaluation budget is exact", |plan, _| {
        plan.stats.evaluations += 1;
    });
}

#[test]
fn wrong_ends() {
    caught_in_plans("a plan leads from start to target", |plan, problem| {
        let away = PathProblem {
            target: problem.target + (problem.start - problem.target) * 0.1,
            regions: &[],
            ..*problem
        };
        if let Ok(short) = away.timed(&[away.start, away.target]) {
            plan.best = short;
        }
    });
}

/// Every third of the misread problems from one on.
fn misread(from: usize) {
    for (check, misread) in MISREAD.into_iter().skip(from).step_by(3) {
        caught(check, move |run, problem| {
            misread(&PsoPath::default(), run, problem)
        });
    }
}

#[test]
fn a_problem_misread_1() {
    misread(0);
}

#[test]
fn a_problem_misread_2() {
    misread(1);
}

#[test]
fn a_problem_misread_3() {
    misread(2);
}

#[test]
fn another_plan_for_each_number_of_threads() {
    let on = |threads: f64| {
        Faulty(move |run: &mut Run<'_>, problem: &PathProblem<'_>| {
            let mut plan = sound(run, problem)?;
            plan.cost += 1e-9 * threads;
            Ok(plan)
        })
    };
    let (one, two) = (on(1.0), on(2.0));
    let check = "the number of threads changes nothing";
    assert_caught(conformance::paths_on_threads(&[&one, &two]), check);
    let again = on(1.0);
    assert!(conformance::paths_on_threads(&[&one, &again]).is_ok());
    let seeded = Faulty(|run: &mut Run<'_>, problem: &PathProblem<'_>| {
        sound(
            &mut Run::new(Seed(run.seed().0 + 1), run_budget(run)),
            problem,
        )
    });
    assert_caught(
        conformance::path_planner(&seeded),
        "the evaluation budget is exact",
    );
}

fn run_budget(run: &Run<'_>) -> auv_planning::Budget {
    run.evaluations_left().map_or_else(
        auv_planning::Budget::to_the_cap,
        auv_planning::Budget::evaluations,
    )
}
