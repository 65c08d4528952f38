//! What a population-based planner implements.

use auv_planning::{Score, StopReason};

/// The state of a search after a generation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<'a> {
    /// The best member so far.
    pub best: Score,
    /// Costs of all members by index. May be stale or empty when nobody observes the run.
    pub costs: &'a [f64],
    /// Violations of all members by index, under the same condition.
    pub violations: &'a [f64],
}

/// A population-based search. Each generation proposes members on one thread, evaluates them on all
/// threads, and selects on one thread.
///
/// Tasks write to [`Members`](crate::Members) and to the scratch memory of their thread.
pub trait Search: Send + Sync {
    /// The working memory of one thread.
    type Scratch: Send;

    /// Working memory for one more thread.
    fn scratch(&self) -> Self::Scratch;

    /// Draws the next members and returns how many evaluations they need. All random numbers that do
    /// not come from a member's own stream are drawn here.
    fn propose(&mut self) -> u64;

    /// Prepares the evaluation of the first `granted` members proposed. Returns the number of tasks
    /// that [`work`](Search::work) is called for.
    fn begin(&mut self, granted: u64) -> usize;

    /// Does one task of the evaluation, in any order and on any thread. The result must not depend
    /// on what earlier tasks left in `scratch`; then it does not depend on the number of threads.
    fn work(&self, task: usize, scratch: &mut Self::Scratch);

    /// Takes the first `granted` members into the population. Returns why the search ends, if its
    /// own criteria (iteration cap, stall, convergence) end it.
    fn select(&mut self, granted: u64) -> Option<StopReason>;

    /// The state after a generation. Costs and violations of the members are read only if
    /// `is_observed`.
    fn progress(&mut self, is_observed: bool) -> Progress<'_>;
}
