//! What any path planner must do.

use super::any_planner::checks_of_any_planner;
use super::checks::{CheckResult, FailedCheck, FailedChecks, ensure, run_all};
use super::malformed_paths::{extremes_do_no_harm, malformed_is_refused};
use super::path_call::{START, TARGET, is_as_claimed, leads_to_the_target, plan, regions};
use super::warm_starts::{foreign_warm_start_is_harmless, warm_start_does_no_harm};
use super::watch::ended_within;
use super::{path_at_sea as sea, path_regions as among};
use auv_obstacles::{ObstacleId, Region};
use auv_planning::{PathPlanner, PathProblem, Vehicle};
use auv_types::{Bounds, Point3};
use std::sync::Arc;
use std::time::Duration;

/// Runs all checks on a path planner; some seconds at most for a planner of 10,000 evaluations a
/// second. A planner that never ends makes it hang: see [`path_planner_within`].
///
/// # Errors
/// Every check that fails, with what happened instead.
pub fn path_planner(planner: &dyn PathPlanner) -> Result<(), FailedChecks> {
    checked(planner, &|_| ())
}

/// [`path_planner`] on a thread of its own. Where it has not ended within `limit`, the check that hangs is
/// the one that fails, and the thread is left behind.
///
/// # Errors
/// Every check that fails, with what happened instead.
pub fn path_planner_within(
    planner: Arc<dyn PathPlanner>,
    limit: Duration,
) -> Result<(), FailedChecks> {
    ended_within(limit, move |began| checked(&planner, began))
}

fn checked(planner: &dyn PathPlanner, began: &dyn Fn(&'static str)) -> Result<(), FailedChecks> {
    let vehicle = Vehicle::paper();
    let (few, many) = (regions(1, 8), regions(2, 25));
    let easy = PathProblem {
        regions: &few,
        departure_s: 100.0,
        clearance_m: 2.0,
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    let crowded = PathProblem {
        regions: &many,
        ..easy
    };
    let of_any_planner =
        checks_of_any_planner(began, &|run| planner.plan_path(run, &easy), &|run| {
            planner.plan_path(run, &crowded)
        });
    let of_paths = checks_of_paths(planner, began);
    let of_the_sea = sea::checks_at_sea(planner, began);
    FailedChecks::joined([of_any_planner, of_paths, of_the_sea])
}

fn checks_of_paths(planner: &dyn PathPlanner, began: &dyn Fn(&'static str)) -> Vec<FailedCheck> {
    run_all(
        began,
        &[
            ("a plan called feasible is", &|| plans_are_valid(planner)),
            ("a plan leads from start to target", &|| {
                leads_to_the_target(planner)
            }),
            ("open water is crossed", &|| open_water_is_crossed(planner)),
            ("start and target may be one place", &|| {
                start_may_be_target(planner)
            }),
            ("a blocked target is named", &|| {
                blocked_target_is_named(planner)
            }),
            ("a blocked start is told", &|| {
                blocked_start_is_told(planner)
            }),
            ("the clearance is kept", &|| {
                among::clearance_is_kept(planner)
            }),
            ("moving regions are passed clear", &|| {
                among::moving_regions_are_passed(planner)
            }),
            ("growing regions are passed clear", &|| {
                among::growing_regions_are_passed(planner)
            }),
            ("a region that appears later is passed clear", &|| {
                among::later_regions_are_passed(planner)
            }),
            ("a region that is gone is not in the way", &|| {
                among::past_regions_do_no_harm(planner)
            }),
            ("a warm start does no harm", &|| {
                warm_start_does_no_harm(planner)
            }),
            ("a warm start of another problem does no harm", &|| {
                foreign_warm_start_is_harmless(planner)
            }),
            ("malformed input is refused", &|| {
                malformed_is_refused(planner)
            }),
            ("extreme values do no harm", &|| {
                extremes_do_no_harm(planner)
            }),
        ],
    )
}

fn plans_are_valid(planner: &dyn PathPlanner) -> CheckResult {
    for seed in 0..4 {
        let regions = regions(20 + seed, 2 + 3 * seed as u32);
        let simple = Vehicle::paper();
        let open = PathProblem {
            regions: &regions,
            departure_s: 100.0,
            bounds: Some(Bounds::new(
                Point3::new(-200.0, -300.0, 3.0),
                Point3::new(1_200.0, 700.0, 100.0),
            )),
            ..PathProblem::new(START, TARGET, &simple)
        };
        let out_of_the_box = PathProblem {
            target: Point3::new(1_300.0, 0.0, 20.0),
            ..open
        };
        for (name, problem) in [
            ("among obstacles", open),
            ("out of the box", out_of_the_box),
        ] {
            every_budget_is_as_claimed(planner, name, &problem)?;
        }
    }
    Ok(())
}

fn every_budget_is_as_claimed(
    planner: &dyn PathPlanner,
    name: &str,
    problem: &PathProblem<'_>,
) -> CheckResult {
    for evaluations in [1, 20, 600] {
        let plan = plan(planner, evaluations, problem)?;
        is_as_claimed(problem, &plan)
            .map_err(|reason| format!("{name}, {evaluations} evaluations: {reason}"))?;
    }
    Ok(())
}

fn open_water_is_crossed(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    let problem = PathProblem::new(START, TARGET, &vehicle);
    let plan = plan(planner, 2_000, &problem)?;
    is_as_claimed(&problem, &plan)?;
    let straight_s = (TARGET - START).norm() / vehicle.speed_mps;
    ensure(
        plan.violation == 0.0 && plan.best.duration_s() < 1.2 * straight_s,
        || {
            format!(
                "takes {} s, the straight line {straight_s} s",
                plan.best.duration_s()
            )
        },
    )
}

fn start_may_be_target(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    let problem = PathProblem::new(START, START, &vehicle);
    let plan = plan(planner, 50, &problem)?;
    is_as_claimed(&problem, &plan)?;
    ensure(plan.violation == 0.0, || {
        format!(
            "violation {} where start and target are one",
            plan.violation
        )
    })
}

fn blocked_target_is_named(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    let mut over = Region::ball(TARGET, 50.0);
    over.obstacle = ObstacleId(9);
    let mut regions = regions(5, 2);
    regions.iter_mut().for_each(|region| region.radius_m = 1.0);
    regions.push(over);
    let problem = PathProblem {
        regions: &regions,
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    let plan = plan(planner, 300, &problem)?;
    is_as_claimed(&problem, &plan)?;
    ensure(plan.blocked_by == Some(over.obstacle), || {
        format!(
            "violation {}, blocked by {:?}",
            plan.violation, plan.blocked_by
        )
    })
}

fn blocked_start_is_told(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    let regions = [Region::ball(START, 40.0)];
    let problem = PathProblem {
        regions: &regions,
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    is_as_claimed(&problem, &plan(planner, 300, &problem)?)
}
