//! Input that no path planner can use, and input at its limits.

use super::any_planner::figures_are_sound;
use super::checks::{CheckResult, ensure};
use super::path_call::{START, TARGET, run};
use crate::verify_trajectory;
use auv_obstacles::Region;
use auv_planning::{PathPlanner, PathProblem, PlanError, Vehicle};
use auv_types::{Bounds, Point3, Vector3};

pub(super) fn malformed_is_refused(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    let without_speed = Vehicle {
        speed_mps: f64::NAN,
        ..vehicle
    };
    let nowhere = Point3::new(0.0, f64::NAN, 0.0);
    let bad = [Region::ball(START, f64::NAN)];
    type Spoil<'a> = (&'a str, &'a dyn Fn(&mut PathProblem<'_>));
    let spoils: [Spoil<'_>; 8] = [
        ("start", &|problem| problem.start = nowhere),
        ("target", &|problem| problem.target = nowhere),
        ("departure_s", &|problem| problem.departure_s = f64::NAN),
        ("clearance_m", &|problem| problem.clearance_m = f64::NAN),
        ("clearance_m below 0", &|problem| problem.clearance_m = -1.0),
        ("min_altitude_m", &|problem| {
            problem.min_altitude_m = f64::NAN;
        }),
        ("start_velocity", &|problem| {
            problem.start_velocity = Some(Vector3::new(1e300, 1.0, 0.0));
        }),
        ("bounds", &|problem| {
            problem.bounds = Some(Bounds {
                low: TARGET,
                high: START,
            });
        }),
    ];
    let problem = PathProblem::new(START, TARGET, &vehicle);
    let mut malformed = vec![
        (
            "region",
            PathProblem {
                regions: &bad,
                ..problem
            },
        ),
        (
            "vehicle",
            PathProblem {
                vehicle: &without_speed,
                ..problem
            },
        ),
    ];
    for (what, spoil) in spoils {
        let mut problem = problem;
        spoil(&mut problem);
        malformed.push((what, problem));
    }
    for (what, problem) in malformed {
        match planner.plan_path(&mut run(50), &problem) {
            Err(PlanError::Invalid(_)) => {}
            other => return Err(format!("malformed {what}: gives {other:?}")),
        }
    }
    Ok(())
}

/// Far places, tiny and huge limits, a region around everything: a sound plan or an error, never a
/// panic, a NaN or a false claim.
pub(super) fn extremes_do_no_harm(planner: &dyn PathPlanner) -> CheckResult {
    let usual = Vehicle::default();
    let slow = Vehicle {
        speed_mps: 1e-3,
        min_speed_mps: 0.0,
        max_speed_mps: 1e-3,
        ..usual
    };
    let clumsy = Vehicle {
        turn_radius_m: 1e5,
        max_pitch_rad: 0.01,
        ..usual
    };
    let around = [Region::ball(START, 1e6)];
    type Change<'a> = (&'a str, &'a dyn Fn(&mut PathProblem<'_>));
    let places: [Change<'_>; 4] = [
        ("a far target", &|to| {
            to.target = Point3::new(9e6, -9e6, 5e3)
        }),
        ("a near target", &|to| {
            to.target = START + Vector3::x() * 1e-9
        }),
        ("a late departure", &|to| to.departure_s = 1e9),
        ("a box of one point", &|to| {
            to.bounds = Some(Bounds::new(START, START))
        }),
    ];
    let open = PathProblem::new(START, TARGET, &usual);
    for (name, change) in places {
        let mut problem = open;
        change(&mut problem);
        is_sound_or_refused(planner, name, &problem)?;
    }
    let covered = PathProblem {
        regions: &around,
        clearance_m: 1e6,
        ..open
    };
    is_sound_or_refused(planner, "a region around everything", &covered)?;
    for (name, vehicle) in [("a slow vehicle", slow), ("a clumsy vehicle", clumsy)] {
        let problem = PathProblem {
            vehicle: &vehicle,
            ..open
        };
        is_sound_or_refused(planner, name, &problem)?;
    }
    Ok(())
}

fn is_sound_or_refused(
    planner: &dyn PathPlanner,
    name: &str,
    problem: &PathProblem<'_>,
) -> CheckResult {
    let Ok(plan) = planner.plan_path(&mut run(60), problem) else {
        return Ok(());
    };
    figures_are_sound(&plan).map_err(|reason| format!("{name}: {reason}"))?;
    let report = verify_trajectory(problem, &plan.best);
    ensure(plan.violation > 0.0 || report.is_valid(), || {
        let first = report.violations.first();
        format!("{name}: calls a trajectory feasible: {first:?}")
    })
}
