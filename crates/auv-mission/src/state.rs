//! Everything that changes during a mission: plain data.

use crate::beliefs::Beliefs;
use crate::ledger::Ledger;
use crate::mode::Mode;
use crate::soundings::Soundings;
use auv_graph::NodeId;
use auv_planning::Trajectory;

/// Everything that changes during a mission. Only `synchroniser/apply` writes it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    pub(crate) mode: Mode,
    pub(crate) beliefs: Beliefs,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) soundings: Soundings,
    pub(crate) ledger: Ledger,
    pub(crate) route: RouteInForce,
    /// What the route in force does of the mission's tasks with windows and order, in order.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) due: Vec<usize>,
    pub(crate) in_force: Option<InForce>,
    /// The number of the next question to a planner.
    pub(crate) next_question: u64,
}

/// The trajectory that the vehicle follows.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct InForce {
    /// All of it: what it is followed for, and the way on from there.
    pub(crate) whole: Trajectory,
    /// When what it is followed for ends, and the way on starts.
    pub(crate) ends_s: f64,
}

impl InForce {
    /// A trajectory and the way on from its end; `None` if the vehicle rests there, as it does where the
    /// way on only stays.
    pub(crate) fn new(trajectory: Trajectory, way_on: Option<&Trajectory>) -> Self {
        let ends_s = trajectory.end().time_s;
        let moves = way_on.filter(|way_on| way_on.length_m() > 0.0);
        let whole = moves.and_then(|way_on| trajectory.clone().then(way_on).ok());
        Self {
            whole: whole.unwrap_or(trajectory),
            ends_s,
        }
    }

    /// What it is followed for: all but the way on.
    pub(crate) fn purpose(&self) -> Trajectory {
        self.whole.until(self.ends_s)
    }
}

#[cfg(test)]
impl From<Trajectory> for InForce {
    /// Without a way on.
    fn from(trajectory: Trajectory) -> Self {
        Self::new(trajectory, None)
    }
}

/// The rest of the route in force. Its first node is where the next leg starts.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum RouteInForce {
    /// None has been adopted yet.
    None,
    /// A planner's route, with tasks.
    Planned(Vec<NodeId>),
    /// The quickest way home, leaving tasks undone.
    QuickestHome(Vec<NodeId>),
}

impl RouteInForce {
    pub(crate) fn nodes(&self) -> &[NodeId] {
        match self {
            Self::None => &[],
            Self::Planned(nodes) | Self::QuickestHome(nodes) => nodes,
        }
    }

    pub(crate) fn is_homeward(&self) -> bool {
        matches!(self, Self::QuickestHome(_))
    }

    /// The same route from other nodes on.
    pub(crate) fn with_nodes(&self, nodes: Vec<NodeId>) -> Self {
        match self {
            Self::None | Self::Planned(_) => Self::Planned(nodes),
            Self::QuickestHome(_) => Self::QuickestHome(nodes),
        }
    }
}
