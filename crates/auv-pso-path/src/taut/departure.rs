//! How a trajectory leaves the start.

use auv_planning::PathProblem;
use auv_types::{Point3, Vector3};

/// Corners that are flown before the string begins.
#[derive(Clone, Debug)]
pub(crate) struct DepartureManoeuvre {
    /// From the start on, without `end`.
    pub(crate) corners: Vec<Point3<f64>>,
    /// Where the string begins.
    pub(crate) end: Point3<f64>,
    /// When the string begins, seconds.
    pub(crate) end_s: f64,
}

impl DepartureManoeuvre {
    /// The string begins at the start.
    pub(crate) fn none(problem: &PathProblem<'_>) -> Self {
        Self {
            corners: Vec::new(),
            end: problem.start,
            end_s: problem.departure_s,
        }
    }

    /// Steps from the start, one after the other. `length_m` is the length with rounded corners.
    pub(crate) fn along(
        problem: &PathProblem<'_>,
        steps: impl IntoIterator<Item = Vector3<f64>>,
        length_m: f64,
    ) -> Self {
        let mut corners = Vec::new();
        let mut end = problem.start;
        for step in steps {
            corners.push(end);
            end += step;
        }
        Self {
            corners,
            end,
            end_s: problem.departure_s + length_m.max(0.0) / problem.vehicle.speed_mps,
        }
    }
}
