//! Plans do not depend on the number of threads.

use super::checks::{FailedCheck, FailedChecks, ensure, run_all};
use super::drawn_network::drawn_network;
use super::path_call::{START, TARGET, regions};
use auv_planning::{
    Budget, PathPlanner, PathProblem, PlanError, Planned, RoutePlanner, Run, Vehicle,
};
use auv_types::Seed;
use std::fmt::Debug;

const CHECK: &str = "the number of threads changes nothing";

/// Whether path planners that differ in nothing but their threads plan the same, bit for bit. Give one each
/// for 1, 2 and 8 threads.
///
/// # Errors
/// The check, with the plans that differ.
pub fn paths_on_threads(planners: &[&dyn PathPlanner]) -> Result<(), FailedChecks> {
    let vehicle = Vehicle::default();
    let regions = regions(2, 25);
    let problem = PathProblem {
        regions: &regions,
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    all_plan_the_same(planners.len(), &|i, run| {
        planners[i].plan_path(run, &problem)
    })
}

/// Whether route planners that differ in nothing but their threads plan the same, bit for bit. Give one
/// each for 1, 2 and 8 threads.
///
/// # Errors
/// The check, with the plans that differ.
pub fn routes_on_threads(planners: &[&dyn RoutePlanner]) -> Result<(), FailedChecks> {
    let drawn = drawn_network(5, 60, 0.5, false).map_err(|reason| {
        FailedChecks(vec![FailedCheck {
            check: "the kit's own network is sound",
            reason,
        }])
    })?;
    let problem = drawn.problem();
    all_plan_the_same(planners.len(), &|i, run| {
        planners[i].plan_route(run, &problem)
    })
}

/// Plans by the planner of an index.
type PlanBy<'a, T> = &'a dyn Fn(usize, &mut Run<'_>) -> Result<Planned<T>, PlanError>;

fn all_plan_the_same<T: PartialEq + Debug>(
    planners: usize,
    plan: PlanBy<'_, T>,
) -> Result<(), FailedChecks> {
    let same = || {
        for (seed, evaluations) in [(1, 1), (2, 60), (3, 700)] {
            let call = |i| {
                plan(
                    i,
                    &mut Run::new(Seed(seed), Budget::evaluations(evaluations)),
                )
                .map_err(|error| format!("gives an error for a sound problem: {error}"))
            };
            for other in 1..planners {
                let (first, again) = (call(0)?, call(other)?);
                ensure(first == again, || {
                    format!("planner {other} gives {again:?} instead of {first:?}")
                })?;
            }
        }
        Ok(())
    };
    FailedChecks::joined([run_all(&|_| (), &[(CHECK, &same)])])
}
