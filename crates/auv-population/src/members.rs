//! Members of a population that threads work on side by side.

use crate::apart::Apart;
use std::fmt;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What the tasks of a [`Search`](crate::Search) write: a list whose members are locked one by one.
///
/// In a round, task `i` locks what is its own. Nobody else asks for it: the lock is there because
/// the compiler cannot know that. Between rounds [`Members::iter_mut`] needs none.
#[derive(Default)]
pub struct Members<M>(Vec<Apart<Mutex<M>>>);

impl<M> Members<M> {
    /// So many members, each `make()`.
    pub fn new(len: usize, make: impl FnMut() -> M) -> Self {
        std::iter::repeat_with(make).take(len).collect()
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// One member for the task that it belongs to. Waits where another task has it.
    ///
    /// # Panics
    /// If there is no such member.
    pub fn lock(&self, index: usize) -> MutexGuard<'_, M> {
        let member = &self.0[index].0;
        member.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// All members in order.
    pub fn iter_mut(&mut self) -> impl DoubleEndedIterator<Item = &mut M> + ExactSizeIterator {
        self.0.iter_mut().map(own)
    }

    /// Keeps the first `len`.
    pub fn truncate(&mut self, len: usize) {
        self.0.truncate(len);
    }
}

fn own<M>(member: &mut Apart<Mutex<M>>) -> &mut M {
    member.0.get_mut().unwrap_or_else(PoisonError::into_inner)
}

impl<M> FromIterator<M> for Members<M> {
    fn from_iter<I: IntoIterator<Item = M>>(members: I) -> Self {
        let apart = |member| Apart(Mutex::new(member));
        Self(members.into_iter().map(apart).collect())
    }
}

impl<M: fmt::Debug> fmt::Debug for Members<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list()
            .entries(self.0.iter().map(|member| &member.0))
            .finish()
    }
}
