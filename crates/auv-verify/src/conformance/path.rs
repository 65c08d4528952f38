//! What any path planner must do.

use super::any_planner::{
    ends_soon_when_cancelled, figures_are_sound, gives_a_plan_when_cancelled,
    gives_a_plan_without_time, is_deterministic, keeps_the_budget,
};
use super::checks::{CheckResult, FailedChecks, ensure, run_all};
use crate::verify_trajectory;
use auv_obstacles::{ObstacleId, Region};
use auv_ocean::{FlatBed, UniformCurrent};
use auv_planning::{
    Budget, PathPlanner, PathProblem, PlanError, Planned, Run, Trajectory, Vehicle,
};
use auv_types::rand::RngExt;
use auv_types::{Bounds, Point3, Seed, Vector3};

const START: Point3<f64> = Point3::new(0.0, 0.0, 20.0);
const TARGET: Point3<f64> = Point3::new(900.0, 300.0, 40.0);

/// Runs all checks on a path planner; a few seconds at most for a planner of 10,000 evaluations a
/// second.
///
/// # Errors
/// Every check that fails, with what happened instead.
pub fn path_planner(planner: &dyn PathPlanner) -> Result<(), FailedChecks> {
    let vehicle = Vehicle::paper();
    let regions = regions(1, 8);
    let problem = PathProblem {
        regions: &regions,
        departure_s: 100.0,
        clearance_m: 2.0,
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    let plan = |run: &mut Run<'_>| planner.plan_path(run, &problem);
    run_all(&[
        ("same seed and budget give the same bits", &|| {
            is_deterministic(&plan)
        }),
        ("the evaluation budget is exact", &|| {
            keeps_the_budget(&plan)
        }),
        ("a cancelled run gives a plan", &|| {
            gives_a_plan_when_cancelled(&plan)
        }),
        ("a run ends soon after it is cancelled", &|| {
            ends_soon_when_cancelled(&plan)
        }),
        ("a run without time gives a plan", &|| {
            gives_a_plan_without_time(&plan)
        }),
        ("a plan called feasible is", &|| plans_are_valid(planner)),
        ("open water is crossed", &|| open_water_is_crossed(planner)),
        ("start and target may be one place", &|| {
            start_may_be_target(planner)
        }),
        ("a blocked target is named", &|| {
            blocked_target_is_named(planner)
        }),
        ("a current too strong is not made good", &|| {
            strong_current_is_not_made_good(planner)
        }),
        ("a NaN is refused", &|| nan_is_refused(planner)),
    ])
}

/// Balls and cylinders along the straight line, at rest and in motion, none at its ends.
fn regions(seed: u64, count: u32) -> Vec<Region> {
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

fn run(evaluations: u64) -> Run<'static> {
    Run::new(Seed(12), Budget::evaluations(evaluations))
}

fn plan(
    planner: &dyn PathPlanner,
    evaluations: u64,
    problem: &PathProblem<'_>,
) -> Result<Planned<Trajectory>, String> {
    planner
        .plan_path(&mut run(evaluations), problem)
        .map_err(|error| format!("gives an error for a sound problem: {error}"))
}

/// A plan called feasible is; any plan leads from the start at departure to the target.
fn is_as_claimed(problem: &PathProblem<'_>, plan: &Planned<Trajectory>) -> CheckResult {
    figures_are_sound(plan)?;
    let report = verify_trajectory(problem, &plan.best);
    ensure(plan.violation > 0.0 || report.is_valid(), || {
        let first = report.violations.first();
        format!(
            "calls a trajectory feasible that {}",
            first.map_or_else(String::new, ToString::to_string)
        )
    })?;
    let (start, end) = (plan.best.start(), plan.best.end());
    let off_m = (start.position - problem.start).norm() + (end.position - problem.target).norm();
    ensure(
        off_m <= 2e-3 && (start.time_s - problem.departure_s).abs() <= 1e-6,
        || format!("leads from {start:?} to {end:?}"),
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
        plans_at_sea_are_valid(planner, &open)?;
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

/// With sea bed, current and a vehicle of limited turn and pitch.
fn plans_at_sea_are_valid(planner: &dyn PathPlanner, open: &PathProblem<'_>) -> CheckResult {
    let (bed, shallow) = (FlatBed::new(60.0), FlatBed::new(42.0));
    let current = UniformCurrent::new(Vector3::new(-0.3, 0.2, 0.0));
    let vehicle = Vehicle::default();
    let sea = PathProblem {
        vehicle: &vehicle,
        sea_bed: Some(&bed),
        min_altitude_m: 5.0,
        current: Some(&current),
        clearance_m: 5.0,
        start_velocity: Some(Vector3::new(0.0, 1.5, 0.0)),
        ..*open
    };
    let too_shallow = PathProblem {
        sea_bed: Some(&shallow),
        ..sea
    };
    let too_steep = PathProblem {
        target: TARGET + Vector3::new(-800.0, -250.0, 50.0),
        ..sea
    };
    for (name, problem) in [
        ("at sea", sea),
        ("too shallow", too_shallow),
        ("too steep", too_steep),
    ] {
        every_budget_is_as_claimed(planner, name, &problem)?;
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
    ensure(
        plan.violation > 0.0 && plan.blocked_by == Some(over.obstacle),
        || {
            format!(
                "violation {}, blocked by {:?}",
                plan.violation, plan.blocked_by
            )
        },
    )
}

fn strong_current_is_not_made_good(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    let current = UniformCurrent::new(Vector3::new(-4.0, 0.0, 0.0));
    let problem = PathProblem {
        current: Some(&current),
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    match planner.plan_path(&mut run(100), &problem) {
        Ok(plan) => ensure(plan.violation > 0.0, || "calls it feasible".into()),
        Err(PlanError::Invalid(error)) => Err(format!("calls a sound problem malformed: {error}")),
        Err(_) => Ok(()),
    }
}

fn nan_is_refused(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    let without_speed = Vehicle {
        speed_mps: f64::NAN,
        ..vehicle
    };
    let nowhere = Point3::new(0.0, f64::NAN, 0.0);
    let bad = [Region::ball(START, f64::NAN)];
    type Spoil<'a> = (&'a str, &'a dyn Fn(&mut PathProblem<'_>));
    let spoils: [Spoil<'_>; 4] = [
        ("start", &|problem| problem.start = nowhere),
        ("target", &|problem| problem.target = nowhere),
        ("departure_s", &|problem| problem.departure_s = f64::NAN),
        ("clearance_m", &|problem| problem.clearance_m = f64::NAN),
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
