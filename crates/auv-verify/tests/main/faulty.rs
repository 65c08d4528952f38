//! A planner with a fault. The missions of `examples/tests/broken_planners` are flown with it too.

use auv_graph::Route;
use auv_planning::{
    PathPlanner, PathProblem, PlanError, Planned, RoutePlanner, RouteProblem, Run, Trajectory,
};

/// A planner given by one function.
pub(crate) struct Faulty<F>(pub(crate) F);

impl<F> RoutePlanner for Faulty<F>
where
    F: Fn(&mut Run<'_>, &RouteProblem<'_>) -> Result<Planned<Route>, PlanError> + Send + Sync,
{
    fn name(&self) -> &str {
        "faulty"
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        (self.0)(run, problem)
    }
}

impl<F> PathPlanner for Faulty<F>
where
    F: Fn(&mut Run<'_>, &PathProblem<'_>) -> Result<Planned<Trajectory>, PlanError> + Send + Sync,
{
    fn name(&self) -> &str {
        "faulty"
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        (self.0)(run, problem)
    }
}
