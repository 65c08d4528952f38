//! The verifier's verdict on plans.

use auv_graph::{Route, RouteTotals, TimeModel};
use auv_planning::timed::schedule_at_once;
use auv_planning::{PathProblem, PlanError, Planned, RouteProblem, Schedule, Trajectory};
use auv_types::Vector3;
use auv_verify::{EndState, RequiredEnds, WayOn};

/// Who decides whether a plan may go into force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Acceptor {
    /// `auv-verify`, against the question that was asked.
    Verifier,
    /// Nobody: the verdict is recorded and the plan flown. For the scripted replay of the paper's
    /// Table 2 only.
    #[cfg(test)]
    AsClaimed,
}

impl Acceptor {
    pub(crate) fn takes_unverified(self) -> bool {
        self != Self::Verifier
    }
}

/// No planner computes longer, seconds.
const LONGEST_COMPUTE_S: f64 = 1e6;

/// A planner's answer and its computing time. A plan whose cost or violation is not a number is an
/// error; a computing time that is not finite is 0, one that no planner takes is cut.
pub(crate) fn in_numbers<T>(
    result: Result<Planned<T>, PlanError>,
    compute_s: f64,
) -> (Result<Planned<T>, PlanError>, f64) {
    let result = result.and_then(|planned| {
        if planned.cost.is_nan() || planned.violation.is_nan() {
            return Err(PlanError::Failed {
                planner: "asked".into(),
                reason: "its cost or violation is not a number".into(),
            });
        }
        Ok(planned)
    });
    let compute_s = if compute_s.is_finite() {
        compute_s.clamp(-LONGEST_COMPUTE_S, LONGEST_COMPUTE_S)
    } else {
        0.0
    };
    (result, compute_s)
}

/// Whether a route meets all criteria of the problem it was asked for. One that does tasks with windows and order
/// comes with its schedule. Where only travel times depend on the departure it leaves every waypoint at once, and
/// what waits there counts as travel.
pub(crate) fn route_is_valid(problem: &RouteProblem<'_>, planned: &Planned<Route>) -> bool {
    let route = &planned.best;
    match (problem.time_model, &planned.schedule) {
        (None, _) => auv_verify::verify_route(problem, route).is_valid(),
        (Some(model), _) if model.tasks.is_empty() => keeps_profiles(problem, model, route),
        (Some(_), None) => false,
        (Some(_), Some(schedule)) => route_keeps_times(problem, route, schedule),
    }
}

/// Whether a route without tasks of the model meets all criteria if it leaves every waypoint at once.
fn keeps_profiles(problem: &RouteProblem<'_>, model: &TimeModel, route: &Route) -> bool {
    let mut nodes = route.nodes().iter();
    nodes.all(|&node| problem.network.has_node(node))
        && route_keeps_times(problem, route, &schedule_at_once(problem, model, route))
}

/// Whether a route in time keeps to everything of the problem with its schedule.
pub(crate) fn route_keeps_times(
    problem: &RouteProblem<'_>,
    route: &Route,
    schedule: &Schedule,
) -> bool {
    let (_, broken) = auv_verify::verify_route_in_time(problem, route, schedule);
    broken.is_empty()
}

/// What a valid route without tasks of a time model adds up to.
pub(crate) fn route_totals(problem: &RouteProblem<'_>, route: &Route) -> Option<RouteTotals> {
    let Some(model) = problem.time_model else {
        return problem.check(route).ok();
    };
    if !keeps_profiles(problem, model, route) {
        return None;
    }
    let totals = problem
        .network
        .evaluate(route, problem.removed, problem.times)
        .ok()?;
    Some(RouteTotals {
        time_s: schedule_at_once(problem, model, route).end_s,
        ..totals
    })
}

/// Whether a path meets the whole problem it was asked for.
pub(crate) fn path_is_valid(problem: &PathProblem<'_>, path: &Trajectory) -> bool {
    auv_verify::verify_trajectory(problem, path).is_valid()
}

/// Whether the vehicle can fly a trajectory within turn radius, pitch and speed, wherever that leads.
pub(crate) fn can_be_steered(problem: &PathProblem<'_>, trajectory: &Trajectory) -> bool {
    let open = PathProblem {
        bounds: None,
        sea_bed: None,
        ..*problem
    };
    is_flyable(&open, trajectory)
}

/// Whether a trajectory keeps to everything of a problem but its ends.
pub(crate) fn is_free(problem: &PathProblem<'_>, trajectory: &Trajectory) -> bool {
    auv_verify::verify_motion(problem, trajectory).is_valid()
}

/// Whether the vehicle, at the start of a trajectory with a velocity, can go on along it within box, bed,
/// turn radius, pitch and speed, clear of the problem's regions.
pub(crate) fn leads_on(
    problem: &PathProblem<'_>,
    velocity: Vector3<f64>,
    trajectory: &Trajectory,
) -> bool {
    let ends = RequiredEnds {
        start: Some(trajectory.start()),
        start_velocity: Some(velocity),
        target: None,
    };
    auv_verify::verify_part(problem, &ends, trajectory).is_valid()
}

/// Whether a whole trajectory, followed until `ends_s`, leaves a safe end in hand for at least `lasts_s` after.
pub(crate) fn has_way_on(
    problem: &PathProblem<'_>,
    whole: &Trajectory,
    (ends_s, lasts_s): (f64, f64),
    end: EndState,
) -> bool {
    let asked = WayOn {
        ends_s,
        lasts_s,
        end,
    };
    auv_verify::verify_way_on(problem, whole, &asked).is_valid()
}

/// Whether the vehicle can fly a trajectory within box, bed, turn radius, pitch and speed. Start, target
/// and obstacles of the problem are not checked.
pub(crate) fn is_flyable(problem: &PathProblem<'_>, trajectory: &Trajectory) -> bool {
    let motion = PathProblem {
        regions: &[],
        ..*problem
    };
    is_free(&motion, trajectory)
}

#[cfg(test)]
mod tests;
