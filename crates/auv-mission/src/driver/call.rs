//! A computation on a thread of its own, given up when it takes too long.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Weak};
use std::thread;
use std::time::{Duration, Instant};

/// A computation under way. Dropped, it is told to stop and its result is lost.
pub(super) struct Call<T> {
    began: Instant,
    deadline: Duration,
    cancel: Arc<AtomicBool>,
    answer: Receiver<T>,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Silence {
    /// It is still computed.
    Working,
    /// The hard deadline has passed.
    Overran,
    /// The thread ended without one.
    Died,
}

impl<T: Send + 'static> Call<T> {
    /// Starts a thread; `None` when the system has none left. `compute` is lent the cancel flag and
    /// a clock in seconds.
    pub(super) fn begin(
        deadline: Duration,
        compute: impl FnOnce(&AtomicBool, &dyn Fn() -> f64) -> T + Send + 'static,
    ) -> Option<Self> {
        let (send, answer) = channel();
        let cancel = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&cancel);
        let began = now();
        thread::Builder::new()
            .name("planner".to_owned())
            .spawn(move || {
                let result = compute(&flag, &|| began.elapsed().as_secs_f64());
                // The flag is let go before anybody sees the answer; nobody may wait for it any more.
                drop(flag);
                let _ = send.send(result);
            })
            .ok()?;
        Some(Self {
            began,
            deadline,
            cancel,
            answer,
        })
    }

    /// The answer, waited for no longer than `patience` and the deadline.
    pub(super) fn receive(&self, patience: Duration) -> Result<T, Silence> {
        let left = self.deadline.saturating_sub(self.began.elapsed());
        self.answer
            .recv_timeout(left.min(patience))
            .map_err(|error| match error {
                RecvTimeoutError::Disconnected => Silence::Died,
                RecvTimeoutError::Timeout if self.began.elapsed() >= self.deadline => {
                    Silence::Overran
                }
                RecvTimeoutError::Timeout => Silence::Working,
            })
    }
}

impl<T> Call<T> {
    /// Seconds since it began.
    pub(super) fn clock_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    /// Tells it to stop; what is returned lives as long as its thread.
    pub(super) fn give_up(&self) -> Weak<AtomicBool> {
        self.cancel.store(true, Ordering::Relaxed);
        Arc::downgrade(&self.cancel)
    }
}

impl<T> Drop for Call<T> {
    fn drop(&mut self) {
        self.cancel.store(true, Ordering::Relaxed);
    }
}

#[allow(
    clippy::disallowed_methods,
    reason = "the threaded driver is one of the two places that read a clock, only to give up"
)]
fn now() -> Instant {
    Instant::now()
}
