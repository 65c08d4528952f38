//! Triggers of decisions: events, and what follows from earlier decisions.

use crate::path_question::{Accepted, Reach};
use crate::route_question::JudgedRoute;

/// What makes a decision necessary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Trigger {
    /// Time passed.
    Tick,
    /// The clock ran backwards, stood still for too long or is not a number.
    ClockLost,
    /// The position is lost for longer than dead reckoning is trusted.
    PositionLost,
    /// The sonar has been silent for too long.
    SonarLost,
    /// The measured altitude is less than half the least altitude.
    BedTooNear,
    /// The vehicle reports that it cannot follow trajectories any more.
    CannotFollow,
    /// The vehicle reports water inside.
    Leak,
    /// The route question was answered.
    RouteAnswered,
    /// The path question was answered.
    PathAnswered,
    /// A decision wants a path.
    PathWanted,
    /// The route in force has no next leg.
    NoLeg,
    /// No way leads home.
    NoWayHome,
    /// No contingency can be flown, and no evasion.
    NoManoeuvre,
}

/// What came with a trigger.
#[derive(Clone, Debug)]
pub(crate) enum Payload {
    None,
    /// Where the path that is wanted may lead.
    Reach(Reach),
    /// The path that the planner returned, if it may go into force.
    Path(Option<Box<Accepted>>),
    /// The route that the planner returned, judged.
    Route(Box<JudgedRoute>),
}
