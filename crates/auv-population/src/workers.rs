//! The thread pool: the only place of the workspace that names rayon.

use std::fmt;
#[cfg(feature = "parallel")]
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};
use std::sync::{Mutex, PoisonError};
use thiserror::Error;

/// The threads a planner computes on. Cheap to clone; one thread needs no pool.
///
/// One search at a time has them. A second one meanwhile computes on the thread it was called from:
/// give planners that run at once workers of their own.
#[derive(Clone, Default)]
pub struct Workers {
    #[cfg(feature = "parallel")]
    pool: Option<Arc<Pool>>,
}

/// The threads besides the calling one.
#[cfg(feature = "parallel")]
struct Pool {
    threads: rayon::ThreadPool,
    /// Whether a search has them.
    lent: AtomicBool,
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
                lent: AtomicBool::new(false),
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

    /// Calls `work(index, member)` once for every member, in any order, on all threads that no search
    /// has. For work of milliseconds and more; a population's is a [`Search`](crate::Search).
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

    /// Does `work`, which may call the other threads to help; ends when they have.
    ///
    /// One work at a time has them: a second on the same threads goes on without.
    pub(crate) fn lend<'scope, R>(&self, work: impl FnOnce(Helpers<'_, 'scope>) -> R) -> R {
        #[cfg(feature = "parallel")]
        if let Some(pool) = &self.pool
            && !pool.lent.swap(true, Ordering::Acquire)
        {
            let _given_back = GivenBack(&pool.lent);
            return pool
                .threads
                .in_place_scope(|scope| work(Helpers { scope: Some(scope) }));
        }
        work(Helpers::none())
    }
}

/// The threads that one work may call.
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

    /// Lets the next free one do this.
    pub(crate) fn call(&self, help: impl FnOnce() + Send + 'scope) {
        #[cfg(feature = "parallel")]
        if let Some(scope) = self.scope {
            scope.spawn(|_| help());
        }
        #[cfg(not(feature = "parallel"))]
        drop(help);
    }
}

/// Says that the threads are free again, also when the work panics.
#[cfg(feature = "parallel")]
struct GivenBack<'a>(&'a AtomicBool);

#[cfg(feature = "parallel")]
impl Drop for GivenBack<'_> {
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
}
