//! How a trajectory leaves the start.

use crate::PathProblem;
use auv_types::{Point3, Vector3};

/// Corners that are flown before the rest of a path begins.
#[derive(Clone, Debug, PartialEq)]
pub struct DepartureManoeuvre {
    /// From the start on, without `end`.
    pub corners: Vec<Point3<f64>>,
    /// Where the rest begins.
    pub end: Point3<f64>,
    /// When the rest begins, seconds.
    pub end_s: f64,
}

impl DepartureManoeuvre {
    /// The rest begins at the start.
    #[must_use]
    pub fn none(problem: &PathProblem<'_>) -> Self {
        Self {
            corners: Vec::new(),
            end: problem.start,
            end_s: problem.departure_s,
        }
    }

    /// Steps from the start, one after the other. `length_m` is the length with rounded corners.
    pub fn along(
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
