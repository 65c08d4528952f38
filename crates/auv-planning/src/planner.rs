//! The two traits a planner implements.

use crate::{PathProblem, PlanError, Planned, RouteProblem, Run, Trajectory};
use auv_graph::Route;

/// Chooses which waypoints to visit in which order.
///
/// A call depends on its arguments alone: there is no set-up, and several threads may call one
/// planner at the same time.
pub trait RoutePlanner: Send + Sync {
    /// A short name for tables and logs.
    fn name(&self) -> &str;

    /// Plans one route within the run's budget.
    ///
    /// Where even the quickest route takes too long, that route is the answer, with `violation > 0`.
    /// The answer is never worse than the problem's incumbent.
    ///
    /// # Errors
    /// [`PlanError`] for a malformed, unsupported or unreachable problem only.
    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError>;
}

/// Finds a collision-free, flyable, quick trajectory for one leg.
pub trait PathPlanner: Send + Sync {
    /// A short name for tables and logs.
    fn name(&self) -> &str;

    /// Plans one trajectory within the run's budget.
    ///
    /// Where no feasible trajectory is found, the answer is the one of least violation found, with
    /// `violation > 0` and the obstacle that blocks it.
    ///
    /// # Errors
    /// [`PlanError`] for a malformed or unsupported problem only.
    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError>;
}

macro_rules! forward {
    ($trait:ident, $method:ident, $problem:ident, $plan:ty) => {
        forward!(@one $trait, $method, $problem, $plan, &P);
        forward!(@one $trait, $method, $problem, $plan, Box<P>);
        forward!(@one $trait, $method, $problem, $plan, std::sync::Arc<P>);
    };
    (@one $trait:ident, $method:ident, $problem:ident, $plan:ty, $pointer:ty) => {
        impl<P: $trait + ?Sized> $trait for $pointer {
            fn name(&self) -> &str {
                (**self).name()
            }

            fn $method(
                &self,
                run: &mut Run<'_>,
                problem: &$problem<'_>,
            ) -> Result<Planned<$plan>, PlanError> {
                (**self).$method(run, problem)
            }
        }
    };
}

forward!(RoutePlanner, plan_route, RouteProblem, Route);
forward!(PathPlanner, plan_path, PathProblem, Trajectory);
