//! Trajectories to start a search from.

use super::checks::{CheckResult, ensure};
use super::path_call::{START, TARGET, is_as_claimed, plan, regions};
use auv_planning::{PathPlanner, PathProblem, Score, Trajectory, Vehicle};
use auv_types::{Point3, Vector3};

/// With a warm start the plan is not worse than both the warm start and the plan without one.
pub(super) fn warm_start_does_no_harm(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    for seed in 0..4 {
        let regions = regions(40 + seed, 6);
        let problem = PathProblem {
            regions: &regions,
            departure_s: 100.0,
            ..PathProblem::new(START, TARGET, &vehicle)
        };
        let good = plan(planner, 600, &problem)?;
        let warm = PathProblem {
            warm_start: Some(&good.best),
            ..problem
        };
        for evaluations in [1, 50] {
            let with = plan(planner, evaluations, &warm)?;
            is_as_claimed(&warm, &with)?;
            let without = plan(planner, evaluations, &problem)?;
            let worst = good.score().max(without.score());
            let rounding = 1e-6 * (1.0 + worst.cost.abs());
            let limit = Score::new(worst.violation + 1e-9, worst.cost + rounding);
            ensure(with.score() <= limit, || {
                format!(
                    "gives {:?} from a warm start of {:?}; without it {:?}",
                    with.score(),
                    good.score(),
                    without.score()
                )
            })?;
        }
    }
    Ok(())
}

/// A warm start from elsewhere, at another time and speed is not taken for a plan.
pub(super) fn foreign_warm_start_is_harmless(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::default();
    let quick = Vehicle {
        speed_mps: 900.0,
        max_speed_mps: 900.0,
        ..Vehicle::paper()
    };
    let regions = regions(50, 6);
    let problem = PathProblem {
        regions: &regions,
        departure_s: 100.0,
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    let elsewhere = [
        vec![Point3::new(-5e3, 4e3, 10.0), Point3::new(7e3, 2e3, 90.0)],
        vec![START, START + Vector3::new(1.0, 0.0, 60.0), TARGET],
        vec![TARGET, START],
    ];
    for points in elsewhere {
        let other = PathProblem::new(points[0], points[points.len() - 1], &quick);
        let foreign: Trajectory = other.timed(&points).map_err(|error| error.to_string())?;
        let warm = PathProblem {
            warm_start: Some(&foreign),
            ..problem
        };
        for evaluations in [1, 300] {
            is_as_claimed(&warm, &plan(planner, evaluations, &warm)?)?;
        }
    }
    Ok(())
}
