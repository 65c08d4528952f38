//! The kit any planner must pass, also your own: call it in a test of your planner's crate.
//!
//! ```
//! use auv_planning::baseline::{GreedyRoute, StraightPath};
//!
//! auv_verify::conformance::route_planner(&GreedyRoute)?;
//! auv_verify::conformance::path_planner(&StraightPath)?;
//! # Ok::<(), auv_verify::conformance::Failures>(())
//! ```
//!
//! Nothing is timed: a planner that ignores its deadline makes the kit hang. A planner that
//! panics fails the check it panics in.

mod path;
mod route;

pub use path::path_planner;
pub use route::route_planner;

use auv_planning::{Budget, PlanError, Planned, Run, StopReason};
use auv_types::Seed;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// One check that a planner failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// The claim that does not hold.
    pub check: &'static str,
    /// What happened instead.
    pub reason: String,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.check, self.reason)
    }
}

/// All checks that a planner failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failures(pub Vec<Failure>);

impl fmt::Display for Failures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, failure) in self.0.iter().enumerate() {
            let separator = if i == 0 { "" } else { "\n" };
            write!(f, "{separator}{failure}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Failures {}

type Outcome = Result<(), String>;
type Check<'a> = (&'static str, &'a dyn Fn() -> Outcome);

fn run_all(checks: &[Check<'_>]) -> Result<(), Failures> {
    let failures: Vec<_> = checks
        .iter()
        .filter_map(|&(check, claim)| {
            let outcome = catch_unwind(AssertUnwindSafe(claim));
            let reason = outcome
                .unwrap_or_else(|_| Err("the planner panics".into()))
                .err()?;
            Some(Failure { check, reason })
        })
        .collect();
    if failures.is_empty() {
        Ok(())
    } else {
        Err(Failures(failures))
    }
}

fn ensure(holds: bool, otherwise: impl FnOnce() -> String) -> Outcome {
    if holds { Ok(()) } else { Err(otherwise()) }
}

/// One planning call on a fixed problem.
type Plan<'a, T> = &'a dyn Fn(&mut Run<'_>) -> Result<Planned<T>, PlanError>;

fn planned<T>(plan: Plan<'_, T>, run: &mut Run<'_>) -> Result<Planned<T>, String> {
    plan(run).map_err(|error| format!("gives an error for a sound problem: {error}"))
}

/// Same seed and same evaluation budget, same bits.
fn is_deterministic<T: PartialEq + fmt::Debug>(plan: Plan<'_, T>) -> Outcome {
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

/// Never more evaluations than granted, exactly as many where they are what ended the run, and the
/// same number in the answer as in the run.
fn keeps_the_budget<T>(plan: Plan<'_, T>) -> Outcome {
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

/// Cancelled before it begins, it still gives a plan and says why it ended.
fn gives_a_plan_when_cancelled<T>(plan: Plan<'_, T>) -> Outcome {
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

/// Cancelled after the first generation, it ends within the next.
fn ends_soon_when_cancelled<T>(plan: Plan<'_, T>) -> Outcome {
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

/// Without any time it still gives a plan.
fn gives_a_plan_without_time<T>(plan: Plan<'_, T>) -> Outcome {
    let mut run = Run::new(Seed(7), Budget::wall_time(Duration::ZERO));
    let stats = planned(plan, &mut run)?.stats;
    ensure(stats.evaluations == 0, || {
        format!(
            "spends {} evaluations after its deadline",
            stats.evaluations
        )
    })
}

/// Cost and violation are finite, the violation is not negative.
fn figures_are_sound<T>(plan: &Planned<T>) -> Outcome {
    let is_sound = plan.cost.is_finite() && plan.violation.is_finite() && plan.violation >= 0.0;
    ensure(is_sound, || {
        format!("gives cost {} and violation {}", plan.cost, plan.violation)
    })
}
