//! Independent checks of routes and trajectories: a first, thin version.

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

use auv_graph::Route;
use auv_planning::{PathProblem, RouteProblem, Trajectory};

/// The verdict on a plan.
#[derive(Clone, Copy, Debug)]
pub struct Report {
    valid: bool,
}

impl Report {
    /// Whether nothing is wrong.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.valid
    }
}

/// Checks a route against the problem it was asked for.
#[must_use]
pub fn verify_route(problem: &RouteProblem<'_>, route: &Route) -> Report {
    Report {
        valid: problem.check(route).is_ok(),
    }
}

/// Checks a trajectory against the problem it was asked for.
#[must_use]
pub fn verify_trajectory(problem: &PathProblem<'_>, trajectory: &Trajectory) -> Report {
    let ends = (trajectory.start().position - problem.start).norm() < 1e-3
        && (trajectory.end().position - problem.target).norm() < 1e-3;
    Report {
        valid: ends && verify_motion(problem, trajectory).valid,
    }
}

/// Checks a trajectory wherever it begins and ends.
#[must_use]
pub fn verify_motion(problem: &PathProblem<'_>, trajectory: &Trajectory) -> Report {
    let clear = problem.regions.iter().all(|region| {
        trajectory
            .segments()
            .all(|(a, b)| region.clearance(a, b).clearance_m >= problem.clearance_m - 1e-6)
    });
    let boxed = problem.bounds.is_none_or(|b| {
        trajectory
            .points()
            .iter()
            .all(|p| b.excess_m(&p.position) < 1e-6)
    });
    Report {
        valid: clear && boxed,
    }
}
