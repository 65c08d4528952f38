//! A path planner called on the kit's own waters.

use super::any_planner::figures_are_sound;
use super::checks::{CheckResult, ensure};
use crate::{PathViolation, verify_trajectory};
use auv_obstacles::{ObstacleId, Region};
use auv_planning::{Budget, PathPlanner, PathProblem, Planned, Run, Trajectory, Vehicle};
use auv_types::rand::RngExt;
use auv_types::{Point3, Seed, Vector3};

pub(super) const START: Point3<f64> = Point3::new(0.0, 0.0, 20.0);
pub(super) const TARGET: Point3<f64> = Point3::new(900.0, 300.0, 40.0);

/// Balls and cylinders along the straight line, at rest and in motion, none at its ends.
pub(super) fn regions(seed: u64, count: u32) -> Vec<Region> {
    let mut random = Seed(seed).stream(0);
    let mut draw = |low: f64, high: f64| random.random_range(low..high);
    (0..count)
        .map(|i| {
            let share = draw(0.2, 0.8);
            let aside = Vector3::new(draw(-80.0, 80.0), draw(-80.0, 80.0), draw(-15.0, 15.0));
            let centre = START + (TARGET - START) * share + aside;
            let mut region = if i % 4 == 3 {
                Region::cylinder(centre, draw(5.0, 30.0), 0.0, 30.0)
            } else {
                Region::ball(centre, draw(5.0, 50.0))
            };
            region.obstacle = ObstacleId(i + 1);
            if i % 2 == 1 {
                region.velocity_mps = Vector3::new(draw(-0.4, 0.4), draw(-0.4, 0.4), 0.0);
                region.growth_mps = draw(0.0, 0.05);
                region.at_s = 100.0;
            }
            region
        })
        .collect()
}

pub(super) fn run(evaluations: u64) -> Run<'static> {
    Run::new(Seed(12), Budget::evaluations(evaluations))
}

pub(super) fn plan(
    planner: &dyn PathPlanner,
    evaluations: u64,
    problem: &PathProblem<'_>,
) -> Result<Planned<Trajectory>, String> {
    planner
        .plan_path(&mut run(evaluations), problem)
        .map_err(|error| format!("gives an error for a sound problem: {error}"))
}

/// A plan called feasible is; any plan leads from the start at departure to the target.
pub(super) fn is_as_claimed(problem: &PathProblem<'_>, plan: &Planned<Trajectory>) -> CheckResult {
    figures_are_sound(plan)?;
    let report = verify_trajectory(problem, &plan.best);
    ensure(plan.violation > 0.0 || report.is_valid(), || {
        let first = report.violations.first();
        format!(
            "calls a trajectory feasible that {}",
            first.map_or_else(String::new, ToString::to_string)
        )
    })?;
    has_the_ends(problem, plan)
}

fn has_the_ends(problem: &PathProblem<'_>, plan: &Planned<Trajectory>) -> CheckResult {
    let (start, end) = (plan.best.start(), plan.best.end());
    let off_m = (start.position - problem.start).norm() + (end.position - problem.target).norm();
    ensure(
        off_m <= 2e-3 && (start.time_s - problem.departure_s).abs() <= 1e-6,
        || format!("leads from {start:?} to {end:?}"),
    )
}

/// Whatever a plan's violation, it leads from the start at departure to the target.
pub(super) fn leads_to_the_target(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    for (seed, departure_s) in [(31, 0.0), (32, 5e5)] {
        let regions = regions(seed, 6);
        let problem = PathProblem {
            regions: &regions,
            departure_s,
            ..PathProblem::new(START, TARGET, &vehicle)
        };
        for evaluations in [1, 60, 600] {
            has_the_ends(&problem, &plan(planner, evaluations, &problem)?)?;
        }
    }
    Ok(())
}

/// No plan called feasible breaks the limit that `is_broken` names, whatever the budget.
pub(super) fn keeps(
    planner: &dyn PathPlanner,
    problem: &PathProblem<'_>,
    is_broken: fn(&PathViolation) -> bool,
) -> CheckResult {
    for evaluations in [1, 20, 600] {
        let plan = plan(planner, evaluations, problem)?;
        if plan.violation > 0.0 {
            continue;
        }
        let report = verify_trajectory(problem, &plan.best);
        let broken = report
            .violations
            .iter()
            .find(|violation| is_broken(violation));
        ensure(broken.is_none(), || {
            let what = broken.map_or_else(String::new, ToString::to_string);
            format!("after {evaluations} evaluations calls a trajectory feasible that {what}")
        })?;
    }
    Ok(())
}
