//! How a simulated mission went.

use crate::Judgement;
use auv_graph::NodeId;
use auv_mission::{PathCall, RouteCall};
use std::fmt;

/// How a simulated mission ended, judged by the truth. If several apply, the first of collided, aborted
/// and late is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum MissionOutcome {
    /// Docked within the budget without touching anything.
    Docked,
    /// Docked after the budget.
    Late,
    /// Touched an obstacle or the sea bed.
    Collided,
    /// Ended before the destination.
    Aborted,
}

impl fmt::Display for MissionOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Docked => "docked",
            Self::Late => "late",
            Self::Collided => "collided",
            Self::Aborted => "aborted",
        })
    }
}

/// The result of a simulated mission.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// How it ended.
    pub outcome: MissionOutcome,
    /// The reason of the outcome, in a few words.
    pub reason: String,
    /// Waypoints reached, the start included.
    pub visited: Vec<NodeId>,
    /// Weight of the tasks done.
    pub mission_weight: f64,
    /// Number of tasks done.
    pub tasks: usize,
    /// Mission time at the end, seconds.
    pub time_s: f64,
    /// Budget left, seconds; negative when late.
    pub remaining_s: f64,
    /// The table of route calls.
    pub route_calls: Vec<RouteCall>,
    /// The table of legs.
    pub path_calls: Vec<PathCall>,
    /// The comparison of the track with the truth.
    pub judgement: Judgement,
}
