//! What the check of a way on finds.

use crate::{PathReport, PathViolation};
use thiserror::Error;

/// The state in which a way on must end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndState {
    /// At rest for a vehicle that can hover; for another on a level closed loop, which it can repeat.
    UnderWay,
    /// At the problem's target, which is the dock. It need not last.
    Docked,
    /// At the surface, or at the top of the box where that lies deeper. It need not last.
    Drifting,
}

/// How the end of a way on can be kept.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum KeptEnd {
    /// The vehicle hovers.
    Resting,
    /// The vehicle repeats its last loop.
    Circling {
        /// When the loop starts, seconds. It ends with the trajectory.
        from_s: f64,
        /// How long it takes, seconds.
        period_s: f64,
    },
    /// The vehicle is at the dock.
    Docked,
    /// The vehicle drifts at the surface.
    Drifting,
}

/// One thing wrong with a way on.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum WayOnViolation {
    /// The vehicle cannot fly it, or it leads where it must not.
    #[error(transparent)]
    Path(#[from] PathViolation),
    /// The time at which the way on starts is not within the trajectory, or a time is not a number.
    #[error("the way on starts at {ends_s} s, not within {start_s} to {end_s} s")]
    NotWithin {
        /// When it is said to start, seconds.
        ends_s: f64,
        /// When the trajectory starts, seconds.
        start_s: f64,
        /// When the trajectory ends, seconds.
        end_s: f64,
    },
    /// It ends too soon.
    #[error("the way on lasts {lasts_s} s, less than {required_s} s")]
    TooShort {
        /// How long it lasts, seconds.
        lasts_s: f64,
        /// How long it must last, seconds.
        required_s: f64,
    },
    /// A vehicle that cannot hover does not end on a loop: it was not there before in the direction of its
    /// end. A loop leads at least 1 m away, and back to within 0.05 m.
    #[error("the way on ends on no closed loop: it was {nearest_m} m from its end at the nearest")]
    NotClosed {
        /// The least distance to an earlier place, metres (`+inf`: it did not turn back).
        nearest_m: f64,
    },
    /// The last loop changes depth by more than 0.1 m.
    #[error("the last loop of the way on changes depth by {height_m} m")]
    NotLevel {
        /// Greatest difference of depth on it, metres.
        height_m: f64,
    },
    /// It does not end at the dock.
    #[error("the way on ends {distance_m} m from the dock")]
    NotDocked {
        /// Distance from the problem's target, metres.
        distance_m: f64,
    },
    /// It does not end at the surface.
    #[error("the way on ends {depth_m} m below the surface or the top of the box")]
    NotAtSurface {
        /// How far below, metres.
        depth_m: f64,
    },
}

/// All figures of a whole trajectory with its way on, and everything wrong with it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WayOnReport {
    /// The whole trajectory; its closest approach is that of the way on.
    pub path: PathReport,
    /// How long the way on lasts, seconds; with the rest at its end.
    pub lasts_s: f64,
    /// How its end can be kept (`None`: it cannot).
    pub kept: Option<KeptEnd>,
    /// Everything wrong, with what is wrong with the whole trajectory.
    pub violations: Vec<WayOnViolation>,
}

impl WayOnReport {
    /// Whether the vehicle has a safe end in hand.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.violations.is_empty()
    }
}
