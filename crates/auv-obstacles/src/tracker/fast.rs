//! The hypothesis that a new contact is fast, until its echoes have decided.

use super::motion::{Motion, log_likelihood};
use super::settings::TrackerSettings;
use crate::Detection;

/// A fast contact is at first as many times as fast as [`TrackerSettings::first_speed_mps`].
const FASTER: f64 = 4.0;
/// Log odds of it before the second echo: most contacts are slow.
const FIRST_ODDS: f64 = -1.0;
/// Log odds below which it is given up, and the scans after which the echoes alone tell the velocity.
const LEAST_ODDS: f64 = -9.0;
const MOST_SCANS: u32 = 24;

/// The motion of a contact if it is fast.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Fast {
    pub(super) motion: Motion,
    /// Log odds that it is.
    pub(super) odds: f64,
}

/// Which motion the echoes so far are for.
pub(super) enum Speed {
    Slow,
    Fast,
    Open,
}

impl Fast {
    /// `None` for a sonar that measures velocities, and where contacts are believed from their first echo on.
    pub(super) fn new(echo: &Detection, settings: &TrackerSettings) -> Option<Self> {
        let is_open = echo.velocity.is_none() && settings.confirm_hits > 1;
        is_open.then(|| Self {
            motion: Motion::new(echo, FASTER * settings.first_speed_mps),
            odds: FIRST_ODDS,
        })
    }

    /// Weighs an echo against the motion of a slow contact, and takes it in.
    pub(super) fn update(&mut self, echo: &Detection, slow: &Motion) {
        let likelihood = |motion: &Motion| log_likelihood(echo, &motion.position, motion.pp);
        self.odds += likelihood(&self.motion) - likelihood(slow);
        self.motion.update(echo);
    }

    /// Whether the echoes since the first do not speak against it.
    pub(super) fn may_be(&self) -> bool {
        self.odds >= FIRST_ODDS
    }

    pub(super) fn decided(&self, scans: u32) -> Speed {
        if self.odds > 0.0 {
            Speed::Fast
        } else if self.odds < LEAST_ODDS || scans >= MOST_SCANS {
            Speed::Slow
        } else {
            Speed::Open
        }
    }
}
