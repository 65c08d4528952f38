//! A line of a survey.

use crate::mission_file::heights::Height;
use auv_types::Point3;

/// A line of a survey.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::mission_file) struct Line {
    /// Seen from above, from its end a to its end b.
    pub(super) points: Vec<Point3<f64>>,
    pub(in crate::mission_file) height: Height,
    /// Indices of the waypoints of its ends.
    pub(in crate::mission_file) ends: [usize; 2],
    /// Its task.
    pub(in crate::mission_file) task: String,
    /// Which survey it belongs to.
    pub(in crate::mission_file) survey: usize,
}

/// What an edge is that a survey draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::mission_file) enum Drawn {
    /// A line of the survey, by number.
    Line(usize),
    /// A way to a line; left out where there is none.
    Way,
}

impl Line {
    /// Its points, seen from above.
    pub(in crate::mission_file) fn points(&self) -> &[Point3<f64>] {
        &self.points
    }
}
