//! The tasks of a search, shared by all threads round after round.

use crate::cache_padded::CachePadded;
use crate::search::Search;
use crate::workers::Helpers;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, RwLock, RwLockWriteGuard};

/// How often a thread polls before it sleeps: 10 to 100 microseconds.
const SPINS: u32 = 1_000;

/// One search, and a queue of tasks for each thread that works on it.
///
/// The search is behind a lock. During a round all threads read it, and each locks the members that
/// its task writes. Between rounds only the calling thread has it; taking it back waits for all
/// threads that still work. A helper that has not started on a round, because it sleeps or has no
/// processor, delays nothing: the other threads do its tasks.
pub(crate) struct TaskPool<'a, S: Search + ?Sized> {
    search: RwLock<&'a mut S>,
    slots: Vec<CachePadded<WorkerSlot<S::Scratch>>>,
    /// Number of rounds started.
    rounds: CachePadded<AtomicU64>,
    is_over: AtomicBool,
}

/// The tasks and the scratch memory of one thread.
struct WorkerSlot<R> {
    /// Tasks of this round that no thread has started. The slot's own thread takes the first, other
    /// threads the last, so that a thread mostly gets the members it had in the round before.
    tasks: Mutex<Range<usize>>,
    scratch: Mutex<R>,
    /// Whether a helper thread polls this slot.
    is_active: AtomicBool,
}

impl<'a, S: Search + ?Sized> TaskPool<'a, S> {
    pub(crate) fn new(search: &'a mut S, threads: usize) -> Self {
        let slot = |_| {
            CachePadded(WorkerSlot {
                tasks: Mutex::new(0..0),
                scratch: Mutex::new(search.scratch()),
                is_active: AtomicBool::new(false),
            })
        };
        Self {
            slots: (0..threads.max(1)).map(slot).collect(),
            search: RwLock::new(search),
            rounds: CachePadded::default(),
            is_over: AtomicBool::new(false),
        }
    }

    /// The search, as soon as no thread works on it.
    pub(crate) fn search(&self) -> RwLockWriteGuard<'_, &'a mut S> {
        for _ in 0..SPINS {
            if let Ok(search) = self.search.try_write() {
                return search;
            }
            std::hint::spin_loop();
        }
        self.search.write().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does tasks 0 to `tasks - 1` of the search. Helpers may still work on the last of them when
    /// it returns.
    pub(crate) fn round<'scope>(&'scope self, tasks: usize, helpers: Helpers<'_, 'scope>)
    where
        'a: 'scope,
    {
        let threads = self.slots.len().min(tasks).max(1);
        for (k, slot) in self.slots[..threads].iter().enumerate() {
            *lock(&slot.0.tasks) = tasks * k / threads..tasks * (k + 1) / threads;
        }
        self.rounds.0.fetch_add(1, Ordering::Release);
        for (k, slot) in self.slots[..threads].iter().enumerate().skip(1) {
            if !slot.0.is_active.swap(true, Ordering::AcqRel) {
                helpers.call(move || self.help(k));
            }
        }
        let search = self.search.read().unwrap_or_else(PoisonError::into_inner);
        self.work(&search, 0, &mut lock(&self.slots[0].0.scratch));
    }

    /// Whether all threads have to stop.
    pub(crate) fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Acquire)
    }

    /// A guard that stops all threads when it is dropped, also by a panic.
    pub(crate) fn stop_on_drop(&self) -> StopOnDrop<'_, 'a, S> {
        StopOnDrop(self)
    }

    /// Works in every round until none starts for a while. A round that starts at that very moment
    /// is missed; the next one calls a helper again.
    fn help(&self, own: usize) {
        let scratch = &mut *lock(&self.slots[own].0.scratch);
        let (mut done, mut spins) = (0, 0);
        while spins < SPINS && !self.is_over() {
            let started = self.rounds.0.load(Ordering::Acquire);
            if started == done {
                spins += 1;
                std::hint::spin_loop();
                continue;
            }
            (done, spins) = (started, 0);
            // While the calling thread has the search, no task is left to do.
            if let Ok(search) = self.search.try_read() {
                self.work(&search, own, scratch);
            }
        }
        self.slots[own].0.is_active.store(false, Ordering::Release);
    }

    /// Does tasks until none is left, first those of its own slot. A panic in a task stops all
    /// threads.
    fn work(&self, search: &S, own: usize, scratch: &mut S::Scratch) {
        let stop_on_panic = self.stop_on_drop();
        for k in 0..self.slots.len() {
            let tasks = &self.slots[(own + k) % self.slots.len()].0.tasks;
            let next = || {
                let mut tasks = lock(tasks);
                if k == 0 {
                    tasks.next()
                } else {
                    tasks.next_back()
                }
            };
            while let Some(task) = next() {
                search.work(task, scratch);
            }
        }
        std::mem::forget(stop_on_panic);
    }
}

/// Stops all threads of a pool when it is dropped.
pub(crate) struct StopOnDrop<'c, 'a, S: Search + ?Sized>(&'c TaskPool<'a, S>);

impl<S: Search + ?Sized> Drop for StopOnDrop<'_, '_, S> {
    fn drop(&mut self) {
        self.0.is_over.store(true, Ordering::Release);
    }
}

/// Locks a mutex, also after a panic: the panic itself reaches the caller.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
