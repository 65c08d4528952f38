//! When a route in time leaves its nodes and does its tasks.

/// The times of a route in time.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Schedule {
    /// When it leaves each node but the last, in seconds from the start.
    pub departures_s: Vec<f64>,
    /// The tasks that it does, in their order.
    pub done: Vec<TaskDone>,
    /// When it ends, in seconds from the start.
    pub end_s: f64,
}

/// A task that a route does.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TaskDone {
    /// The index of the task in its [`TimeModel`](auv_graph::TimeModel).
    pub task: usize,
    /// When the work begins, in seconds from the start.
    pub start_s: f64,
}
