//! A partial route.

use crate::timed::timed_network::Step;

/// A partial route that ends with a step.
#[derive(Clone, Debug)]
pub(super) struct Label {
    /// When its last step is ready, seconds.
    pub(super) ready_s: f64,
    pub(super) weight: f64,
    /// The nodes that it has visited.
    pub(super) visited: u128,
    pub(super) step: Step,
    pub(super) parent: u32,
    pub(super) place: Place,
    pub(super) is_beaten: bool,
}

/// What a partial route may do next, apart from time and nodes. Only labels of equal place are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place {
    pub(super) node: u32,
    /// Of the tasks that later rules ask for, those done.
    pub(super) known: u64,
    /// Of the tasks at the node and on the edge that leads there, those done, by their place in the list.
    pub(super) here: u32,
    /// The edge that leads there, if it has tasks; else none.
    pub(super) edge: Option<u32>,
    pub(super) stage: Stage,
    pub(super) chain: Option<Running>,
    /// Whether a task was done elsewhere than at the start.
    pub(super) has_worked: bool,
    /// Whether it has come back to the start.
    pub(super) is_closed: bool,
}

/// What is done at a node: first the tasks of the edge that leads there, then those of the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Stage {
    Edge,
    Node,
}

/// A chain being done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Running {
    pub(super) chain: usize,
    /// The place of the last task in the chain.
    pub(super) at: usize,
    /// Forwards, backwards, or either yet.
    pub(super) forwards: Option<bool>,
}

impl Label {
    /// Whether it is at least as good as another one of equal place. Where waiting is not allowed, an earlier
    /// one may miss a window.
    pub(super) fn beats(&self, other: &Self, may_wait: bool) -> bool {
        let is_early = if may_wait {
            self.ready_s <= other.ready_s
        } else {
            self.ready_s.to_bits() == other.ready_s.to_bits()
        };
        is_early && self.weight >= other.weight && self.visited & !other.visited == 0
    }
}
