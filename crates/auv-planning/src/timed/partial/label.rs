//! A partial route.

use crate::timed::timed_network::Step;

/// A partial route that ends with a step.
#[derive(Clone, Debug)]
pub(super) struct Label {
    /// When its last step is ready, seconds.
    pub(super) ready_s: f64,
    pub(super) weight: f64,
    /// The least time since it was at one of the places to be met again and again, seconds: without waiting, at
    /// the quickest departures. 0 where there are none.
    pub(super) since_s: f64,
    /// The latest time for the next of these places, seconds: after the latest times of those before.
    pub(super) due_s: f64,
    /// The nodes that it has visited.
    pub(super) visited: u128,
    /// The nodes that it can visit no more: those visited, and those from which no way leads home in time.
    pub(super) shut: u128,
    /// No continuation weighs more.
    pub(super) most: f64,
    /// Whether it has gone out and would pass its only edge back.
    pub(super) earns_less_back: bool,
    pub(super) step: Step,
    pub(super) parent: u32,
    pub(super) place: Place,
    /// The number of its place.
    pub(super) rivals: u32,
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
    /// The nodes that another one must be unable to visit to be beaten by this one: all, so none is, where this
    /// one earns less on the way back to the start than others.
    pub(super) fn beats_with(&self) -> u128 {
        if self.earns_less_back {
            u128::MAX
        } else {
            self.visited
        }
    }
}
