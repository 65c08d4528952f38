//! The verifier's verdict on plans.

use auv_graph::Route;
use auv_planning::{PathProblem, RouteProblem, Trajectory};

/// Whether a route meets all criteria of the problem it was asked for.
pub(crate) fn route_is_valid(problem: &RouteProblem<'_>, route: &Route) -> bool {
    auv_verify::verify_route(problem, route).is_valid()
}

/// Whether a path meets the whole problem it was asked for.
pub(crate) fn path_is_valid(problem: &PathProblem<'_>, path: &Trajectory) -> bool {
    auv_verify::verify_trajectory(problem, path).is_valid()
}

/// Whether the vehicle can fly a trajectory within box, bed, turn radius, pitch and speed, wherever
/// it begins and ends and whatever is in the way.
pub(crate) fn is_flyable(problem: &PathProblem<'_>, trajectory: &Trajectory) -> bool {
    let motion = PathProblem {
        regions: &[],
        ..*problem
    };
    auv_verify::verify_motion(&motion, trajectory).is_valid()
}
