//! Calling planners that may panic or claim what is not so.

use crate::{Command, Event, check};
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{PathPlanner, PlanError, Planned, RoutePlanner, Run};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Panics after which a planner is not called any more: a baseline answers in its place.
const PANICS: u32 = 3;

/// False claims in a row after which a baseline answers the next call.
const FALSE_CLAIMS: u32 = 3;

/// Who answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asked {
    /// The planner. Its claims are checked.
    Planner,
    /// A baseline in its place.
    StandIn,
}

/// The two planners of a driver, and how far each is to be trusted.
#[derive(Debug)]
pub(super) struct Planners<R, P> {
    pub(super) route: R,
    pub(super) path: P,
    route_record: Record,
    path_record: Record,
}

/// What a planner has done amiss.
#[derive(Debug, Default)]
struct Record {
    panics: AtomicU32,
    /// Plans in a row that were said to be feasible and are not.
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
        let begin_s = clock_s();
        let stand_in = asked == Asked::StandIn;
        match command {
            Command::PlanRoute(request) => {
                let mut run = Run::new(request.seed, request.budget).with_cancel(cancel);
                let problem = request.problem();
                let result = if stand_in || self.route_record.sits_out() {
                    GreedyRoute.plan_route(&mut run, &problem)
                } else {
                    let plan = || self.route.plan_route(&mut run, &problem);
                    let holds = |route: &_| check::route_is_valid(&problem, route);
                    self.route_record.keep("of routes", plan, holds)
                };
                Some(Event::RoutePlanned {
                    request: request.id,
                    result,
                    compute_s: clock_s() - begin_s,
                })
            }
            Command::PlanPath(request) => {
                let mut run = Run::new(request.seed, request.budget).with_cancel(cancel);
                let problem = request.problem();
                let result = if stand_in || self.path_record.sits_out() {
                    StraightPath.plan_path(&mut run, &problem)
                } else {
                    let plan = || self.path.plan_path(&mut run, &problem);
                    let holds = |path: &_| check::path_is_valid(&problem, path);
                    self.path_record.keep("of paths", plan, holds)
                };
                Some(Event::PathPlanned {
                    request: request.id,
                    result,
                    compute_s: clock_s() - begin_s,
                })
            }
            Command::Follow(_) | Command::Finished(_) => None,
        }
    }
}

impl Record {
    /// Whether a baseline answers this call. After too many false claims a planner sits out one call and
    /// has another chance: a baseline for good might never find a way round.
    fn sits_out(&self) -> bool {
        let claimed_falsely = self.false_claims.load(Ordering::Relaxed) >= FALSE_CLAIMS;
        if claimed_falsely {
            self.false_claims.store(FALSE_CLAIMS - 1, Ordering::Relaxed);
        }
        claimed_falsely || self.panics.load(Ordering::Relaxed) >= PANICS
    }

    /// Calls a planner. A panic becomes an error; it is counted, and so is a plan that is said to be
    /// feasible and does not hold.
    fn keep<T>(
        &self,
        what: &str,
        plan: impl FnOnce() -> Result<Planned<T>, PlanError>,
        holds: impl FnOnce(&T) -> bool,
    ) -> Result<Planned<T>, PlanError> {
        let result = catch_unwind(AssertUnwindSafe(plan)).unwrap_or_else(|_| {
            self.panics.fetch_add(1, Ordering::Relaxed);
            Err(failed(what, "it panicked"))
        });
        if let Ok(planned) = &result {
            let claimed = planned.violation <= 0.0 || planned.violation.is_nan();
            if claimed && (planned.cost.is_nan() || !holds(&planned.best)) {
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
