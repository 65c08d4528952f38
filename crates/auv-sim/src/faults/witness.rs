//! Checks of what must never happen under any fault.

use auv_graph::Route;
use auv_mission::{Mission, PathCall, RouteCall};
use auv_planning::{
    PathPlanner, PathProblem, PlanError, Planned, RoutePlanner, RouteProblem, Run, Trajectory,
};
use std::sync::{Mutex, PoisonError};

/// Number of refused plans remembered.
const REMEMBERED: usize = 64;
/// How long after its departure a refused plan is remembered, seconds. No driver delivers an older answer,
/// and the same plan may be valid for a later request.
const REMEMBERED_S: f64 = 60.0;

/// Checks every path before the synchroniser gets it, and every trajectory that goes into force.
#[derive(Debug, Default)]
pub(super) struct Witness {
    /// Paths that are invalid for the problem of their request, each with the requested departure in
    /// seconds.
    refused: Mutex<Vec<(f64, Trajectory)>>,
}

/// A planner whose answers a witness checks.
pub(super) struct Watched<'a, P> {
    pub(super) inner: P,
    pub(super) witness: &'a Witness,
}

impl<P: RoutePlanner> RoutePlanner for Watched<'_, P> {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        self.inner.plan_route(run, problem)
    }
}

impl<P: PathPlanner> PathPlanner for Watched<'_, P> {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        let planned = self.inner.plan_path(run, problem)?;
        let is_valid = auv_verify::verify_trajectory(problem, &planned.best).is_valid();
        let mut refused = self
            .witness
            .refused
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        // A plan that was invalid for an earlier problem may be valid for this one.
        refused.retain(|(_, plan)| *plan != planned.best);
        if planned.best.points().len() > 1 && !is_valid {
            if refused.len() >= REMEMBERED {
                refused.remove(0);
            }
            refused.push((problem.departure_s, planned.best.clone()));
        }
        Ok(planned)
    }
}

impl Witness {
    /// Checks a trajectory that goes into force; describes the failure if there is one.
    pub(super) fn check_follow(
        &self,
        mission: &Mission,
        trajectory: &Trajectory,
    ) -> Option<String> {
        let points = trajectory.points();
        let refused = self.refused.lock().unwrap_or_else(PoisonError::into_inner);
        let recent = |asked_s: f64| points[0].time_s < asked_s + REMEMBERED_S;
        let contains = |(asked_s, plan): &(f64, Trajectory)| {
            let plan = plan.points();
            recent(*asked_s) && points.windows(plan.len()).any(|part| part == plan)
        };
        if refused.iter().any(contains) {
            return Some("an invalid plan went into force".into());
        }
        let problem = PathProblem {
            departure_s: points[0].time_s,
            bounds: mission
                .bounds
                .map(|box_| box_.grown_to(&points[0].position)),
            sea_bed: mission.sea_bed.as_deref(),
            min_altitude_m: mission.min_altitude_m,
            altitude_sigmas: mission.altitude_sigmas,
            current: mission.current.as_deref(),
            ..PathProblem::new(
                points[0].position,
                trajectory.end().position,
                &mission.vehicle,
            )
        };
        let report = auv_verify::verify_motion(&problem, trajectory);
        let worst = report.violations.first()?;
        Some(format!("a trajectory in force cannot be flown: {worst}"))
    }
}

/// Checks the tables of a mission; describes the first failure.
pub(super) fn check_tables(routes: &[RouteCall], legs: &[PathCall]) -> Option<String> {
    let not_a_number = |values: &[f64]| values.iter().any(|x| x.is_nan());
    for call in routes {
        if not_a_number(&[
            call.cost,
            call.available_s,
            call.route_s,
            call.mission_weight,
        ]) {
            return Some(format!(
                "route call {} holds a value that is not a number",
                call.call
            ));
        }
        if call.adopted && !call.valid {
            return Some(format!("route call {} adopted an invalid route", call.call));
        }
    }
    for leg in legs {
        let values = [
            leg.cost,
            leg.violation,
            leg.leg_s,
            leg.available_s,
            leg.compute_s,
        ];
        if not_a_number(&values) {
            return Some(format!(
                "leg {} holds a value that is not a number",
                leg.call
            ));
        }
    }
    None
}
