//! The kit passes the baselines and catches planners that do not comply.

use auv_graph::Route;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{
    PathPlanner, PathProblem, PlanError, Planned, RoutePlanner, RouteProblem, Run, StopReason,
    Trajectory,
};
use auv_verify::conformance;

#[test]
fn the_baselines_comply() {
    let route = conformance::route_planner(&GreedyRoute);
    let path = conformance::path_planner(&StraightPath);
    assert!(route.is_ok(), "{}", route.unwrap_err());
    assert!(path.is_ok(), "{}", path.unwrap_err());
}

/// A baseline whose plans are spoilt.
struct Spoilt<F>(F);

impl<F: Fn(&mut Run<'_>, &mut Planned<Route>) + Send + Sync> RoutePlanner for Spoilt<F> {
    fn name(&self) -> &str {
        "spoilt"
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        let mut plan = GreedyRoute.plan_route(run, problem)?;
        (self.0)(run, &mut plan);
        Ok(plan)
    }
}

fn failed(spoil: impl Fn(&mut Run<'_>, &mut Planned<Route>) + Send + Sync) -> Vec<&'static str> {
    let failures = conformance::route_planner(&Spoilt(spoil)).unwrap_err().0;
    failures.into_iter().map(|failure| failure.check).collect()
}

#[test]
fn each_fault_of_a_route_planner_is_caught() {
    let calls = std::sync::atomic::AtomicU64::new(0);
    let random = failed(|_, plan| {
        let call = calls.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        plan.cost += 1e-13 * call as f64;
    });
    assert!(random.contains(&"same seed and budget give the same bits"));
    let uncounted = failed(|_, plan| plan.stats.evaluations += 1);
    assert!(uncounted.contains(&"the evaluation budget is exact"));
    let deaf = failed(|_, plan| plan.stats.stop = StopReason::Finished);
    assert!(deaf.contains(&"a cancelled run gives a plan"));
    let backwards = failed(|_, plan| {
        let nodes = plan.best.nodes().iter().rev().copied();
        plan.best = Route::new(nodes.collect());
    });
    assert!(backwards.contains(&"a plan called feasible is"));
    let optimist = failed(|_, plan| plan.violation = 0.0);
    assert!(optimist.contains(&"too little time gives the quickest route"));
    let panics = failed(|_, plan| assert!(plan.best.nodes().len() > 1, "no route"));
    assert_eq!(
        panics,
        [
            "start and destination may be one node",
            "tiny networks are solved"
        ]
    );
}

/// A path planner that ignores everything but start and target.
struct Blind;

impl PathPlanner for Blind {
    fn name(&self) -> &str {
        "blind"
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        let open = PathProblem::new(problem.start, problem.target, problem.vehicle);
        StraightPath.plan_path(run, &open)
    }
}

#[test]
fn a_blind_path_planner_is_caught() {
    let failures = conformance::path_planner(&Blind).unwrap_err().0;
    let checks: Vec<_> = failures.iter().map(|failure| failure.check).collect();
    for check in [
        "a plan called feasible is",
        "a blocked target is named",
        "a current too strong is not made good",
        "malformed input is refused",
    ] {
        assert!(checks.contains(&check), "{failures:?}");
    }
}
