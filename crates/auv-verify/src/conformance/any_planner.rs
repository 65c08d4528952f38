//! Checks that routes' and paths' planners have in common.

use super::checks::{CheckResult, ensure};
use auv_planning::{Budget, PlanError, Planned, Run, StopReason};
use auv_types::Seed;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// One planning call on a fixed problem.
pub(super) type PlanCall<'a, T> = &'a dyn Fn(&mut Run<'_>) -> Result<Planned<T>, PlanError>;

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
pub(super) fn gives_a_plan_when_cancelled<T>(plan: PlanCall<'_, T>) -> CheckResult {
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
pub(super) fn ends_soon_when_cancelled<T>(plan: PlanCall<'_, T>) -> CheckResult {
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
pub(super) fn gives_a_plan_without_time<T>(plan: PlanCall<'_, T>) -> CheckResult {
    let mut run = Run::new(Seed(7), Budget::wall_time(Duration::ZERO));
    let stats = planned(plan, &mut run)?.stats;
    ensure(stats.evaluations == 0, || {
        format!(
            "spends {} evaluations after its deadline",
            stats.evaluations
        )
    })
}

/// Cost and violation are finite; the violation is not negative.
pub(super) fn figures_are_sound<T>(plan: &Planned<T>) -> CheckResult {
    let is_sound = plan.cost.is_finite() && plan.violation.is_finite() && plan.violation >= 0.0;
    ensure(is_sound, || {
        format!("gives cost {} and violation {}", plan.cost, plan.violation)
    })
}
