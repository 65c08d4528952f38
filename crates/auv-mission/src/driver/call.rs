//! A computation on a thread of its own, abandoned when it takes too long.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Weak};
use std::thread;
use std::time::{Duration, Instant};

/// A computation under way. Dropping it tells it to stop; its result is lost.
pub(super) struct Call<T> {
    started: Instant,
    deadline: Duration,
    cancel: Arc<AtomicBool>,
    answer: Receiver<T>,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoAnswer {
    /// It is still being computed.
    Working,
    /// The hard deadline has passed.
    Overran,
    /// The thread ended without an answer.
    Died,
}

impl<T: Send + 'static> Call<T> {
    /// Starts a thread; `None` if the system cannot start one. `compute` gets the cancel flag and a clock
    /// that gives seconds since the start.
    pub(super) fn start(
        deadline: Duration,
        compute: impl FnOnce(&AtomicBool, &dyn Fn() -> f64) -> T + Send + 'static,
    ) -> Option<Self> {
        let (send, answer) = channel();
        let cancel = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&cancel);
        let started = now();
        thread::Builder::new()
            .name("planner".to_owned())
            .spawn(move || {
                let result = compute(&flag, &|| started.elapsed().as_secs_f64());
                // The flag is dropped before the answer is sent: a call counts as hanging while it lives. The
                // receiver may be gone.
                drop(flag);
                let _ = send.send(result);
            })
            .ok()?;
        Some(Self {
            started,
            deadline,
            cancel,
            answer,
        })
    }

    /// Waits for the answer, at most for `patience` and until the deadline.
    pub(super) fn receive(&self, patience: Duration) -> Result<T, NoAnswer> {
        let left = self.deadline.saturating_sub(self.started.elapsed());
        self.answer
            .recv_timeout(left.min(patience))
            .map_err(|error| match error {
                RecvTimeoutError::Disconnected => NoAnswer::Died,
                RecvTimeoutError::Timeout if self.started.elapsed() >= self.deadline => {
                    NoAnswer::Overran
                }
                RecvTimeoutError::Timeout => NoAnswer::Working,
            })
    }
}

impl<T> Call<T> {
    /// Seconds since the start.
    pub(super) fn clock_s(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Tells the computation to stop. The returned handle is alive while the thread is.
    pub(super) fn abandon(&self) -> Weak<AtomicBool> {
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
