//! Path planners that misread one thing of their problem, with the check of the kit meant for each. The missions of
//! `examples/tests/broken_planners` are flown with them too.

use auv_obstacles::Region;
use auv_ocean::{FlatBed, UniformCurrent};
use auv_planning::{PathPlanner, PathProblem, PlanError, Planned, Run, Trajectory, Vehicle};

type Answer = Result<Planned<Trajectory>, PlanError>;

/// A sound planner's answer to what was read.
pub(crate) type Misread = fn(&dyn PathPlanner, &mut Run<'_>, &PathProblem<'_>) -> Answer;

/// The checks, and the faults meant for them.
pub(crate) const MISREAD: [(&str, Misread); 17] = [
    ("the clearance is kept", |sound, run, problem| {
        let clearance_m = 0.0;
        sound.plan_path(
            run,
            &PathProblem {
                clearance_m,
                ..*problem
            },
        )
    }),
    ("moving regions are passed clear", |sound, run, problem| {
        among(sound, run, problem, |region| {
            region.centre += region.velocity_mps * (problem.departure_s - region.at_s);
            region.velocity_mps *= 0.0;
            region.at_s = problem.departure_s;
        })
    }),
    ("growing regions are passed clear", |sound, run, problem| {
        among(sound, run, problem, |region| region.growth_mps = 0.0)
    }),
    (
        "a region that appears later is passed clear",
        |sound, run, problem| {
            let mut regions = problem.regions.to_vec();
            regions.retain(|region| region.from_s <= problem.departure_s);
            sound.plan_path(
                run,
                &PathProblem {
                    regions: &regions,
                    ..*problem
                },
            )
        },
    ),
    (
        "a region that is gone is not in the way",
        |sound, run, problem| {
            let always = |region: &mut Region| {
                (region.from_s, region.until_s) = (f64::NEG_INFINITY, f64::INFINITY);
            };
            let mut plan = among(sound, run, problem, always)?;
            // A planner that finds its way round the region says that it did not.
            if problem
                .regions
                .iter()
                .any(|region| region.until_s.is_finite())
            {
                plan.violation += 1.0;
            }
            Ok(plan)
        },
    ),
    ("a flat bed is kept clear of", |sound, run, problem| {
        sound.plan_path(
            run,
            &PathProblem {
                sea_bed: None,
                ..*problem
            },
        )
    }),
    (
        "a bed that slopes is kept clear of",
        |sound, run, problem| {
            let depth_m = problem
                .sea_bed
                .map(|bed| bed.depth_at(problem.start.x, problem.start.y));
            let flat = depth_m.map(FlatBed::new);
            let sea_bed = flat.as_ref().map(|bed| bed as _);
            sound.plan_path(
                run,
                &PathProblem {
                    sea_bed,
                    ..*problem
                },
            )
        },
    ),
    (
        "an uncertain bed is kept clear of",
        |sound, run, problem| {
            let altitude_sigmas = 0.0;
            sound.plan_path(
                run,
                &PathProblem {
                    altitude_sigmas,
                    ..*problem
                },
            )
        },
    ),
    (
        "a place below the bed is not called feasible",
        |sound, run, problem| {
            let sea_bed = problem.sea_bed.filter(|_| problem.start != problem.target);
            sound.plan_path(
                run,
                &PathProblem {
                    sea_bed,
                    ..*problem
                },
            )
        },
    ),
    (
        "the speed through the water is kept",
        |sound, run, problem| {
            let speed_mps = problem.vehicle.max_speed_mps * 1.2;
            by(
                sound,
                run,
                problem,
                Vehicle {
                    speed_mps,
                    max_speed_mps: speed_mps,
                    ..*problem.vehicle
                },
            )
        },
    ),
    (
        "a current that turns is flown as it turns",
        |sound, run, problem| in_current_at(sound, run, problem, problem.departure_s),
    ),
    (
        "a current is flown as it is in each place",
        |sound, run, problem| in_current_at(sound, run, problem, 0.0),
    ),
    ("the turn radius is kept", |sound, run, problem| {
        by(
            sound,
            run,
            problem,
            Vehicle {
                turn_radius_m: 0.0,
                ..*problem.vehicle
            },
        )
    }),
    ("the pitch limit is kept", |sound, run, problem| {
        let max_pitch_rad = std::f64::consts::FRAC_PI_2;
        by(
            sound,
            run,
            problem,
            Vehicle {
                max_pitch_rad,
                ..*problem.vehicle
            },
        )
    }),
    ("the box is kept", |sound, run, problem| {
        sound.plan_path(
            run,
            &PathProblem {
                bounds: None,
                ..*problem
            },
        )
    }),
    ("a warm start does no harm", |sound, run, problem| {
        let mut plan = sound.plan_path(
            run,
            &PathProblem {
                warm_start: None,
                ..*problem
            },
        )?;
        if problem.warm_start.is_some() {
            plan.violation += 30.0;
        }
        Ok(plan)
    }),
    (
        "a warm start of another problem does no harm",
        |sound, run, problem| {
            let mut plan = sound.plan_path(run, problem)?;
            if let Some(warm) = problem.warm_start {
                (plan.best, plan.violation) = (warm.clone(), 0.0);
            }
            Ok(plan)
        },
    ),
];

/// Among changed regions.
fn among(
    sound: &dyn PathPlanner,
    run: &mut Run<'_>,
    problem: &PathProblem<'_>,
    change: impl Fn(&mut Region),
) -> Answer {
    let mut regions = problem.regions.to_vec();
    regions.iter_mut().for_each(change);
    sound.plan_path(
        run,
        &PathProblem {
            regions: &regions,
            ..*problem
        },
    )
}

/// By another vehicle.
fn by(
    sound: &dyn PathPlanner,
    run: &mut Run<'_>,
    problem: &PathProblem<'_>,
    vehicle: Vehicle,
) -> Answer {
    sound.plan_path(
        run,
        &PathProblem {
            vehicle: &vehicle,
            ..*problem
        },
    )
}

/// In the current as it is at the start at a time.
fn in_current_at(
    sound: &dyn PathPlanner,
    run: &mut Run<'_>,
    problem: &PathProblem<'_>,
    time_s: f64,
) -> Answer {
    let there = problem
        .current
        .map(|current| current.velocity_at(&problem.start, time_s));
    let uniform = there.map(UniformCurrent::new);
    let current = uniform.as_ref().map(|current| current as _);
    sound.plan_path(
        run,
        &PathProblem {
            current,
            ..*problem
        },
    )
}
