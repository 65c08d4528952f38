//! Regions that move, grow, appear and go.

use super::checks::{CheckResult, ensure};
use super::path_call::{START, TARGET, is_as_claimed, keeps, plan};
use crate::PathViolation;
use auv_obstacles::{ObstacleId, Region};
use auv_planning::{PathPlanner, PathProblem, Vehicle};
use auv_types::{Point3, Vector3};

/// At 3 m/s the middle of the way is reached 159 s after departure.
const HALF_WAY_S: f64 = 159.0;

fn half_way() -> Point3<f64> {
    START + (TARGET - START) * 0.5
}

fn is_too_close(violation: &PathViolation) -> bool {
    matches!(violation, PathViolation::TooClose { .. })
}

/// The region alone is passed clear, by planners that look at it.
fn is_passed(planner: &dyn PathPlanner, region: Region, clearance_m: f64) -> CheckResult {
    let vehicle = Vehicle::paper();
    let regions = [Region {
        obstacle: ObstacleId(1),
        ..region
    }];
    let problem = PathProblem {
        regions: &regions,
        clearance_m,
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    keeps(planner, &problem, is_too_close)
}

/// Beside the straight line by less than the clearance.
pub(super) fn clearance_is_kept(planner: &dyn PathPlanner) -> CheckResult {
    let aside = Vector3::new(-12.0, 36.0, 0.0);
    is_passed(planner, Region::ball(half_way() + aside, 10.0), 40.0)
}

/// Off the straight line at departure, on it when the vehicle is there.
pub(super) fn moving_regions_are_passed(planner: &dyn PathPlanner) -> CheckResult {
    for side in [1.0, -1.0] {
        let velocity_mps = Vector3::new(-0.5, 1.5, 0.0) * side;
        let at_departure = half_way() - velocity_mps * HALF_WAY_S;
        let moving = Region {
            velocity_mps,
            ..Region::ball(at_departure, 40.0)
        };
        is_passed(planner, moving, 2.0)?;
    }
    Ok(())
}

/// Beside the straight line at departure, across it when the vehicle is there.
pub(super) fn growing_regions_are_passed(planner: &dyn PathPlanner) -> CheckResult {
    let aside = Vector3::new(-20.0, 60.0, 0.0);
    let growing = Region {
        growth_mps: 0.4,
        ..Region::ball(half_way() + aside, 10.0)
    };
    is_passed(planner, growing, 2.0)
}

/// There only while the vehicle passes, not at departure.
pub(super) fn later_regions_are_passed(planner: &dyn PathPlanner) -> CheckResult {
    let (from_s, until_s) = (0.6 * HALF_WAY_S, 2.0 * HALF_WAY_S);
    let later = Region {
        at_s: from_s,
        from_s,
        until_s,
        ..Region::ball(half_way(), 60.0)
    };
    is_passed(planner, later, 2.0)
}

/// Gone before the vehicle departs: the straight way is clear.
pub(super) fn past_regions_do_no_harm(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    let gone = Region {
        from_s: -500.0,
        until_s: -1.0,
        ..Region::ball(half_way(), 100.0)
    };
    let regions = [gone];
    let problem = PathProblem {
        regions: &regions,
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    let plan = plan(planner, 600, &problem)?;
    is_as_claimed(&problem, &plan)?;
    ensure(plan.violation == 0.0, || {
        format!("violation {} where the water is clear", plan.violation)
    })
}
