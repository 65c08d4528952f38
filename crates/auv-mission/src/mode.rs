//! What the synchroniser is doing: one mode at a time, with the times that the mode needs.

use crate::question::{PathQuestion, RouteQuestion};
use crate::{AbortReason, Contingency, Outcome};
use auv_graph::{EdgeId, NodeId};
use auv_planning::TaskDone;

/// What the synchroniser is doing.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Mode {
    /// The first tick has not come.
    Ready,
    /// No leg is flown until a route comes.
    AwaitRoute(Box<RouteQuestion>),
    /// A leg is flown, or its first path is awaited.
    Leg(Box<Leg>),
    /// The mission is aborted; a contingency is flown.
    Contingency(ContingencyState),
    /// Over.
    Finished {
        outcome: Outcome,
        /// The contingency flown, if there was one.
        contingency: Option<Contingency>,
    },
}

/// A leg of the route in force.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Leg {
    pub(crate) from: NodeId,
    pub(crate) to: NodeId,
    pub(crate) duty: Duty,
    pub(crate) mode: LegMode,
    pub(crate) awaited: Awaited,
    pub(crate) next_route: NextRoute,
    pub(crate) started_s: f64,
    /// When the vehicle departs: later than the leg starts where the current is against it until then.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) departs_s: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub(crate) expected_s: f64,
    /// Computing time charged to the leg.
    pub(crate) charged_s: f64,
    /// Task time still to be spent at the target.
    pub(crate) task_left_s: f64,
    /// The tasks with windows and order that are done at the target.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) works: Vec<TaskDone>,
    /// Whether the first of them has begun.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) worked: bool,
    pub(crate) waited_s: f64,
    /// Time up to which waiting and task time are booked.
    pub(crate) booked_s: f64,
    /// Time of the last path call.
    pub(crate) asked_s: f64,
    /// Attempts to get a fix at the surface, and the time of the last.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) fixes: u32,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) fix_asked_s: f64,
    /// Whether the vehicle is in contact with the dock that the leg leads to (`None`: nobody says).
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) dock_contact: Option<bool>,
    /// How often the dock was missed, and when the last time.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) misses: u32,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) missed_s: f64,
    /// How the vehicle fails to follow its trajectories, if it does.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) astray: Option<Astray>,
    /// Failed attempts to get a path since the last accepted one.
    pub(crate) failures: u32,
    pub(crate) calls: u32,
    /// Violation and cost that the planner claimed for the leg's first path.
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub(crate) violation: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub(crate) cost: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub(crate) compute_s: f64,
}

/// The vehicle leaves one trajectory after the other.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Astray {
    /// When it left the first.
    pub(crate) since_s: f64,
    /// Its distance from the leg's target then, metres.
    pub(crate) away_m: f64,
}

/// What is done on a leg besides getting to its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Duty {
    /// Nothing: the leg follows no edge, because it starts at the vehicle's own place.
    NoEdge,
    /// The edge is passed without its task: the task is done, or the vehicle goes home.
    Pass(EdgeId),
    /// The edge's task is done at the target.
    Task(EdgeId),
}

impl Duty {
    pub(crate) fn edge(self) -> Option<EdgeId> {
        match self {
            Self::NoEdge => None,
            Self::Pass(edge) | Self::Task(edge) => Some(edge),
        }
    }
}

/// How far a leg has come.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum LegMode {
    /// No path of the leg has been accepted yet.
    AwaitFirstPath,
    /// At the start of the leg until the current lets the vehicle pass.
    Holding,
    /// On a path to the target, which is reached at a time.
    Underway { arrives_s: f64 },
    /// At the target. Task time is booked up to a time.
    AtTarget { booked_s: f64 },
    /// The target is covered. On a path to a place near it, which is reached at a time.
    ToStandOff { arrives_s: f64 },
    /// Waiting at that place since a time.
    AtStandOff { since_s: f64 },
    /// No path leads to the target: keeping clear and waiting.
    Evading,
    /// Too low over the bed as measured: climbing. A path is asked for from there.
    Climbing,
    /// On the way to the surface for a fix of the position, or there.
    Surfacing,
}

impl LegMode {
    /// When the trajectory in force reaches the target or the stand-off, or did; `None` if it leads to
    /// neither.
    pub(crate) fn arrives_s(self) -> Option<f64> {
        match self {
            Self::AwaitFirstPath
            | Self::Holding
            | Self::Evading
            | Self::Climbing
            | Self::Surfacing => None,
            Self::Underway { arrives_s: time_s }
            | Self::AtTarget { booked_s: time_s }
            | Self::ToStandOff { arrives_s: time_s }
            | Self::AtStandOff { since_s: time_s } => Some(time_s),
        }
    }

    /// Whether the trajectory in force leads to the target itself.
    pub(crate) fn leads_to_target(self) -> bool {
        matches!(self, Self::Underway { .. } | Self::AtTarget { .. })
    }

    /// Whether the target is waited for.
    pub(crate) fn waits(self) -> bool {
        matches!(
            self,
            Self::ToStandOff { .. }
                | Self::AtStandOff { .. }
                | Self::Evading
                | Self::Climbing
                | Self::Surfacing
        )
    }
}

/// The path question of a leg that is not answered yet.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Awaited {
    Nothing,
    /// A path to the target or near it. Without one the vehicle waits or evades.
    Path(PathQuestion),
    /// A shorter path. Without one the trajectory in force stays.
    ShorterPath(PathQuestion),
}

impl Awaited {
    pub(crate) fn question(&self) -> Option<&PathQuestion> {
        match self {
            Self::Nothing => None,
            Self::Path(question) | Self::ShorterPath(question) => Some(question),
        }
    }
}

/// The route after the leg.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum NextRoute {
    /// Decided when the leg ends.
    AtTarget,
    /// Asked for during the leg, because the leg will be late.
    Asked(Box<RouteQuestion>),
    /// Decided during the leg.
    Decided,
}

/// An aborted mission.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ContingencyState {
    pub(crate) reason: AbortReason,
    /// The contingency flown; `None` while the vehicle evades because none can be flown.
    pub(crate) flown: Option<Contingency>,
    /// Manoeuvres sought after the first.
    pub(crate) sought: u32,
}
