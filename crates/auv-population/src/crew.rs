//! The threads that do the tasks of a search, round after round.

use crate::Search;
use crate::apart::Apart;
use crate::workers::Helpers;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, RwLock, RwLockWriteGuard};

/// How often a thread looks for what it waits for before it sleeps: 10 to 100 microseconds.
const LOOKS: u32 = 1_000;

/// One search, and the threads that share its tasks.
///
/// The search stands behind a lock: in a round all threads read it, each member behind a lock of
/// its own; between rounds the conducting thread alone has it. To get it back is to wait for all
/// that still work. A helper that has not yet come to a round, asleep or without a processor, is not
/// waited for until the search ends: the others do its share.
pub(crate) struct Crew<'a, S: Search + ?Sized> {
    search: RwLock<&'a mut S>,
    posts: Vec<Apart<Post<S::Room>>>,
    /// How many have begun.
    rounds: Apart<AtomicU64>,
    is_over: AtomicBool,
}

/// What belongs to one thread.
struct Post<R> {
    /// Tasks of this round that nobody has begun: its own thread takes the first, others the last,
    /// so that a thread mostly meets the members it had in the round before.
    tasks: Mutex<Range<usize>>,
    room: Mutex<R>,
    is_manned: AtomicBool,
}

impl<'a, S: Search + ?Sized> Crew<'a, S> {
    pub(crate) fn new(search: &'a mut S, threads: usize) -> Self {
        let post = |_| {
            Apart(Post {
                tasks: Mutex::new(0..0),
                room: Mutex::new(search.room()),
                is_manned: AtomicBool::new(false),
            })
        };
        Self {
            posts: (0..threads.max(1)).map(post).collect(),
            search: RwLock::new(search),
            rounds: Apart::default(),
            is_over: AtomicBool::new(false),
        }
    }

    /// The search, once nobody works on it any more.
    pub(crate) fn search(&self) -> RwLockWriteGuard<'_, &'a mut S> {
        for _ in 0..LOOKS {
            if let Ok(search) = self.search.try_write() {
                return search;
            }
            std::hint::spin_loop();
        }
        self.search.write().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does so many tasks of the search. Some may still be worked on when it returns.
    pub(crate) fn round<'scope>(&'scope self, tasks: usize, helpers: Helpers<'_, 'scope>)
    where
        'a: 'scope,
    {
        let threads = self.posts.len().min(tasks).max(1);
        for (k, post) in self.posts[..threads].iter().enumerate() {
            *lock(&post.0.tasks) = tasks * k / threads..tasks * (k + 1) / threads;
        }
        self.rounds.0.fetch_add(1, Ordering::Release);
        for (k, post) in self.posts[..threads].iter().enumerate().skip(1) {
            if !post.0.is_manned.swap(true, Ordering::AcqRel) {
                helpers.call(move || self.help(k));
            }
        }
        let search = self.search.read().unwrap_or_else(PoisonError::into_inner);
        self.work(&search, 0, &mut lock(&self.posts[0].0.room));
    }

    /// Whether all are to stop.
    pub(crate) fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Acquire)
    }

    /// Stops all when it is dropped, also by a panic.
    pub(crate) fn dismissal(&self) -> Dismissal<'_, 'a, S> {
        Dismissal(self)
    }

    /// Works in every round until none has come for a while. One that begins just then is missed, and
    /// the next calls again.
    fn help(&self, own: usize) {
        let room = &mut *lock(&self.posts[own].0.room);
        let (mut done, mut looks) = (0, 0);
        while looks < LOOKS && !self.is_over() {
            let begun = self.rounds.0.load(Ordering::Acquire);
            if begun == done {
                looks += 1;
                std::hint::spin_loop();
                continue;
            }
            (done, looks) = (begun, 0);
            // Who comes too late to read it has nothing to do either.
            if let Ok(search) = self.search.try_read() {
                self.work(&search, own, room);
            }
        }
        self.posts[own].0.is_manned.store(false, Ordering::Release);
    }

    /// Does tasks until there are none. A panic among them is the end, whoever meets it.
    fn work(&self, search: &S, own: usize, room: &mut S::Room) {
        let dismissal = self.dismissal();
        for k in 0..self.posts.len() {
            let tasks = &self.posts[(own + k) % self.posts.len()].0.tasks;
            let next = || {
                let mut tasks = lock(tasks);
                if k == 0 {
                    tasks.next()
                } else {
                    tasks.next_back()
                }
            };
            while let Some(task) = next() {
                search.work(task, room);
            }
        }
        std::mem::forget(dismissal);
    }
}

/// The end of a crew's work.
pub(crate) struct Dismissal<'c, 'a, S: Search + ?Sized>(&'c Crew<'a, S>);

impl<S: Search + ?Sized> Drop for Dismissal<'_, '_, S> {
    fn drop(&mut self) {
        self.0.is_over.store(true, Ordering::Release);
    }
}

/// A lock that a panic does not close: the panic itself reaches the caller.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
