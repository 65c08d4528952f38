//! Faults of path planners. Each is the default planner with its problem or its plan spoilt.

use super::{assert_caught, assert_harmless, pause};
use auv_ga_route::GaRoute;
use auv_ocean::{FlatBed, UniformCurrent};
use auv_planning::{PathPlanner, PathProblem, PlanError, Planned, Run, Trajectory, Vehicle};
use auv_pso_path::PsoPath;
use auv_types::Seed;
use auv_verify::conformance;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

type Answer = Result<Planned<Trajectory>, PlanError>;

/// A planner given by one function.
struct Faulty<F>(F);

impl<F: Fn(&mut Run<'_>, &PathProblem<'_>) -> Answer + Send + Sync> PathPlanner for Faulty<F> {
    fn name(&self) -> &str {
        "faulty"
    }

    fn plan_path(&self, run: &mut Run<'_>, problem: &PathProblem<'_>) -> Answer {
        (self.0)(run, problem)
    }
}

fn sound(run: &mut Run<'_>, problem: &PathProblem<'_>) -> Answer {
    PsoPath::default().plan_path(run, problem)
}

/// The kit catches the fault, and a mission flown with it hits nothing.
fn caught(check: &str, fault: impl Fn(&mut Run<'_>, &PathProblem<'_>) -> Answer + Send + Sync) {
    let planner = Faulty(fault);
    assert_caught(conformance::path_planner(&planner), check);
    assert_harmless(&GaRoute::default(), &planner, check);
}

/// The default planner whose every plan is changed.
fn caught_in_plans(
    check: &str,
    spoil: impl Fn(&mut Planned<Trajectory>, &PathProblem<'_>) + Send + Sync,
) {
    caught(check, |run, problem| {
        let mut plan = sound(run, problem)?;
        spoil(&mut plan, problem);
        Ok(plan)
    });
}

#[test]
fn the_sound_planner_complies_and_ends() {
    let planner = Arc::new(Faulty(sound));
    let outcome = conformance::path_planner_within(planner, Duration::from_secs(60));
    assert!(outcome.is_ok(), "{}", outcome.unwrap_err());
}

#[test]
fn a_panic() {
    caught("start and target may be one place", |run, problem| {
        assert!(problem.start != problem.target, "on purpose");
        sound(run, problem)
    });
}

#[test]
fn a_hang() {
    let planner = Arc::new(Faulty(|run: &mut Run<'_>, problem: &PathProblem<'_>| {
        while problem.warm_start.is_some() {
            pause(50);
        }
        sound(run, problem)
    }));
    let outcome = conformance::path_planner_within(planner, Duration::from_secs(8));
    assert_caught(outcome, "a warm start does no harm");
}

#[test]
fn a_cost_or_violation_that_is_nan() {
    caught_in_plans("cost and violation are finite", |plan, _| {
        plan.cost = f64::NAN
    });
    caught_in_plans("cost and violation are finite", |plan, _| {
        plan.violation = f64::NAN;
    });
}

#[test]
fn an_answer_long_after_the_deadline() {
    let late = Faulty(|run: &mut Run<'_>, problem: &PathProblem<'_>| {
        if run.has_deadline() {
            pause(3_200);
        }
        sound(run, problem)
    });
    let outcome = conformance::path_planner(&late);
    assert_caught(outcome, "a run ends soon after its deadline");
}

#[test]
fn another_answer_at_each_call() {
    let calls = AtomicU64::new(0);
    caught("same seed and budget give the same bits", |run, problem| {
        let mut plan = sound(run, problem)?;
        plan.cost += 1e-9 * calls.fetch_add(1, Ordering::Relaxed) as f64;
        Ok(plan)
    });
}

#[test]
fn a_seed_of_its_own_that_moves_on_with_each_problem() {
    // The same problem twice in a row gives the same plan: only another one in between shows it.
    let last = std::sync::Mutex::new((0_usize, 0_u64));
    caught(
        "another problem in between changes nothing",
        |run, problem| {
            let mut plan = sound(run, problem)?;
            let mut last = last.lock().unwrap();
            if last.0 != problem.regions.len() {
                *last = (problem.regions.len(), last.1 + 1);
            }
            plan.cost += 1e-9 * last.1 as f64;
            Ok(plan)
        },
    );
}

#[test]
fn a_number_shared_by_calls_at_the_same_time() {
    let under_way = AtomicU64::new(0);
    caught("calls at the same time change nothing", |run, problem| {
        under_way.fetch_add(1, Ordering::SeqCst);
        pause(2);
        let plan = sound(run, problem);
        let others = under_way.fetch_sub(1, Ordering::SeqCst) - 1;
        let mut plan = plan?;
        plan.cost += 1e-9 * others as f64;
        Ok(plan)
    });
}

#[test]
fn more_evaluations_than_granted() {
    caught_in_plans("the evaluation budget is exact", |plan, _| {
        plan.stats.evaluations += 1;
    });
}

#[test]
fn wrong_ends() {
    caught_in_plans("a plan leads from start to target", |plan, problem| {
        let away = PathProblem {
            target: problem.target + (problem.start - problem.target) * 0.1,
            regions: &[],
            ..*problem
        };
        if let Ok(short) = away.timed(&[away.start, away.target]) {
            plan.best = short;
        }
    });
}

#[test]
fn regions_not_looked_at() {
    caught("the clearance is kept", |run, problem| {
        sound(
            run,
            &PathProblem {
                clearance_m: 0.0,
                ..*problem
            },
        )
    });
    caught("moving regions are passed clear", |run, problem| {
        let mut regions = problem.regions.to_vec();
        for region in &mut regions {
            region.centre += region.velocity_mps * (problem.departure_s - region.at_s);
            region.velocity_mps *= 0.0;
            region.at_s = problem.departure_s;
        }
        sound(
            run,
            &PathProblem {
                regions: &regions,
                ..*problem
            },
        )
    });
    caught("growing regions are passed clear", |run, problem| {
        let mut regions = problem.regions.to_vec();
        regions
            .iter_mut()
            .for_each(|region| region.growth_mps = 0.0);
        sound(
            run,
            &PathProblem {
                regions: &regions,
                ..*problem
            },
        )
    });
    caught(
        "a region that appears later is passed clear",
        |run, problem| {
            let mut regions = problem.regions.to_vec();
            regions.retain(|region| region.from_s <= problem.departure_s);
            sound(
                run,
                &PathProblem {
                    regions: &regions,
                    ..*problem
                },
            )
        },
    );
}

#[test]
fn regions_seen_that_are_gone() {
    caught("a region that is gone is not in the way", |run, problem| {
        let mut regions = problem.regions.to_vec();
        for region in &mut regions {
            (region.from_s, region.until_s) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        let mut plan = sound(
            run,
            &PathProblem {
                regions: &regions,
                ..*problem
            },
        )?;
        if regions != problem.regions {
            plan.violation += 1.0;
        }
        Ok(plan)
    });
}

#[test]
fn a_bed_taken_to_be_flat_or_certain() {
    caught("a bed that slopes is kept clear of", |run, problem| {
        let Some(bed) = problem.sea_bed else {
            return sound(run, problem);
        };
        let flat = FlatBed::new(bed.depth_at(problem.start.x, problem.start.y));
        sound(
            run,
            &PathProblem {
                sea_bed: Some(&flat),
                ..*problem
            },
        )
    });
    caught("an uncertain bed is kept clear of", |run, problem| {
        sound(
            run,
            &PathProblem {
                altitude_sigmas: 0.0,
                ..*problem
            },
        )
    });
    caught("a flat bed is kept clear of", |run, problem| {
        sound(
            run,
            &PathProblem {
                sea_bed: None,
                ..*problem
            },
        )
    });
    caught(
        "a place below the bed is not called feasible",
        |run, problem| {
            let stays = problem.start == problem.target;
            let sea_bed = problem.sea_bed.filter(|_| !stays);
            sound(
                run,
                &PathProblem {
                    sea_bed,
                    ..*problem
                },
            )
        },
    );
}

#[test]
fn too_fast() {
    caught("the speed through the water is kept", |run, problem| {
        let quick = Vehicle {
            speed_mps: problem.vehicle.max_speed_mps * 1.2,
            max_speed_mps: problem.vehicle.max_speed_mps * 1.2,
            ..*problem.vehicle
        };
        sound(
            run,
            &PathProblem {
                vehicle: &quick,
                ..*problem
            },
        )
    });
}

#[test]
fn the_current_of_another_time_or_place() {
    caught(
        "a current that turns is flown as it turns",
        |run, problem| {
            let Some(current) = problem.current else {
                return sound(run, problem);
            };
            let at_departure =
                UniformCurrent::new(current.velocity_at(&problem.start, problem.departure_s));
            sound(
                run,
                &PathProblem {
                    current: Some(&at_departure),
                    ..*problem
                },
            )
        },
    );
    caught(
        "a current is flown as it is in each place",
        |run, problem| {
            let Some(current) = problem.current else {
                return sound(run, problem);
            };
            let at_start = UniformCurrent::new(current.velocity_at(&problem.start, 0.0));
            sound(
                run,
                &PathProblem {
                    current: Some(&at_start),
                    ..*problem
                },
            )
        },
    );
}

#[test]
fn a_vehicle_that_turns_and_pitches_better_than_it_does() {
    caught("the turn radius is kept", |run, problem| {
        let nimble = Vehicle {
            turn_radius_m: 0.0,
            ..*problem.vehicle
        };
        sound(
            run,
            &PathProblem {
                vehicle: &nimble,
                ..*problem
            },
        )
    });
    caught("the pitch limit is kept", |run, problem| {
        let steep = Vehicle {
            max_pitch_rad: std::f64::consts::FRAC_PI_2,
            ..*problem.vehicle
        };
        sound(
            run,
            &PathProblem {
                vehicle: &steep,
                ..*problem
            },
        )
    });
    caught("the box is kept", |run, problem| {
        sound(
            run,
            &PathProblem {
                bounds: None,
                ..*problem
            },
        )
    });
}

#[test]
fn plans_worse_than_the_warm_start() {
    caught("a warm start does no harm", |run, problem| {
        let mut plan = sound(
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
    });
    caught(
        "a warm start of another problem does no harm",
        |run, problem| {
            let mut plan = sound(run, problem)?;
            if let Some(warm) = problem.warm_start {
                plan.best = warm.clone();
            }
            Ok(plan)
        },
    );
}

#[test]
fn another_plan_for_each_number_of_threads() {
    let on = |threads: f64| {
        Faulty(move |run: &mut Run<'_>, problem: &PathProblem<'_>| {
            let mut plan = sound(run, problem)?;
            plan.cost += 1e-9 * threads;
            Ok(plan)
        })
    };
    let (one, two) = (on(1.0), on(2.0));
    let check = "the number of threads changes nothing";
    assert_caught(conformance::paths_on_threads(&[&one, &two]), check);
    let again = on(1.0);
    assert!(conformance::paths_on_threads(&[&one, &again]).is_ok());
    let seeded = Faulty(|run: &mut Run<'_>, problem: &PathProblem<'_>| {
        sound(
            &mut Run::new(Seed(run.seed().0 + 1), run_budget(run)),
            problem,
        )
    });
    assert_caught(
        conformance::path_planner(&seeded),
        "the evaluation budget is exact",
    );
}

fn run_budget(run: &Run<'_>) -> auv_planning::Budget {
    run.evaluations_left().map_or_else(
        auv_planning::Budget::to_the_cap,
        auv_planning::Budget::evaluations,
    )
}
