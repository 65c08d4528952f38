//! Members of a population that several threads write in one round.

use crate::cache_padded::CachePadded;
use std::fmt;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What the tasks of a [`Search`](crate::Search) write: a list in which each member has a lock.
///
/// In a round, each task locks its own members. These locks are never contended; they prove to the
/// compiler that no two threads write the same member. Between rounds [`Members::iter_mut`] needs no
/// lock.
#[derive(Default)]
pub struct Members<M>(Vec<CachePadded<Mutex<M>>>);

impl<M> Members<M> {
    /// `len` members, each the result of one call of `make`.
    pub fn new(len: usize, make: impl FnMut() -> M) -> Self {
        std::iter::repeat_with(make).take(len).collect()
    }

    /// Number of members.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is no member.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Locks one member for the task that writes it. Blocks while another task holds the lock.
    ///
    /// # Panics
    /// If `index` is not below [`Members::len`].
    pub fn lock(&self, index: usize) -> MutexGuard<'_, M> {
        let member = &self.0[index].0;
        member.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// All members in order.
    pub fn iter_mut(&mut self) -> impl DoubleEndedIterator<Item = &mut M> + ExactSizeIterator {
        self.0.iter_mut().map(unlocked)
    }

    /// Keeps the first `len` members.
    pub fn truncate(&mut self, len: usize) {
        self.0.truncate(len);
    }
}

fn unlocked<M>(member: &mut CachePadded<Mutex<M>>) -> &mut M {
    member.0.get_mut().unwrap_or_else(PoisonError::into_inner)
}

impl<M> FromIterator<M> for Members<M> {
    fn from_iter<I: IntoIterator<Item = M>>(members: I) -> Self {
        let padded = |member| CachePadded(Mutex::new(member));
        Self(members.into_iter().map(padded).collect())
    }
}

impl<M: fmt::Debug> fmt::Debug for Members<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list()
            .entries(self.0.iter().map(|member| &member.0))
            .finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_keep_their_order_when_the_last_are_dropped() {
        let mut count = 0;
        let mut members = Members::new(4, || {
            count += 1;
            count
        });
        *members.lock(1) += 10;
        members.truncate(2);
        assert_eq!(members.iter_mut().map(|m| *m).collect::<Vec<_>>(), [1, 12]);
        assert_eq!((members.len(), members.is_empty()), (2, false));
        assert!(format!("{members:?}").contains("data: 12"), "{members:?}");
        members.truncate(0);
        assert!(members.is_empty());
    }
}
