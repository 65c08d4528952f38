//! How far a campaign is, on stderr.

use auv_examples::Clock;
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicU64, Ordering};

/// Least time between two prints of the bar on a terminal, milliseconds.
const BAR_MS: u64 = 500;
/// Least time between two lines in a log, milliseconds.
const LOG_MS: u64 = 60_000;

/// Counts runs, and prints done, rate and time left: as a bar on a terminal, as a line now and then in a log.
pub(crate) struct Progress {
    total: u64,
    done: AtomicU64,
    clock: Clock,
    /// When it was printed last.
    printed_ms: AtomicU64,
    is_terminal: bool,
}

impl Progress {
    pub(crate) fn new(total: u64) -> Self {
        Self {
            total,
            done: AtomicU64::new(0),
            clock: Clock::start(),
            printed_ms: AtomicU64::new(0),
            is_terminal: std::io::stderr().is_terminal(),
        }
    }

    /// One more run is done. Any thread may say so.
    pub(crate) fn one(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        let now_ms = self.clock.elapsed_ms() as u64;
        let last_ms = self.printed_ms.load(Ordering::Relaxed);
        let every_ms = if self.is_terminal { BAR_MS } else { LOG_MS };
        let turn = now_ms >= last_ms + every_ms
            && self
                .printed_ms
                .compare_exchange(last_ms, now_ms, Ordering::Relaxed, Ordering::Relaxed)
                .is_ok();
        if turn {
            let text = told(done, self.total, now_ms);
            let _ = match self.is_terminal {
                true => write!(std::io::stderr().lock(), "\r\x1b[K{text}"),
                false => writeln!(std::io::stderr().lock(), "{text}"),
            };
        }
    }
}

/// Done, rate and time left.
fn told(done: u64, total: u64, so_far_ms: u64) -> String {
    let rate = 1e3 * done as f64 / so_far_ms.max(1) as f64;
    let left_s = total.saturating_sub(done) as f64 / rate;
    let left = match left_s {
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7_200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3_600.0),
    };
    let rate = match rate {
        r if r < 0.1 => format!("{:.1}/min", 60.0 * r),
        r => format!("{r:.1}/s"),
    };
    format!("{done} of {total}, {rate}, {left} left")
}

impl Drop for Progress {
    fn drop(&mut self) {
        if self.is_terminal {
            let _ = write!(std::io::stderr().lock(), "\r\x1b[K");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_told_in_units_that_fit() {
        assert_eq!(told(40, 1_520, 66_000), "40 of 1520, 0.6/s, 41 min left");
        assert_eq!(told(90, 100, 9_000), "90 of 100, 10.0/s, 1 s left");
        assert_eq!(told(1, 1_001, 30_000), "1 of 1001, 2.0/min, 8.3 h left");
    }
}
