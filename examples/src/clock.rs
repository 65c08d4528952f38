//! How long a planning call takes.

use std::time::Instant;

/// A clock started just before a planning call, outside the planners.
#[derive(Clone, Copy, Debug)]
pub struct Clock(Instant);

impl Clock {
    /// Starts now.
    #[must_use]
    #[allow(
        clippy::disallowed_methods,
        reason = "examples report how long planners took; planners never see this"
    )]
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// When it was started, for `Run::started_at`.
    #[must_use]
    pub const fn started(&self) -> Instant {
        self.0
    }

    /// Milliseconds since.
    #[must_use]
    pub fn elapsed_ms(&self) -> f64 {
        self.0.elapsed().as_secs_f64() * 1e3
    }
}
