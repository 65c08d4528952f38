//! How far a campaign is, on stderr.

use auv_examples::Clock;
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicU64, Ordering};

/// Least time between two prints, milliseconds.
const EVERY_MS: u64 = 500;

/// Counts runs; where stderr is a terminal, prints done, rate and time left.
pub(crate) struct Progress {
    total: u64,
    done: AtomicU64,
    clock: Clock,
    /// When it was printed last; `None` where stderr is not a terminal.
    printed_ms: Option<AtomicU64>,
}

impl Progress {
    pub(crate) fn new(total: u64) -> Self {
        let terminal = std::io::stderr().is_terminal();
        Self {
            total,
            done: AtomicU64::new(0),
            clock: Clock::start(),
            printed_ms: terminal.then(AtomicU64::default),
        }
    }

    /// One more run is done. Any thread may say so.
    pub(crate) fn one(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        let Some(printed_ms) = &self.printed_ms else {
            return;
        };
        let now_ms = self.clock.elapsed_ms() as u64;
        let last_ms = printed_ms.load(Ordering::Relaxed);
        let turn = now_ms >= last_ms + EVERY_MS
            && printed_ms
                .compare_exchange(last_ms, now_ms, Ordering::Relaxed, Ordering::Relaxed)
                .is_ok();
        if turn {
            let rate = 1e3 * done as f64 / now_ms as f64;
            let left_s = (self.total.saturating_sub(done)) as f64 / rate;
            let text = format!("{done} of {}, {rate:.1}/s, {left_s:.0} s left", self.total);
            let _ = write!(std::io::stderr().lock(), "\r\x1b[K{text}");
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if self.printed_ms.is_some() {
            let _ = write!(std::io::stderr().lock(), "\r\x1b[K");
        }
    }
}
