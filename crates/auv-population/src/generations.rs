//! The loop over generations that GA, ICA and PSO share.

use crate::search::Search;
use crate::task_pool::TaskPool;
use crate::workers::{Helpers, Workers};
use auv_planning::{Run, StopReason};

/// Runs generations until the run or the search itself ends.
///
/// # Determinism
/// Evaluations are granted before each parallel section, by index: every budget holds exactly, and
/// the result does not depend on the number of threads.
pub fn search<S: Search + ?Sized>(
    run: &mut Run<'_>,
    workers: &Workers,
    population: &mut S,
) -> StopReason {
    let pool = TaskPool::new(population, workers.threads());
    workers.lend(|helpers| {
        let _guard = pool.stop_on_drop();
        generations(run, &pool, helpers)
    })
}

fn generations<'scope, 'a: 'scope, S: Search + ?Sized>(
    run: &mut Run<'_>,
    pool: &'scope TaskPool<'a, S>,
    helpers: Helpers<'_, 'scope>,
) -> StopReason {
    let mut population = pool.search();
    loop {
        let proposed = population.propose();
        let granted = run.grant(proposed);
        if granted == 0 && proposed > 0 {
            return run.stats(StopReason::Finished).stop;
        }
        let tasks = population.begin(granted);
        drop(population);
        pool.round(tasks, helpers);
        population = pool.search();
        if pool.is_over() {
            // A helper panicked. Its panic reaches the caller in place of this reason.
            return StopReason::Finished;
        }
        let own_reason = population.select(granted);
        let progress = population.progress(run.is_observed());
        run.end_generation(progress.best, progress.costs, progress.violations);
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
    use crate::members::Members;
    use crate::search::Progress;
    use auv_planning::{Budget, Score};
    use auv_types::Seed;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread::{self, ThreadId};

    /// Each task adds to its member a sum that depends on task and round.
    struct Sums {
        members: Members<u64>,
        round: u64,
        rounds: u64,
        fault: Option<TaskFault>,
        has_helper: AtomicBool,
        total: u64,
    }

    /// Which threads panic.
    #[derive(Clone, Copy)]
    enum TaskFault {
        Anywhere,
        NotOn(ThreadId),
    }

    impl Sums {
        fn of(members: usize, rounds: u64) -> Self {
            Self {
                members: Members::new(members, || 0),
                round: 0,
                rounds,
                fault: None,
                has_helper: AtomicBool::new(false),
                total: 0,
            }
        }
    }

    impl Search for Sums {
        type Scratch = Vec<u64>;

        fn scratch(&self) -> Vec<u64> {
            Vec::new()
        }

        fn propose(&mut self) -> u64 {
            self.members.len() as u64
        }

        fn begin(&mut self, granted: u64) -> usize {
            granted as usize
        }

        fn work(&self, task: usize, scratch: &mut Vec<u64>) {
            match self.fault {
                Some(TaskFault::Anywhere) => panic!("a fault in a task"),
                Some(TaskFault::NotOn(caller)) => {
                    if caller != thread::current().id() {
                        self.has_helper.store(true, Ordering::Release);
                        panic!("a fault on a helper thread");
                    }
                    while !self.has_helper.load(Ordering::Acquire) {
                        thread::yield_now();
                    }
                }
                None => {}
            }
            scratch.clear();
            // Uneven work, so that threads take tasks from each other's slots.
            scratch.extend((0..(task as u64 * 37) % 400).map(|k| k ^ self.round));
            *self.members.lock(task) +=
                (self.round + 1) * (task as u64 + 1) + scratch.iter().sum::<u64>();
        }

        fn select(&mut self, _granted: u64) -> Option<StopReason> {
            self.total = self.members.iter_mut().map(|sum| *sum).sum();
            self.round += 1;
            (self.round == self.rounds).then_some(StopReason::Finished)
        }

        fn progress(&mut self, _is_observed: bool) -> Progress<'_> {
            Progress {
                best: Score::feasible(0.0),
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
    fn every_task_runs_once_a_round_at_any_thread_count() {
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
    fn concurrent_searches_agree_and_a_panic_leaves_the_threads_usable() {
        let workers = Workers::new(3).unwrap();
        let expected = total(50, Budget::to_the_cap(), &Workers::one());
        let count = || total(50, Budget::to_the_cap(), &workers);
        thread::scope(|scope| {
            let other = scope.spawn(count);
            assert_eq!(count(), expected);
            assert_eq!(other.join().unwrap(), expected);
        });
        for fault in [
            TaskFault::Anywhere,
            TaskFault::NotOn(thread::current().id()),
        ] {
            let mut sums = Sums {
                fault: Some(fault),
                ..Sums::of(50, 60)
            };
            let panics = AssertUnwindSafe(|| {
                let mut run = Run::new(Seed(0), Budget::to_the_cap());
                search(&mut run, &workers, &mut sums)
            });
            assert!(catch_unwind(panics).is_err());
            assert!(sums.round < 60, "the search did not stop");
            assert_eq!(count(), expected);
        }
    }
}
