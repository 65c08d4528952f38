//! The loop that GA, ICA and PSO share.

use crate::Workers;
use crate::crew::Crew;
use crate::workers::Helpers;
use auv_planning::{Run, Score, StopReason};

/// Where a population stands after a generation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing<'a> {
    /// Cost of the best member so far.
    pub best_cost: f64,
    /// Violation of the best member so far (0: feasible).
    pub best_violation: f64,
    /// Costs of all members, by index; stale or none where nobody observes the run.
    pub costs: &'a [f64],
    /// Violations of all members, by index; as the costs.
    pub violations: &'a [f64],
}

/// A population-based search, one generation at a time: ask serially, evaluate in bulk, select
/// serially.
///
/// What tasks write is in [`Members`](crate::Members), and in the room that each thread has.
pub trait Search: Send + Sync {
    /// What a thread needs for itself while it works.
    type Room: Send;

    /// An empty room.
    fn room(&self) -> Self::Room;

    /// Draws the next members; returns how many have to be evaluated. Serial: all randomness that is
    /// not a member's own stream is used here.
    fn propose(&mut self) -> u64;

    /// Prepares the evaluation of the first `granted` members proposed; returns the number of tasks
    /// that [`work`](Search::work) is called for.
    fn begin(&mut self, granted: u64) -> usize;

    /// Does one task of the evaluation, in any order and on any thread. The result must not depend
    /// on what the room holds from other tasks; then it is independent of the number of threads.
    fn work(&self, task: usize, room: &mut Self::Room);

    /// Takes the first `granted` members into the population; returns why the search is over, if
    /// it is (its own cap, stall or convergence).
    fn select(&mut self, granted: u64) -> Option<StopReason>;

    /// Where the population stands; costs and violations of its members are looked at only if it
    /// `is_observed`.
    fn standing(&mut self, is_observed: bool) -> Standing<'_>;
}

/// Runs generations until the run or the search itself ends.
///
/// Evaluations are granted before each parallel section, by index, so any budget holds exactly.
pub fn search<S: Search + ?Sized>(
    run: &mut Run<'_>,
    workers: &Workers,
    population: &mut S,
) -> StopReason {
    let crew = Crew::new(population, workers.threads());
    workers.lend(|helpers| {
        let _dismissal = crew.dismissal();
        generations(run, &crew, helpers)
    })
}

fn generations<'scope, 'a: 'scope, S: Search + ?Sized>(
    run: &mut Run<'_>,
    crew: &'scope Crew<'a, S>,
    helpers: Helpers<'_, 'scope>,
) -> StopReason {
    let mut population = crew.search();
    loop {
        let proposed = population.propose();
        let granted = run.grant(proposed);
        if granted == 0 && proposed > 0 {
            return run.stats(StopReason::Finished).stop;
        }
        let tasks = population.begin(granted);
        drop(population);
        crew.round(tasks, helpers);
        population = crew.search();
        if crew.is_over() {
            // A helper panicked; the caller gets that instead of this.
            return StopReason::Finished;
        }
        let own_reason = population.select(granted);
        let standing = population.standing(run.is_observed());
        run.end_generation(
            Score::new(standing.best_violation, standing.best_cost),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Members;
    use auv_planning::Budget;
    use auv_types::Seed;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread::{self, ThreadId};

    /// Sums of the numbers drawn in each round by each member; room and members tell of mistakes.
    struct Sums {
        members: Members<u64>,
        round: u64,
        rounds: u64,
        mistake: Option<Mistake>,
        has_help: AtomicBool,
        total: u64,
    }

    /// Which threads panic.
    #[derive(Clone, Copy)]
    enum Mistake {
        Anywhere,
        NotOn(ThreadId),
    }

    impl Sums {
        fn of(members: usize, rounds: u64) -> Self {
            Self {
                members: Members::new(members, || 0),
                round: 0,
                rounds,
                mistake: None,
                has_help: AtomicBool::new(false),
                total: 0,
            }
        }
    }

    impl Search for Sums {
        type Room = Vec<u64>;

        fn room(&self) -> Vec<u64> {
            Vec::new()
        }

        fn propose(&mut self) -> u64 {
            self.members.len() as u64
        }

        fn begin(&mut self, granted: u64) -> usize {
            granted as usize
        }

        fn work(&self, task: usize, room: &mut Vec<u64>) {
            match self.mistake {
                Some(Mistake::Anywhere) => panic!("a planner's mistake"),
                Some(Mistake::NotOn(conductor)) => {
                    if conductor != thread::current().id() {
                        self.has_help.store(true, Ordering::Release);
                        panic!("a helper's mistake");
                    }
                    while !self.has_help.load(Ordering::Acquire) {
                        thread::yield_now();
                    }
                }
                None => {}
            }
            room.clear();
            // Uneven work, so that the threads take from each other.
            room.extend((0..(task as u64 * 37) % 400).map(|k| k ^ self.round));
            *self.members.lock(task) +=
                (self.round + 1) * (task as u64 + 1) + room.iter().sum::<u64>();
        }

        fn select(&mut self, _granted: u64) -> Option<StopReason> {
            self.total = self.members.iter_mut().map(|sum| *sum).sum();
            self.round += 1;
            (self.round == self.rounds).then_some(StopReason::Finished)
        }

        fn standing(&mut self, _is_observed: bool) -> Standing<'_> {
            Standing {
                best_cost: 0.0,
                best_violation: 0.0,
                costs: &[],
                violations: &[],
            }
        }
    }

    fn total(members: usize, budget: Budget, workers: &Workers) -> u64 {
        let mut sums = Sums::of(members, 60);
        search(&mut Run::new(Seed(0), budget), workers, &mut sums);
        sums.total
    }

    #[test]
    fn every_task_is_done_once_in_every_round_at_any_thread_count() {
        for members in [0, 1, 2, 7, 101] {
            for budget in [Budget::to_the_cap(), Budget::evaluations(1_003)] {
                let [one, two, eight] = [1, 2, 8]
                    .map(|threads| total(members, budget, &Workers::new(threads).unwrap()));
                assert_eq!(one, two, "{members} members");
                assert_eq!(one, eight, "{members} members");
                assert_eq!(one == 0, members == 0);
            }
        }
    }

    #[test]
    fn two_searches_share_the_threads_and_a_panic_leaves_them_to_the_next() {
        let workers = Workers::new(3).unwrap();
        let expected = total(50, Budget::to_the_cap(), &Workers::one());
        let count = || total(50, Budget::to_the_cap(), &workers);
        thread::scope(|scope| {
            let other = scope.spawn(count);
            assert_eq!(count(), expected);
            assert_eq!(other.join().unwrap(), expected);
        });
        for mistake in [Mistake::Anywhere, Mistake::NotOn(thread::current().id())] {
            let mut sums = Sums {
                mistake: Some(mistake),
                ..Sums::of(50, 60)
            };
            let panics = AssertUnwindSafe(|| {
                let mut run = Run::new(Seed(0), Budget::to_the_cap());
                search(&mut run, &workers, &mut sums)
            });
            assert!(catch_unwind(panics).is_err());
            assert!(sums.round < 60, "the search went on");
            assert_eq!(count(), expected);
        }
    }
}
