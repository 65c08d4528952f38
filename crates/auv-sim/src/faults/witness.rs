//! What must never happen, whatever goes wrong.

use auv_graph::Route;
use auv_mission::{Mission, PathCall, RouteCall};
use auv_planning::{
    PathPlanner, PathProblem, PlanError, Planned, RoutePlanner, RouteProblem, Run, Trajectory,
};
use std::sync::{Mutex, PoisonError};

/// Refused plans remembered, and for how long after the departure asked for, seconds: no driver hands
/// on an answer that is older. The same plan may be right for a later question.
const REMEMBERED: usize = 64;
const REMEMBERED_S: f64 = 60.0;

/// Sees every plan before the synchroniser does, and every trajectory that goes into force.
#[derive(Debug, Default)]
pub(super) struct Witness {
    /// Departures asked for, and paths that do not hold against the problem they were asked for.
    refused: Mutex<Vec<(f64, Trajectory)>>,
}

/// A planner watched by a witness.
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
        let holds = auv_verify::verify_trajectory(problem, &planned.best).is_valid();
        let mut refused = self
            .witness
            .refused
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        // What was wrong for one question may be right for another.
        refused.retain(|(_, plan)| *plan != planned.best);
        if planned.best.points().len() > 1 && !holds {
            if refused.len() >= REMEMBERED {
                refused.remove(0);
            }
            refused.push((problem.departure_s, planned.best.clone()));
        }
        Ok(planned)
    }
}

impl Witness {
    /// What is wrong with a trajectory that goes into force.
    pub(super) fn check_follow(&self, mission: &Mission, way: &Trajectory) -> Option<String> {
        let points = way.points();
        let refused = self.refused.lock().unwrap_or_else(PoisonError::into_inner);
        let recent = |asked_s: f64| points[0].time_s < asked_s + REMEMBERED_S;
        let contains = |(asked_s, plan): &(f64, Trajectory)| {
            let plan = plan.points();
            recent(*asked_s) && points.windows(plan.len()).any(|part| part == plan)
        };
        if refused.iter().any(contains) {
            return Some("a plan that does not hold went into force".into());
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
            ..PathProblem::new(points[0].position, way.end().position, &mission.vehicle)
        };
        let report = auv_verify::verify_motion(&problem, way);
        let worst = report.violations.first()?;
        Some(format!("a trajectory in force cannot be flown: {worst}"))
    }
}

/// What is wrong with the tables of a mission.
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
                "route call {} holds what is not a number",
                call.call
            ));
        }
        if call.adopted && !call.valid {
            return Some(format!(
                "route call {} adopted a route that does not hold",
                call.call
            ));
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
            return Some(format!("leg {} holds what is not a number", leg.call));
        }
    }
    None
}
