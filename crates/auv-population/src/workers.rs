//! The thread pool: the only place of the workspace that names rayon.

use std::fmt;
#[cfg(feature = "parallel")]
use std::sync::{
    Arc,
    atomic::{AtomicBool, AtomicUsize, Ordering},
};
use std::sync::{Mutex, PoisonError};
use thiserror::Error;

/// How often the calling thread looks whether the others are done before it sleeps: 10 to 50
/// microseconds.
#[cfg(feature = "parallel")]
const LOOKS: u32 = 1_000;

/// The threads a planner computes on. Cheap to clone; one thread needs no pool.
#[derive(Clone, Default)]
pub struct Workers {
    #[cfg(feature = "parallel")]
    pool: Option<Arc<Pool>>,
}

/// The threads besides the calling one.
#[cfg(feature = "parallel")]
struct Pool {
    threads: rayon::ThreadPool,
    /// Whether a search keeps them from falling asleep.
    awake: AtomicBool,
}

/// The operating system gave no threads.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("could not start {threads} threads: {reason}")]
pub struct NoThreads {
    /// How many were asked for.
    pub threads: usize,
    /// The system's reason.
    pub reason: String,
}

impl fmt::Debug for Workers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Workers")
            .field("threads", &self.threads())
            .finish()
    }
}

impl Workers {
    /// The calling thread alone.
    #[must_use]
    pub fn one() -> Self {
        Self::default()
    }

    /// `threads` threads, the calling one included (0 counts as 1). Without feature `parallel`
    /// there is always one. Make it outside a planning call: starting threads takes time.
    ///
    /// # Errors
    /// [`NoThreads`] when the system refuses.
    pub fn new(threads: usize) -> Result<Self, NoThreads> {
        #[cfg(feature = "parallel")]
        if threads > 1 {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads - 1)
                .thread_name(|i| format!("auv-worker-{}", i + 1))
                .build()
                .map_err(|error| NoThreads {
                    threads,
                    reason: error.to_string(),
                })?;
            let pool = Pool {
                threads: pool,
                awake: AtomicBool::new(false),
            };
            return Ok(Self {
                pool: Some(Arc::new(pool)),
            });
        }
        let _ = threads;
        Ok(Self::one())
    }

    /// How many threads work, the calling one included.
    #[must_use]
    pub fn threads(&self) -> usize {
        #[cfg(feature = "parallel")]
        if let Some(pool) = &self.pool {
            return pool.threads.current_num_threads() + 1;
        }
        1
    }

    /// Does `work` while the other threads look for their next task instead of falling asleep: a
    /// search has one for them every few microseconds, and to be woken takes as long.
    ///
    /// One work at a time: a second on the same threads goes on without. A thread that finds
    /// nothing for about 100 microseconds sleeps.
    pub fn awake<R>(&self, work: impl FnOnce() -> R) -> R {
        #[cfg(feature = "parallel")]
        if let Some(pool) = &self.pool
            && !pool.awake.swap(true, Ordering::Acquire)
        {
            return pool.threads.in_place_scope(|scope| {
                let _ending = Ending(&pool.awake);
                for _ in 0..pool.threads.current_num_threads() {
                    scope.spawn(|_| look_for_tasks(&pool.awake));
                }
                work()
            });
        }
        work()
    }

    /// Calls `work(index, member, scratch)` once for every member, in any order, on all threads.
    ///
    /// Members are handed out in chunks of `chunk` (at least 1); each thread keeps one of the
    /// `scratches`, so at most that many threads work. `work` must not depend on what a scratch
    /// holds from other members; then the result is independent of the number of threads. Does
    /// nothing without scratches.
    pub fn for_each<M, S, F>(&self, members: &mut [M], chunk: usize, scratches: &mut [S], work: F)
    where
        M: Send,
        S: Send,
        F: Fn(usize, &mut M, &mut S) + Sync,
    {
        let chunk = chunk.max(1);
        let helpers = (self.threads() - 1).min(members.len().div_ceil(chunk).saturating_sub(1));
        let Some((own, others)) = scratches.split_first_mut() else {
            return;
        };
        if helpers == 0 || others.is_empty() {
            for (i, member) in members.iter_mut().enumerate() {
                work(i, member, own);
            }
            return;
        }
        let queue = Mutex::new(members.chunks_mut(chunk).enumerate());
        // From both ends: a thread mostly meets the members it had the last time.
        let take = |from_front: bool| {
            let mut queue = queue.lock().unwrap_or_else(PoisonError::into_inner);
            if from_front {
                queue.next()
            } else {
                queue.next_back()
            }
        };
        let drain = |scratch: &mut S, from_front: bool| {
            while let Some((k, part)) = take(from_front) {
                for (i, member) in part.iter_mut().enumerate() {
                    work(k * chunk + i, member, scratch);
                }
            }
        };
        #[cfg(feature = "parallel")]
        if let Some(pool) = &self.pool {
            let (drain, busy) = (&drain, &AtomicUsize::new(helpers));
            pool.threads.in_place_scope(|scope| {
                for scratch in others.iter_mut().take(helpers) {
                    scope.spawn(move |_| {
                        drain(scratch, false);
                        busy.fetch_sub(1, Ordering::Release);
                    });
                }
                drain(own, true);
                // The others' last chunks mostly take less than to fall asleep and be woken.
                let mut looks = 0;
                while busy.load(Ordering::Acquire) > 0 && looks < LOOKS {
                    std::hint::spin_loop();
                    looks += 1;
                }
            });
            return;
        }
        drain(own, true);
    }
}

/// Executes what comes until there is no more work.
#[cfg(feature = "parallel")]
fn look_for_tasks(awake: &AtomicBool) {
    let mut looks = 0;
    while awake.load(Ordering::Acquire) && looks < 2 * LOOKS {
        match rayon::yield_now() {
            Some(rayon::Yield::Executed) => looks = 0,
            _ => looks += 1,
        }
        std::hint::spin_loop();
    }
}

/// Says that the work is done, also when it panics.
#[cfg(feature = "parallel")]
struct Ending<'a>(&'a AtomicBool);

#[cfg(feature = "parallel")]
impl Drop for Ending<'_> {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_searches_share_the_threads_and_both_end() {
        let workers = Workers::new(3).unwrap();
        let search = || {
            workers.awake(|| {
                let mut members = vec![0_u64; 100];
                let mut scratches = vec![(); 3];
                for _ in 0..50 {
                    workers.for_each(&mut members, 1, &mut scratches, |i, member, _| {
                        *member += i as u64;
                    });
                }
                members.iter().sum::<u64>()
            })
        };
        std::thread::scope(|scope| {
            let other = scope.spawn(search);
            assert_eq!(search(), 50 * 99 * 50);
            assert_eq!(other.join().unwrap(), 50 * 99 * 50);
        });
        // A panic in one leaves the threads to the next.
        let panics =
            std::panic::AssertUnwindSafe(|| workers.awake(|| panic!("a planner's mistake")));
        assert!(std::panic::catch_unwind(panics).is_err());
        assert_eq!(search(), 50 * 99 * 50);
    }

    #[test]
    fn results_stay_in_place_at_any_thread_count() {
        let compute = |threads: usize| {
            let workers = Workers::new(threads).unwrap();
            let mut members = vec![(0_usize, 0.0_f64); 1_001];
            let mut scratches = vec![Vec::<f64>::new(); threads];
            workers.for_each(&mut members, 7, &mut scratches, |i, member, scratch| {
                scratch.clear();
                scratch.extend((0..50).map(|k| 1.0 / (1.0 + (i * k) as f64)));
                *member = (i, scratch.iter().sum());
            });
            members
        };
        let serial = compute(1);
        assert_eq!(serial, compute(2));
        assert_eq!(serial, compute(8));
        assert!(serial.iter().enumerate().all(|(i, member)| member.0 == i));
    }
}
