//! Everything that changes during a mission: plain data.

use crate::beliefs::Beliefs;
use crate::ledger::Ledger;
use crate::mode::Mode;
use auv_graph::NodeId;
use auv_planning::Trajectory;

/// Everything that changes during a mission. Only `synchroniser/apply` writes it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    pub(crate) mode: Mode,
    pub(crate) beliefs: Beliefs,
    pub(crate) ledger: Ledger,
    pub(crate) route: RouteInForce,
    /// The trajectory that the vehicle follows.
    pub(crate) in_force: Option<Trajectory>,
    /// The number of the next question to a planner.
    pub(crate) next_question: u64,
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
