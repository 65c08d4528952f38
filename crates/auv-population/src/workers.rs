//! The thread pool: the only place of the workspace that names rayon.

use std::fmt;
#[cfg(feature = "parallel")]
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};
use std::sync::{Mutex, PoisonError};
use thiserror::Error;

/// The threads a planner computes on. A clone is cheap and shares the threads; one thread needs no
/// pool.
///
/// One search at a time uses them. A second search that starts meanwhile runs on its calling thread
/// alone: give planners that run concurrently workers of their own.
#[derive(Clone, Default)]
pub struct Workers {
    #[cfg(feature = "parallel")]
    pool: Option<Arc<Pool>>,
}

/// The threads other than the calling one.
#[cfg(feature = "parallel")]
struct Pool {
    threads: rayon::ThreadPool,
    /// Whether a search uses them.
    in_use: AtomicBool,
}

/// The operating system refused to start threads.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("could not start {threads} threads: {reason}")]
pub struct ThreadsUnavailable {
    /// Number of threads requested.
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
    /// there is always one. Starting threads takes time: do it before a planning call.
    ///
    /// # Errors
    /// [`ThreadsUnavailable`] when the system refuses.
    pub fn new(threads: usize) -> Result<Self, ThreadsUnavailable> {
        #[cfg(feature = "parallel")]
        if threads > 1 {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads - 1)
                .thread_name(|i| format!("auv-worker-{}", i + 1))
                .build()
                .map_err(|error| ThreadsUnavailable {
                    threads,
                    reason: error.to_string(),
                })?;
            let pool = Pool {
                threads: pool,
                in_use: AtomicBool::new(false),
            };
            return Ok(Self {
                pool: Some(Arc::new(pool)),
            });
        }
        let _ = threads;
        Ok(Self::one())
    }

    /// Number of threads, the calling one included.
    #[must_use]
    pub fn threads(&self) -> usize {
        #[cfg(feature = "parallel")]
        if let Some(pool) = &self.pool {
            return pool.threads.current_num_threads() + 1;
        }
        1
    }

    /// Calls `work(index, member)` once for every member, in any order, on all threads that no search
    /// uses. Meant for work of milliseconds and more; for the many short tasks of a population
    /// implement [`Search`](crate::Search).
    pub fn for_each<M: Send>(&self, members: &mut [M], work: impl Fn(usize, &mut M) + Sync) {
        let threads = self.threads().min(members.len());
        let queue = Mutex::new(members.iter_mut().enumerate());
        let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
        let drain = || {
            while let Some((i, member)) = next() {
                work(i, member);
            }
        };
        if threads <= 1 {
            return drain();
        }
        self.lend(|helpers| {
            for _ in 1..threads {
                helpers.call(drain);
            }
            drain();
        });
    }

    /// Does `work`, which may call the other threads as helpers, and waits for them.
    ///
    /// If the threads are in use, `work` gets no helpers.
    pub(crate) fn lend<'scope, R>(&self, work: impl FnOnce(Helpers<'_, 'scope>) -> R) -> R {
        #[cfg(feature = "parallel")]
        if let Some(pool) = &self.pool
            && !pool.in_use.swap(true, Ordering::Acquire)
        {
            let _release = ReleaseOnDrop(&pool.in_use);
            return pool
                .threads
                .in_place_scope(|scope| work(Helpers { scope: Some(scope) }));
        }
        work(Helpers::none())
    }
}

/// The threads that a piece of work may call.
#[derive(Clone, Copy)]
pub(crate) struct Helpers<'a, 'scope> {
    #[cfg(feature = "parallel")]
    scope: Option<&'a rayon::Scope<'scope>>,
    #[cfg(not(feature = "parallel"))]
    scope: std::marker::PhantomData<(&'a (), &'scope ())>,
}

impl<'scope> Helpers<'_, 'scope> {
    fn none() -> Self {
        Self {
            scope: Default::default(),
        }
    }

    /// Queues a call for the next free thread. Without threads the call is dropped.
    pub(crate) fn call(&self, help: impl FnOnce() + Send + 'scope) {
        #[cfg(feature = "parallel")]
        if let Some(scope) = self.scope {
            scope.spawn(|_| help());
        }
        #[cfg(not(feature = "parallel"))]
        drop(help);
    }
}

/// Frees the threads when it is dropped, also by a panic.
#[cfg(feature = "parallel")]
struct ReleaseOnDrop<'a>(&'a AtomicBool);

#[cfg(feature = "parallel")]
impl Drop for ReleaseOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_member_is_visited_once_at_any_thread_count() {
        for threads in [1, 2, 8] {
            let workers = Workers::new(threads).unwrap();
            let mut members = vec![0_usize; 1_001];
            workers.for_each(&mut members, |i, member| *member += i);
            assert!(members.iter().enumerate().all(|(i, &member)| member == i));
        }
    }

    #[test]
    fn the_number_of_threads_is_shown() {
        for (wanted, threads) in [(0, 1), (1, 1), (3, 3)] {
            let workers = Workers::new(wanted).unwrap();
            let shown = format!("Workers {{ threads: {threads} }}");
            assert_eq!(format!("{workers:?}"), shown);
        }
        let refused = ThreadsUnavailable {
            threads: 9,
            reason: "no memory".into(),
        };
        assert_eq!(refused.to_string(), "could not start 9 threads: no memory");
    }
}
