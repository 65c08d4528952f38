//! Checks that routes' and paths' planners have in common.

use super::checks::{CheckResult, FailedCheck, ensure, run_all};
use auv_planning::{Budget, PlanError, Planned, Run, StopReason};
use auv_types::Seed;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// One planning call on a fixed problem.
type PlanCall<'a, T> = &'a dyn Fn(&mut Run<'_>) -> Result<Planned<T>, PlanError>;

/// One planning call that several threads may make at once.
type SharedCall<'a, T> = &'a (dyn Fn(&mut Run<'_>) -> Result<Planned<T>, PlanError> + Sync);

/// All checks of this file, on two problems of the same kind.
pub(super) fn checks_of_any_planner<T: PartialEq + fmt::Debug + Send>(
    began: &dyn Fn(&'static str),
    easy: SharedCall<'_, T>,
    hard: SharedCall<'_, T>,
) -> Vec<FailedCheck> {
    run_all(
        began,
        &[
            ("same seed and budget give the same bits", &|| {
                is_deterministic(easy)?;
                is_deterministic(hard)
            }),
            ("another problem in between changes nothing", &|| {
                keeps_no_state(hard, easy)
            }),
            ("calls at the same time change nothing", &|| {
                may_be_called_at_once(hard)
            }),
            ("the evaluation budget is exact", &|| keeps_the_budget(easy)),
            ("cost and violation are finite", &|| {
                figures_are_always_sound(easy)
            }),
            ("a cancelled run gives a plan", &|| {
                gives_a_plan_when_cancelled(easy)
            }),
            ("a run ends soon after it is cancelled", &|| {
                ends_soon_when_cancelled(easy)
            }),
            ("a run ends soon after its deadline", &|| {
                ends_soon_after_its_deadline(hard)
            }),
            ("a run without time gives a plan", &|| {
                gives_a_plan_without_time(easy)
            }),
        ],
    )
}

fn planned<T>(plan: PlanCall<'_, T>, run: &mut Run<'_>) -> Result<Planned<T>, String> {
    plan(run).map_err(|error| format!("gives an error for a sound problem: {error}"))
}

/// Same seed and evaluation budget give the same bits.
pub(super) fn is_deterministic<T: PartialEq + fmt::Debug>(plan: PlanCall<'_, T>) -> CheckResult {
    for (seed, evaluations) in [(1, 1), (2, 40), (3, 500)] {
        let budget = Budget::evaluations(evaluations);
        let [a, b] = [(); 2].map(|()| planned(plan, &mut Run::new(Seed(seed), budget)));
        let (a, b) = (a?, b?);
        let bits = |p: &Planned<T>| (p.cost.to_bits(), p.violation.to_bits());
        ensure(a == b && bits(&a) == bits(&b), || {
            format!("seed {seed}, {evaluations} evaluations give different plans: {a:?} and {b:?}")
        })?;
    }
    Ok(())
}

/// Another call in between changes nothing: a planner keeps no state.
fn keeps_no_state<T: PartialEq + fmt::Debug>(
    plan: PlanCall<'_, T>,
    other: PlanCall<'_, T>,
) -> CheckResult {
    let budget = Budget::evaluations(60);
    let first = planned(plan, &mut Run::new(Seed(8), budget))?;
    let _ = planned(other, &mut Run::new(Seed(9), budget))?;
    let again = planned(plan, &mut Run::new(Seed(8), budget))?;
    ensure(first == again, || {
        format!("after another problem the plan is {again:?} instead of {first:?}")
    })
}

/// Calls at the same time give what they give one after the other.
fn may_be_called_at_once<T: PartialEq + fmt::Debug + Send>(plan: SharedCall<'_, T>) -> CheckResult {
    let call = |seed| planned(plan, &mut Run::new(Seed(seed), Budget::evaluations(60)));
    let at_once = std::thread::scope(|scope| {
        let calls = [0, 1, 2, 3].map(|seed| scope.spawn(move || call(seed)));
        calls.map(|call| call.join().unwrap_or_else(|_| Err("panics".into())))
    });
    for (seed, plan) in (0..).zip(at_once) {
        let (together, alone) = (plan?, call(seed)?);
        ensure(together == alone, || {
            format!("among other calls seed {seed} gives {together:?}, alone {alone:?}")
        })?;
    }
    Ok(())
}

/// The planner ends soon after its deadline of 20 ms: [`SOON_S`] leave room for a busy machine.
fn ends_soon_after_its_deadline<T>(plan: PlanCall<'_, T>) -> CheckResult {
    let mut limit = Run::new(Seed(0), Budget::wall_time(Duration::from_secs(SOON_S)));
    let deadline = Budget::wall_time(Duration::from_millis(20));
    let _ = planned(plan, &mut Run::new(Seed(10), deadline))?;
    ensure(!limit.should_stop(), || {
        format!("takes more than {SOON_S} s with a deadline of 20 ms")
    })
}

/// A planner that ends this long after its deadline is late, seconds.
const SOON_S: u64 = 3;

/// The planner spends no more evaluations than granted, exactly as many when that ended the run, and
/// reports the number that the run counted.
pub(super) fn keeps_the_budget<T>(plan: PlanCall<'_, T>) -> CheckResult {
    for evaluations in [1, 2, 3, 7, 50, 151, 1_000] {
        let mut run = Run::new(Seed(4), Budget::evaluations(evaluations));
        let stats = planned(plan, &mut run)?.stats;
        let spent = run.stats(stats.stop).evaluations;
        ensure(stats.evaluations == spent && spent <= evaluations, || {
            format!(
                "of {evaluations} evaluations {spent} were spent and {} reported",
                stats.evaluations
            )
        })?;
        let is_spent = stats.stop != StopReason::EvaluationsSpent || spent == evaluations;
        ensure(is_spent, || {
            format!("says that {evaluations} evaluations are spent after {spent}")
        })?;
        ensure(stats.stop.is_reproducible(), || {
            format!(
                "says it was stopped by {} in a run without deadline",
                stats.stop.as_str()
            )
        })?;
    }
    Ok(())
}

/// Cancelled before it starts, the planner still gives a plan and says why it ended.
fn gives_a_plan_when_cancelled<T>(plan: PlanCall<'_, T>) -> CheckResult {
    let flag = AtomicBool::new(true);
    let mut run = Run::new(Seed(5), Budget::to_the_cap()).with_cancel(&flag);
    let stats = planned(plan, &mut run)?.stats;
    ensure(
        stats.evaluations == 0 && stats.stop == StopReason::Cancelled,
        || {
            format!(
                "cancelled beforehand it spends {} evaluations and stops as {}",
                stats.evaluations,
                stats.stop.as_str()
            )
        },
    )
}

/// Cancelled after the first generation, the planner ends within the next.
fn ends_soon_when_cancelled<T>(plan: PlanCall<'_, T>) -> CheckResult {
    let flag = AtomicBool::new(false);
    let mut observer = |_: &auv_planning::Generation<'_>| flag.store(true, Ordering::Relaxed);
    let mut run = Run::new(Seed(6), Budget::to_the_cap())
        .with_cancel(&flag)
        .with_observer(&mut observer);
    let stats = planned(plan, &mut run)?.stats;
    ensure(stats.generations <= 2, || {
        format!(
            "goes on for {} generations after it was cancelled",
            stats.generations
        )
    })
}

/// Without any time the planner still gives a plan.
fn gives_a_plan_without_time<T>(plan: PlanCall<'_, T>) -> CheckResult {
    let mut run = Run::new(Seed(7), Budget::wall_time(Duration::ZERO));
    let stats = planned(plan, &mut run)?.stats;
    ensure(stats.evaluations == 0, || {
        format!(
            "spends {} evaluations after its deadline",
            stats.evaluations
        )
    })
}

/// Whatever the budget, cost and violation are finite and the violation is not negative.
fn figures_are_always_sound<T>(plan: PlanCall<'_, T>) -> CheckResult {
    for evaluations in [1, 30, 300] {
        let budget = Budget::evaluations(evaluations);
        figures_are_sound(&planned(plan, &mut Run::new(Seed(13), budget))?)?;
    }
    Ok(())
}

/// Cost and violation are finite; the violation is not negative.
pub(super) fn figures_are_sound<T>(plan: &Planned<T>) -> CheckResult {
    let is_sound = plan.cost.is_finite() && plan.violation.is_finite() && plan.violation >= 0.0;
    ensure(is_sound, || {
        format!("gives cost {} and violation {}", plan.cost, plan.violation)
    })
}
