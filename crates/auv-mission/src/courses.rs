//! What is asked of legs beyond their ends.

use auv_graph::{ArcId, NodeId};
use auv_planning::Arrival;
use std::collections::{BTreeMap, BTreeSet};

/// What is asked of legs beyond their ends. A leg that cannot be flown so, among obstacles, is flown as the path
/// planner finds it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Courses {
    /// Arcs that are flown along their guides, or straight.
    pub lines: BTreeSet<ArcId>,
    /// How all other legs to a waypoint arrive there.
    pub arrivals: BTreeMap<NodeId, Arrival>,
    /// Speed through the water along arcs, where it is not the cruising speed, m/s.
    pub speeds_mps: BTreeMap<ArcId, f64>,
}
