//! A planner that never ends.

use super::checks::{FailedCheck, FailedChecks};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// Runs a kit on a thread of its own. `kit` says which check begins; the one under way when `limit` is
/// over is the one that fails.
pub(super) fn ended_within(
    limit: Duration,
    kit: impl FnOnce(&dyn Fn(&'static str)) -> Result<(), FailedChecks> + Send + 'static,
) -> Result<(), FailedChecks> {
    enum News {
        Began(&'static str),
        Ended(Result<(), FailedChecks>),
    }
    let (tell, news) = channel();
    std::thread::spawn(move || {
        let began = tell.clone();
        // A receiver that is gone has given up on this thread.
        let outcome = kit(&|check| drop(began.send(News::Began(check))));
        drop(tell.send(News::Ended(outcome)));
    });
    let mut check = "the kit begins";
    loop {
        // Each check has the whole limit: the kit reads no clock.
        match news.recv_timeout(limit) {
            Ok(News::Began(next)) => check = next,
            Ok(News::Ended(outcome)) => return outcome,
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {
                let reason = format!("has not ended after {} s", limit.as_secs_f64());
                return Err(FailedChecks(vec![FailedCheck { check, reason }]));
            }
        }
    }
}
