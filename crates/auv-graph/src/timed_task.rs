//! A task that a route does only if the planner chooses, within its windows.

use crate::ids::{EdgeId, NodeId};
use crate::waypoint::Task;
use std::fmt;

/// Two sums of the same times in another order differ by rounding; times in seconds that differ by less
/// than this are equal.
pub const TIME_TOLERANCE_S: f64 = 1e-7;

/// The name of a task as its file gives it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(untagged)
)]
pub enum TaskName {
    /// A whole number.
    Number(i64),
    /// A text.
    Text(String),
}

impl fmt::Display for TaskName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Text(text) => text.fmt(f),
        }
    }
}

/// Where a task is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskPlace {
    /// At a waypoint that the route visits, the start and the destination included.
    Node(NodeId),
    /// At the far end of an edge that the route passes, in either direction.
    Edge(EdgeId),
}

/// A task beside the edges' own ones. Passing its place without doing it costs nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedTask {
    /// Its name.
    pub name: TaskName,
    /// Where it is done.
    pub place: TaskPlace,
    /// Priority, risk and completion time.
    pub task: Task,
    /// From when to when it may begin in seconds, in ascending order and apart; none: at any time.
    pub windows: Vec<[f64; 2]>,
    /// Whether a route without it is infeasible.
    pub mandatory: bool,
    /// Tasks, by index, that must be done before it.
    pub after: Vec<usize>,
    /// The chain that it belongs to, by index.
    pub chain: Option<usize>,
}

impl TimedTask {
    /// The earliest time from `from_s` on when it may begin.
    #[must_use]
    #[inline]
    pub fn earliest_start_s(&self, from_s: f64) -> Option<f64> {
        if self.windows.is_empty() {
            return Some(from_s);
        }
        let mut open = self.windows.iter();
        let window = open.find(|[_, last]| from_s <= last + TIME_TOLERANCE_S)?;
        Some(from_s.max(window[0]))
    }

    /// The latest time up to `until_s` when it may begin.
    #[must_use]
    #[inline]
    pub fn latest_start_s(&self, until_s: f64) -> Option<f64> {
        if self.windows.is_empty() {
            return Some(until_s);
        }
        let mut open = self.windows.iter().rev();
        let window = open.find(|[first, _]| *first <= until_s)?;
        Some(until_s.min(window[1]))
    }

    /// Whether it may begin at `start_s`.
    #[must_use]
    pub fn may_start_at(&self, start_s: f64) -> bool {
        let within = |[first, last]: &[f64; 2]| {
            *first - TIME_TOLERANCE_S <= start_s && start_s <= *last + TIME_TOLERANCE_S
        };
        self.windows.is_empty() || self.windows.iter().any(within)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_lie_in_the_nearest_window() {
        let task = TimedTask {
            name: TaskName::Number(1),
            place: TaskPlace::Node(NodeId(0)),
            task: Task::TRANSIT,
            windows: vec![[10.0, 20.0], [30.0, 30.0]],
            mandatory: false,
            after: Vec::new(),
            chain: None,
        };
        let earliest = [5.0, 15.0, 25.0, 31.0].map(|t| task.earliest_start_s(t));
        assert_eq!(earliest, [Some(10.0), Some(15.0), Some(30.0), None]);
        let latest = [5.0, 15.0, 25.0, 31.0].map(|t| task.latest_start_s(t));
        assert_eq!(latest, [None, Some(15.0), Some(20.0), Some(30.0)]);
        assert!(task.may_start_at(30.0) && !task.may_start_at(25.0));
    }
}
