//! Proven bounds beside the answers of a planner of routes.

use crate::note;
use auv_exact_route::ExactRoute;
use auv_graph::{EdgeId, Route};
use auv_planning::timed::LeftOut;
use auv_planning::{
    Budget, Objective, PlanError, Planned, RoutePlanner, RouteProblem, Run, edges_left_out,
};
use auv_types::Seed;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::Duration;

/// A proven bound of the cost under the most weight: the exact planner's, with an answer as incumbent. `None`
/// for an infeasible answer, and where no bound was proven in the time.
///
/// # Errors
/// Those of the exact planner, apart from what it does not support: that is noted.
pub fn proven_bound(
    planned: &Planned<Route>,
    problem: &RouteProblem<'_>,
    (seed, time): (Seed, Duration),
) -> Result<Option<f64>, PlanError> {
    if planned.violation > 0.0 {
        return Ok(None);
    }
    let problem = RouteProblem {
        incumbent: Some(&planned.best),
        objective: Objective::MostWeight,
        ..*problem
    };
    let mut run = Run::new(seed, Budget::wall_time(time));
    match ExactRoute::default().plan_route(&mut run, &problem) {
        Err(PlanError::Unsupported { what, .. }) => {
            note(&format!(
                "no bound: the exact planner does not support {what}"
            ));
            Ok(None)
        }
        proven => Ok(proven?.bound),
    }
}

/// A planner of routes whose answers are bounded afterwards. The answers stay as they are.
#[derive(Debug)]
pub struct Bounded<P> {
    planner: P,
    /// Wall time for each bound; `None`: none is computed.
    time: Option<Duration>,
    most: Mutex<Vec<Option<f64>>>,
    /// Of the first answer.
    left_out: OnceLock<Vec<(EdgeId, LeftOut)>>,
}

impl<P: RoutePlanner> Bounded<P> {
    /// A planner with so much wall time for each bound.
    pub fn new(planner: P, time: Option<Duration>) -> Self {
        Self {
            planner,
            time,
            most: Mutex::default(),
            left_out: OnceLock::new(),
        }
    }

    /// The most that a route may weigh, for each call so far; empty where no bounds are computed.
    pub fn most_weights(&self) -> Vec<Option<f64>> {
        self.most
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }
}

impl<P> Bounded<P> {
    /// What the first route leaves out, and why.
    pub fn left_out(&self) -> &[(EdgeId, LeftOut)] {
        self.left_out.get().map_or(&[], Vec::as_slice)
    }
}

impl<P: RoutePlanner> RoutePlanner for Bounded<P> {
    fn name(&self) -> &str {
        self.planner.name()
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        let answer = self.planner.plan_route(run, problem);
        if let Ok(planned) = &answer {
            let left_out = || edges_left_out(problem, &planned.best);
            self.left_out.get_or_init(left_out);
        }
        if let Some(time) = self.time {
            let planned = answer.as_ref().ok();
            let bound = planned.and_then(|p| proven_bound(p, problem, (run.seed(), time)).ok()?);
            let mut most = self.most.lock().unwrap_or_else(PoisonError::into_inner);
            most.push(bound.map(|cost| -cost));
        }
        answer
    }
}

/// What a bound is above a weight, in percent of the weight.
#[must_use]
pub fn gap_percent(most: f64, weight: f64) -> Option<f64> {
    (weight > 0.0).then(|| 100.0 * (most - weight).max(0.0) / weight)
}
