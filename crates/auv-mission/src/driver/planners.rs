//! Calling planners that may panic.

use crate::{Command, Event};
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{PathPlanner, PlanError, RoutePlanner, Run};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Panics after which a planner is not called any more: a baseline answers in its place.
const PANICS: u32 = 3;

/// The two planners of a driver, and how often each has panicked.
#[derive(Debug)]
pub(super) struct Planners<R, P> {
    pub(super) route: R,
    pub(super) path: P,
    route_panics: AtomicU32,
    path_panics: AtomicU32,
}

impl<R: RoutePlanner, P: PathPlanner> Planners<R, P> {
    pub(super) const fn new(route: R, path: P) -> Self {
        Self {
            route,
            path,
            route_panics: AtomicU32::new(0),
            path_panics: AtomicU32::new(0),
        }
    }

    /// The answer to a command that is a question. `stand_in`: by a baseline.
    pub(super) fn answer(
        &self,
        command: &Command,
        stand_in: bool,
        cancel: &AtomicBool,
        clock_s: &dyn Fn() -> f64,
    ) -> Option<Event> {
        let begin_s = clock_s();
        match command {
            Command::PlanRoute(request) => {
                let mut run = Run::new(request.seed, request.budget).with_cancel(cancel);
                let problem = request.problem();
                let result = if stand_in || is_lost(&self.route_panics) {
                    GreedyRoute.plan_route(&mut run, &problem)
                } else {
                    contained("of routes", &self.route_panics, || {
                        self.route.plan_route(&mut run, &problem)
                    })
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
                let result = if stand_in || is_lost(&self.path_panics) {
                    StraightPath.plan_path(&mut run, &problem)
                } else {
                    contained("of paths", &self.path_panics, || {
                        self.path.plan_path(&mut run, &problem)
                    })
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

fn is_lost(panics: &AtomicU32) -> bool {
    panics.load(Ordering::Relaxed) >= PANICS
}

/// A panic becomes an error; it is counted.
fn contained<T>(
    what: &str,
    panics: &AtomicU32,
    call: impl FnOnce() -> Result<T, PlanError>,
) -> Result<T, PlanError> {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|_| {
        panics.fetch_add(1, Ordering::Relaxed);
        Err(failed(what, "it panicked"))
    })
}

pub(super) fn failed(what: &str, reason: &str) -> PlanError {
    PlanError::Failed {
        planner: what.to_owned(),
        reason: reason.to_owned(),
    }
}
