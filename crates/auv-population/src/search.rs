//! The loop that GA, ICA and PSO share.

use crate::Workers;
use auv_planning::{Run, StopReason};

/// Where a population stands after a generation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing<'a> {
    /// Cost of the best member so far.
    pub best_cost: f64,
    /// Violation of the best member so far (0: feasible).
    pub best_violation: f64,
    /// Costs of all members, by index.
    pub costs: &'a [f64],
    /// Violations of all members, by index.
    pub violations: &'a [f64],
}

/// A population-based search, one generation at a time: ask serially, evaluate in bulk, select
/// serially.
pub trait Search {
    /// Draws the next members; returns how many have to be evaluated. Serial: all randomness that is
    /// not a member's own stream is used here.
    fn propose(&mut self) -> u64;

    /// Evaluates the first `granted` members proposed, on all workers, results in place.
    fn evaluate(&mut self, granted: u64, workers: &Workers);

    /// Takes the first `granted` members into the population; returns why the search is over, if
    /// it is (its own cap, stall or convergence).
    fn select(&mut self, granted: u64) -> Option<StopReason>;

    /// Where the population stands.
    fn standing(&self) -> Standing<'_>;
}

/// Runs generations until the run or the search itself ends.
///
/// Evaluations are granted before each parallel section, by index, so any budget holds exactly.
pub fn search<S: Search + ?Sized>(
    run: &mut Run<'_>,
    workers: &Workers,
    population: &mut S,
) -> StopReason {
    workers.awake(|| generations(run, workers, population))
}

fn generations<S: Search + ?Sized>(
    run: &mut Run<'_>,
    workers: &Workers,
    population: &mut S,
) -> StopReason {
    loop {
        let proposed = population.propose();
        let granted = run.grant(proposed);
        if granted == 0 && proposed > 0 {
            return run.stats(StopReason::Finished).stop;
        }
        population.evaluate(granted, workers);
        let own_reason = population.select(granted);
        let standing = population.standing();
        run.end_generation(
            (standing.best_cost, standing.best_violation),
            standing.costs,
            standing.violations,
        );
        if let Some(reason) = own_reason {
            return reason;
        }
        if run.should_stop() {
            return run.stats(StopReason::Finished).stop;
        }
    }
}
