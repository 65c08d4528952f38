//! A routing problem as files and generators give it.

use crate::ids::NodeId;
use crate::network::Network;
use crate::time_model::TimeModel;
use auv_types::Violations;

/// One routing problem as files and generators give it: a network, the ends of the route, and the
/// time it may take.
#[derive(Clone, Debug, PartialEq)]
pub struct RouteInstance {
    /// A name for tables and logs.
    pub name: String,
    /// The network.
    pub network: Network,
    /// Where the route starts.
    pub start: NodeId,
    /// Where the route ends.
    pub destination: NodeId,
    /// Time available in seconds.
    pub budget_s: f64,
    /// The seed it was drawn from, if it was drawn.
    pub seed: Option<u64>,
    /// What a route in time keeps to, if the instance has times.
    pub time_model: Option<TimeModel>,
}

impl RouteInstance {
    /// Longest name in bytes.
    pub const MAX_NAME_BYTES: usize = 256;

    /// Makes an instance.
    ///
    /// # Errors
    /// All of: a start or destination that the network does not have, a budget that is negative or not
    /// finite, a name longer than [`RouteInstance::MAX_NAME_BYTES`].
    pub fn new(
        name: impl Into<String>,
        network: Network,
        (start, destination): (NodeId, NodeId),
        budget_s: f64,
    ) -> Result<Self, Violations> {
        let name = name.into();
        let mut violations = Violations::new();
        violations.require(name.len() <= Self::MAX_NAME_BYTES, "name", || {
            format!(
                "has {} bytes; at most {} are allowed",
                name.len(),
                Self::MAX_NAME_BYTES
            )
        });
        for (node, place) in [(start, "start"), (destination, "goal")] {
            violations.require(network.has_node(node), place, || {
                format!(
                    "is node {}; nodes are 0 to {}",
                    node.0,
                    network.num_nodes() - 1
                )
            });
        }
        violations.require_not_negative(budget_s, "budget");
        violations.into_result()?;
        Ok(Self {
            name,
            network,
            start,
            destination,
            budget_s,
            seed: None,
            time_model: None,
        })
    }
}
