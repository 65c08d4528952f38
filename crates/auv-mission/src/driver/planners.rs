//! Calls of planners that may panic or call a plan feasible that is not.

use crate::{Command, Event, check};
use auv_graph::Route;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{PathPlanner, PlanError, Planned, RoutePlanner, RouteProblem, Run};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Panics after which a planner is not called again: a baseline answers in its place.
const PANICS: u32 = 3;

/// Plans in a row falsely called feasible after which a baseline answers the next call.
const FALSE_CLAIMS: u32 = 3;

/// Who answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asked {
    /// The planner. Its plans are verified.
    Planner,
    /// A baseline in its place.
    Baseline,
}

/// The two planners of a driver, and the failures of each.
#[derive(Debug)]
pub(super) struct Planners<R, P> {
    pub(super) route: R,
    pub(super) path: P,
    route_record: Record,
    path_record: Record,
}

/// Failures of a planner.
#[derive(Debug, Default)]
struct Record {
    panics: AtomicU32,
    /// Plans in a row that were called feasible and are not.
    false_claims: AtomicU32,
}

impl<R: RoutePlanner, P: PathPlanner> Planners<R, P> {
    pub(super) fn new(route: R, path: P) -> Self {
        Self {
            route,
            path,
            route_record: Record::default(),
            path_record: Record::default(),
        }
    }

    /// The answer to a command that is a question.
    pub(super) fn answer(
        &self,
        command: &Command,
        asked: Asked,
        cancel: &AtomicBool,
        clock_s: &dyn Fn() -> f64,
    ) -> Option<Event> {
        let start_s = clock_s();
        let by_baseline = asked == Asked::Baseline;
        match command {
            Command::PlanRoute(request) => {
                let mut run = Run::new(request.seed, request.budget).with_cancel(cancel);
                let problem = request.problem();
                let result = if by_baseline || self.route_record.is_skipped() {
                    GreedyRoute.plan_route(&mut run, &problem)
                } else {
                    let plan = || plan_route(&self.route, &mut run, &problem);
                    let holds = |planned: &_| check::route_is_valid(&problem, planned);
                    self.route_record.call("of routes", plan, holds)
                };
                Some(Event::RoutePlanned {
                    request: request.id,
                    result,
                    compute_s: clock_s() - start_s,
                })
            }
            Command::PlanPath(request) => {
                let mut run = Run::new(request.seed, request.budget).with_cancel(cancel);
                let problem = request.problem();
                let result = if by_baseline || self.path_record.is_skipped() {
                    StraightPath.plan_path(&mut run, &problem)
                } else {
                    let plan = || self.path.plan_path(&mut run, &problem);
                    let holds =
                        |planned: &Planned<_>| check::path_is_valid(&problem, &planned.best);
                    self.path_record.call("of paths", plan, holds)
                };
                Some(Event::PathPlanned {
                    request: request.id,
                    result,
                    compute_s: clock_s() - start_s,
                })
            }
            Command::Follow(_) | Command::Finished(_) => None,
        }
    }
}

/// Asks a planner. One that knows no travel times by departure is asked with those of a departure at once: its
/// answer is verified against all of them.
fn plan_route(
    planner: &impl RoutePlanner,
    run: &mut Run<'_>,
    problem: &RouteProblem<'_>,
) -> Result<Planned<Route>, PlanError> {
    match planner.plan_route(run, problem) {
        Err(PlanError::NotInTime) => {
            let at_once = RouteProblem {
                time_model: None,
                ..*problem
            };
            planner.plan_route(run, &at_once)
        }
        answer => answer,
    }
}

impl Record {
    /// Whether a baseline answers this call. A planner with too many false claims is skipped for one call
    /// only: a baseline alone might never find a path round an obstacle.
    fn is_skipped(&self) -> bool {
        let claimed_falsely = self.false_claims.load(Ordering::Relaxed) >= FALSE_CLAIMS;
        if claimed_falsely {
            self.false_claims.store(FALSE_CLAIMS - 1, Ordering::Relaxed);
        }
        claimed_falsely || self.panics.load(Ordering::Relaxed) >= PANICS
    }

    /// Calls a planner and counts its failures. A panic becomes an error.
    fn call<T>(
        &self,
        what: &str,
        plan: impl FnOnce() -> Result<Planned<T>, PlanError>,
        holds: impl FnOnce(&Planned<T>) -> bool,
    ) -> Result<Planned<T>, PlanError> {
        let result = catch_unwind(AssertUnwindSafe(plan)).unwrap_or_else(|_| {
            self.panics.fetch_add(1, Ordering::Relaxed);
            Err(failed(what, "it panicked"))
        });
        if let Ok(planned) = &result {
            // NaN is refused, and claims nothing that holds.
            let no_number = planned.cost.is_nan() || planned.violation.is_nan();
            let claimed = planned.violation <= 0.0;
            if no_number || claimed && !holds(planned) {
                self.false_claims.fetch_add(1, Ordering::Relaxed);
            } else {
                self.false_claims.store(0, Ordering::Relaxed);
            }
        }
        result
    }
}

pub(super) fn failed(what: &str, reason: &str) -> PlanError {
    PlanError::Failed {
        planner: what.to_owned(),
        reason: reason.to_owned(),
    }
}
