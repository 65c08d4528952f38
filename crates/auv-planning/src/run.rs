//! One planning call's seed, budget, deadline and observer.

use crate::{Budget, Score, Stats, StopReason};
use auv_types::Seed;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// What an observer is given once a generation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Generation<'a> {
    /// Number of the generation, from 0.
    pub index: u64,
    /// Evaluations granted so far.
    pub evaluations: u64,
    /// The best plan so far.
    pub best: Score,
    /// Costs of the whole population by index; may be empty.
    pub costs: &'a [f64],
    /// Violations of the whole population by index; may be empty.
    pub violations: &'a [f64],
}

/// A stop condition that any thread may check inside a long step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deadline<'a> {
    instant: Option<Instant>,
    cancel: Option<&'a AtomicBool>,
}

impl Deadline<'_> {
    /// Whether to stop now; never true in a run without wall time or cancel flag.
    #[must_use]
    #[allow(
        clippy::disallowed_methods,
        reason = "Run is one of the two places that read a clock, only to stop"
    )]
    pub fn passed(&self) -> bool {
        self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
            || self
                .instant
                .is_some_and(|instant| Instant::now() >= instant)
    }
}

type Observer<'a> = dyn FnMut(&Generation<'_>) + Send + 'a;

/// One planning call: seed, budget, deadline, cancel flag, observer.
///
/// [`Run::grant`] grants evaluations serially, before any parallel section, so a budget smaller than
/// the population holds as well.
pub struct Run<'a> {
    seed: Seed,
    evaluations_left: Option<u64>,
    target_cost: Option<f64>,
    deadline: Deadline<'a>,
    observer: Option<&'a mut Observer<'a>>,
    evaluations: u64,
    generations: u64,
    stop: Option<StopReason>,
}

impl fmt::Debug for Run<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Run")
            .field("seed", &self.seed)
            .field("evaluations", &self.evaluations)
            .field("evaluations_left", &self.evaluations_left)
            .field("generations", &self.generations)
            .field("stop", &self.stop)
            .finish_non_exhaustive()
    }
}

impl<'a> Run<'a> {
    /// A run whose clock starts now.
    #[must_use]
    #[allow(
        clippy::disallowed_methods,
        reason = "Run is one of the two places that read a clock, only to stop"
    )]
    pub fn new(seed: Seed, budget: Budget) -> Self {
        Self::started_at(seed, budget, Instant::now())
    }

    /// A run whose clock started earlier, so that setting up the problem counts.
    #[must_use]
    pub fn started_at(seed: Seed, budget: Budget, started: Instant) -> Self {
        Self {
            seed,
            evaluations_left: budget.evaluations,
            target_cost: budget.target_cost,
            deadline: Deadline {
                instant: budget.wall_time.and_then(|t| started.checked_add(t)),
                cancel: None,
            },
            observer: None,
            evaluations: 0,
            generations: 0,
            stop: None,
        }
    }

    /// Stops as soon as `flag` becomes true.
    #[must_use]
    pub fn with_cancel(mut self, flag: &'a AtomicBool) -> Self {
        self.deadline.cancel = Some(flag);
        self
    }

    /// Calls `observer` once a generation.
    #[must_use]
    pub fn with_observer(mut self, observer: &'a mut Observer<'a>) -> Self {
        self.observer = Some(observer);
        self
    }

    /// The seed of everything random in this run.
    #[must_use]
    pub fn seed(&self) -> Seed {
        self.seed
    }

    /// The stop condition to check inside long steps, from any thread.
    #[must_use]
    pub fn deadline(&self) -> Deadline<'a> {
        self.deadline
    }

    /// Whether the wall time is limited. Then an anytime planner goes on after its iteration cap.
    #[must_use]
    pub fn has_deadline(&self) -> bool {
        self.deadline.instant.is_some()
    }

    /// Evaluations left, if they are limited.
    #[must_use]
    pub fn evaluations_left(&self) -> Option<u64> {
        self.evaluations_left
    }

    /// Grants up to `wanted` evaluations; 0 (for `wanted > 0`) means stop. The caller evaluates the
    /// first `n` members of its population by index, so the result does not depend on threads.
    pub fn grant(&mut self, wanted: u64) -> u64 {
        if self.should_stop() {
            return 0;
        }
        let granted = self
            .evaluations_left
            .map_or(wanted, |left| left.min(wanted));
        if granted < wanted {
            self.stop = Some(StopReason::EvaluationsSpent);
        }
        self.evaluations_left = self.evaluations_left.map(|left| left - granted);
        self.evaluations += granted;
        granted
    }

    /// Whether the run has to end: evaluations spent, deadline passed, cancelled or target reached.
    pub fn should_stop(&mut self) -> bool {
        if self.stop.is_none() {
            if self.evaluations_left == Some(0) {
                self.stop = Some(StopReason::EvaluationsSpent);
            } else if self.deadline.passed() {
                let cancelled = self
                    .deadline
                    .cancel
                    .is_some_and(|flag| flag.load(Ordering::Relaxed));
                self.stop = Some(if cancelled {
                    StopReason::Cancelled
                } else {
                    StopReason::DeadlinePassed
                });
            }
        }
        self.stop.is_some()
    }

    /// Whether the run has an observer.
    #[must_use]
    pub fn is_observed(&self) -> bool {
        self.observer.is_some()
    }

    /// Ends a generation: counts it, tells the observer, and stops at the target cost.
    pub fn end_generation(&mut self, best: Score, costs: &[f64], violations: &[f64]) {
        if let Some(observer) = &mut self.observer {
            observer(&Generation {
                index: self.generations,
                evaluations: self.evaluations,
                best,
                costs,
                violations,
            });
        }
        self.generations += 1;
        let reached = self
            .target_cost
            .is_some_and(|target| best.is_feasible() && best.cost <= target);
        if reached && self.stop.is_none() {
            self.stop = Some(StopReason::TargetReached);
        }
    }

    /// Runs a step of the planner with at most `evaluations` of those left, a seed of its own and the
    /// same deadline. What the step spends is charged to this run. A step that spends its share does
    /// not stop this run.
    pub fn stage<R>(
        &mut self,
        index: u64,
        evaluations: Option<u64>,
        step: impl FnOnce(&mut Run<'_>) -> R,
    ) -> R {
        let left = match (self.evaluations_left, evaluations) {
            (Some(left), Some(slice)) => Some(left.min(slice)),
            (left, slice) => left.or(slice),
        };
        let mut part = Run {
            seed: self.seed.split(index),
            evaluations_left: left,
            target_cost: None,
            deadline: self.deadline,
            observer: None,
            evaluations: 0,
            generations: 0,
            stop: None,
        };
        let result = step(&mut part);
        self.evaluations += part.evaluations;
        self.evaluations_left = self.evaluations_left.map(|left| left - part.evaluations);
        result
    }

    /// What the run spent and why it ended; `otherwise` is the planner's own reason, used when
    /// nothing outside stopped it.
    #[must_use]
    pub fn stats(&self, otherwise: StopReason) -> Stats {
        Stats {
            evaluations: self.evaluations,
            generations: self.generations,
            stop: self.stop.unwrap_or(otherwise),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn grants_exactly_the_budget_and_charges_stages() {
        let mut run = Run::new(Seed(1), Budget::evaluations(100));
        assert_eq!(run.grant(30), 30);
        let spent = run.stage(0, Some(50), |part| {
            (part.grant(40), part.grant(40), part.grant(1))
        });
        assert_eq!(spent, (40, 10, 0));
        assert_eq!((run.grant(50), run.grant(1)), (20, 0));
        let stats = run.stats(StopReason::Finished);
        assert_eq!(
            (stats.evaluations, stats.stop),
            (100, StopReason::EvaluationsSpent)
        );
    }

    #[test]
    fn cancel_and_deadline_stop_for_different_reasons() {
        let flag = AtomicBool::new(true);
        let mut run = Run::new(Seed(1), Budget::to_the_cap()).with_cancel(&flag);
        assert_eq!(run.grant(1), 0);
        assert_eq!(run.stats(StopReason::Finished).stop, StopReason::Cancelled);
        let mut run = Run::new(Seed(1), Budget::wall_time(Duration::ZERO));
        assert!(run.should_stop());
        assert!(!run.stats(StopReason::Finished).stop.is_reproducible());
    }

    #[test]
    fn stops_at_the_target_cost_once_feasible() {
        let mut run = Run::new(
            Seed(1),
            Budget {
                target_cost: Some(5.0),
                ..Budget::to_the_cap()
            },
        );
        run.end_generation(Score::new(0.1, 4.0), &[], &[]);
        assert!(!run.should_stop());
        run.end_generation(Score::feasible(5.0), &[], &[]);
        assert!(run.should_stop());
    }
}
