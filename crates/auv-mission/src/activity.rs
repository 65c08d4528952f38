//! What a vehicle is doing on its mission, for those who watch it.

use crate::Synchroniser;
use crate::mode::{LegMode, Mode};

/// What a vehicle is doing on its mission.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Activity {
    /// It waits for a route, or for the first path of a leg.
    Planning,
    /// It stays until the current lets it pass.
    Holding,
    /// It is on its way to the next waypoint, which it reaches at a mission time in seconds.
    UnderWay {
        /// That time.
        arrives_s: f64,
    },
    /// It is at the waypoint: at work, or waiting for a window to open.
    AtWaypoint,
    /// It keeps clear of obstacles or of the bed until a path leads to the next waypoint.
    KeepingClear,
    /// It goes to the surface for a fix, or is there.
    Surfacing,
    /// The mission is aborted; it does what is left to do.
    Contingency,
    /// The mission is over.
    Over,
}

impl Synchroniser {
    /// What the vehicle is doing.
    #[must_use]
    pub fn activity(&self) -> Activity {
        let leg = match &self.view().state.mode {
            Mode::Ready | Mode::AwaitRoute(_) => return Activity::Planning,
            Mode::Contingency(_) => return Activity::Contingency,
            Mode::Finished { .. } => return Activity::Over,
            Mode::Leg(leg) => leg,
        };
        match leg.mode {
            LegMode::AwaitFirstPath => Activity::Planning,
            LegMode::Holding => Activity::Holding,
            LegMode::Underway { arrives_s } => Activity::UnderWay { arrives_s },
            LegMode::AtTarget { .. } => Activity::AtWaypoint,
            LegMode::ToStandOff { .. }
            | LegMode::AtStandOff { .. }
            | LegMode::Evading
            | LegMode::Climbing => Activity::KeepingClear,
            LegMode::Surfacing => Activity::Surfacing,
        }
    }
}
