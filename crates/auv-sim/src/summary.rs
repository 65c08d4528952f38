//! How a simulated mission went.

use crate::{Following, Judgement};
use auv_graph::NodeId;
use auv_mission::{AbortReason, Contingency, PathCall, RouteCall};
use auv_planning::TaskDone;
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

/// Why a simulated mission ended as it did.
///
/// `Display` gives a text for people; it may change. [`EndReason::code`] stays stable.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum EndReason {
    /// It reached the destination in time.
    InTime,
    /// It reached the destination after the budget.
    AfterBudget,
    /// It believed to be at the destination, but was farther from it than docking tolerates.
    OffDock,
    /// It touched an obstacle.
    TouchedObstacle,
    /// It touched the sea bed.
    TouchedSeaBed,
    /// The synchroniser aborted it.
    Aborted {
        /// Why.
        reason: AbortReason,
        /// What the vehicle did then, if it could do anything.
        contingency: Option<Contingency>,
    },
}

impl EndReason {
    /// The stable code for logs and programs.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::InTime => "in_time",
            Self::AfterBudget => "after_budget",
            Self::OffDock => "off_dock",
            Self::TouchedObstacle => "touched_obstacle",
            Self::TouchedSeaBed => "touched_sea_bed",
            Self::Aborted { reason, .. } => reason.code(),
        }
    }

    /// What the vehicle did after the mission was aborted.
    #[must_use]
    pub const fn contingency(self) -> Option<Contingency> {
        match self {
            Self::Aborted { contingency, .. } => contingency,
            _ => None,
        }
    }
}

impl fmt::Display for EndReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InTime => f.write_str("reached the destination in time"),
            Self::AfterBudget => f.write_str("reached the destination after the budget"),
            Self::OffDock => f.write_str("was not where it believed to dock"),
            Self::TouchedObstacle => f.write_str("touched an obstacle"),
            Self::TouchedSeaBed => f.write_str("touched the sea bed"),
            Self::Aborted {
                reason,
                contingency: Some(contingency),
            } => write!(f, "{reason}; {contingency}"),
            Self::Aborted { reason, .. } => write!(f, "{reason}"),
        }
    }
}

/// The result of a simulated mission.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// How it ended.
    pub outcome: MissionOutcome,
    /// The reason of the outcome.
    pub reason: EndReason,
    /// Waypoints reached, the start included.
    pub visited: Vec<NodeId>,
    /// The tasks done of the mission's time model, in order, with the mission times at which they began.
    pub timed_done: Vec<TaskDone>,
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
    /// How often the vehicle climbed because it was too low over the bed as measured.
    pub climbs: u32,
    /// Waypoints reached higher than given, because the bed there is shallower than charted, and by how much,
    /// metres.
    pub raised: Vec<(NodeId, f64)>,
    /// Distance of the true place from the destination at the end, metres; `None` if it did not dock.
    pub dock_error_m: Option<f64>,
    /// How well the vehicle kept to the timed places of its trajectories.
    pub following: Following,
    /// The comparison of the track with the truth.
    pub judgement: Judgement,
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: {}; {} task{} of weight {:.2} in {:.0} s, {:.0} s left; {} route calls, {} legs",
            self.outcome,
            self.reason,
            self.tasks,
            if self.tasks == 1 { "" } else { "s" },
            self.mission_weight,
            self.time_s,
            self.remaining_s,
            self.route_calls.len(),
            self.path_calls.len(),
        )?;
        if self.judgement.min_clearance_m.is_finite() {
            let nearest_m = self.judgement.min_clearance_m;
            write!(f, "; nearest true obstacle {nearest_m:.1} m")?;
        }
        for broken in &self.judgement.limits_broken {
            write!(f, "; limit broken: {broken}")?;
        }
        Ok(())
    }
}
