//! Faults of the clock.

use super::Intensity;
use super::injection::Injection;
use crate::disturbance::{Moment, SensingError};

/// Fault 21: the clock is wrong.
pub(super) struct Clock {
    intensity: Intensity,
    last_slip_s: f64,
    last_tick_s: f64,
}

impl Clock {
    pub(super) fn new(intensity: Intensity) -> Self {
        Self {
            intensity,
            last_slip_s: 0.0,
            last_tick_s: 0.0,
        }
    }
}

impl Injection for Clock {
    fn sensing_error(&mut self, now: &Moment, error: &mut SensingError) {
        match self.intensity.degree() {
            1 => {
                // An observation is stamped just before the previous one.
                if now.since_s - self.last_slip_s >= 60.0 {
                    self.last_slip_s = now.since_s;
                    error.stamp_s -= now.since_s - self.last_tick_s + 1e-6;
                }
                self.last_tick_s = now.since_s;
            }
            2 => error.clock_s += 3_600.0,
            3 => error.clock_s -= now.since_s,
            _ => error.clock_s -= 3_600.0,
        }
    }

    /// A vehicle that steers by a stopped clock stays where it is.
    fn pace(&self, _since_s: f64) -> f64 {
        if self.intensity.degree() == 3 {
            0.0
        } else {
            1.0
        }
    }
}
