//! What a mission leaves out because the vehicle has no room for it.

use auv_graph::ArcId;

/// Something that is left out.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NoRoom {
    pub(super) what: LeftOut,
    /// Its name, why, and the remedy.
    pub(super) text: String,
}

impl NoRoom {
    pub(super) fn told(&self) -> String {
        self.text.clone()
    }
}

/// What is left out.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum LeftOut {
    /// The work at a waypoint, or every edge to it.
    Waypoint(usize),
    /// An arc.
    Arc(ArcId),
    /// Work, by its title.
    Work(String),
}
