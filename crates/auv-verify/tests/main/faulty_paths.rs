//! Path planners with one fault each, and what the kit says of it.

use crate::faulty::Faulty;
use crate::faulty_planners::{assert_said, blames, gives_up, hangs};
use crate::misread::MISREAD;
use auv_obstacles::{ObstacleId, Region};
use auv_planning::baseline::StraightPath;
use auv_planning::{PathPlanner, PathProblem, PlanError, Planned, Run, Trajectory, Vehicle};
use auv_types::{Point3, Vector3, Violations};
use auv_verify::conformance::{self, FailedCheck, FailedChecks};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

type Answer = Result<Planned<Trajectory>, PlanError>;
type Outcome = Result<(), FailedChecks>;

const FEASIBLE: &str = "a plan called feasible is";
const ENDS: &str = "a plan leads from start to target";
const ONE_PLACE: &str = "start and target may be one place";
const STRONG: &str = "a current too strong is not made good";
const WARM: &str = "a warm start does no harm";
const FOREIGN: &str = "a warm start of another problem does no harm";
const MALFORMED: &str = "malformed input is refused";
const EXTREME: &str = "extreme values do no harm";
const CALLED: &str = "after 1 evaluations calls a trajectory feasible that ";

fn sound(run: &mut Run<'_>, problem: &PathProblem<'_>) -> Answer {
    StraightPath.plan_path(run, problem)
}

fn of(planner: impl Fn(&mut Run<'_>, &PathProblem<'_>) -> Answer + Send + Sync) -> Outcome {
    conformance::path_planner(&Faulty(planner))
}

/// What the kit says of the baseline with every plan spoilt.
fn spoilt(spoil: impl Fn(&mut Planned<Trajectory>, &PathProblem<'_>) + Send + Sync) -> Outcome {
    of(|run, problem| {
        let mut plan = sound(run, problem)?;
        spoil(&mut plan, problem);
        Ok(plan)
    })
}

/// What the kit says of the baseline that plans among changed regions.
fn among(change: impl Fn(&mut Region, &PathProblem<'_>) + Send + Sync) -> Outcome {
    of(|run, problem| {
        let mut regions = problem.regions.to_vec();
        regions
            .iter_mut()
            .for_each(|region| change(region, problem));
        sound(
            run,
            &PathProblem {
                regions: &regions,
                ..*problem
            },
        )
    })
}

#[test]
fn an_error_for_a_sound_problem_is_told() {
    let reason = "gives an error for a sound problem: planner faulty failed: on purpose";
    let expected = [
        "the evaluation budget is exact",
        ENDS,
        "open water is crossed",
        ONE_PLACE,
        "a blocked target is named",
        "a blocked start is told",
        "the clearance is kept",
        "moving regions are passed clear",
        "growing regions are passed clear",
        "a region that appears later is passed clear",
        "a region that is gone is not in the way",
        WARM,
        FOREIGN,
        "the speed through the water is kept",
        "a current that turns is flown as it turns",
        "a current is flown as it is in each place",
        "the turn radius is kept",
        "the pitch limit is kept",
        "the box is kept",
        "a flat bed is kept clear of",
        "a bed that slopes is kept clear of",
        "an uncertain bed is kept clear of",
        "a place below the bed is not called feasible",
    ];
    let outcome = of(|_, _| Err(gives_up()));
    assert_said(outcome.clone(), &expected.map(|check| (check, reason)));
    assert_said(
        outcome,
        &[(MALFORMED, "malformed region: gives Err(Failed")],
    );
    let invalid = of(|run, problem| match problem.current {
        Some(_) => {
            let mut wrong = Violations::new();
            wrong.push("current", "is too strong");
            Err(PlanError::Invalid(wrong))
        }
        None => sound(run, problem),
    });
    assert_said(invalid, &[(STRONG, "calls a sound problem malformed: ")]);
}

#[test]
fn whatever_is_infeasible_must_not_be_called_feasible() {
    let said = spoilt(|plan, _| plan.violation = 0.0);
    let expected = [
        (
            FEASIBLE,
            "among obstacles, 1 evaluations: calls a trajectory feasible that ",
        ),
        (
            "a blocked target is named",
            "calls a trajectory feasible that ",
        ),
        (
            "a blocked start is told",
            "calls a trajectory feasible that ",
        ),
        ("the clearance is kept", CALLED),
        ("moving regions are passed clear", CALLED),
        ("growing regions are passed clear", CALLED),
        ("a region that appears later is passed clear", CALLED),
        ("the turn radius is kept", CALLED),
        ("the pitch limit is kept", CALLED),
        ("the box is kept", CALLED),
        ("a flat bed is kept clear of", CALLED),
        ("a bed that slopes is kept clear of", CALLED),
        ("an uncertain bed is kept clear of", CALLED),
        (
            "a place below the bed is not called feasible",
            "calls a trajectory feasible that ",
        ),
        (STRONG, "calls it feasible"),
        (WARM, "calls a trajectory feasible that "),
        (
            EXTREME,
            "a box of one point: calls a trajectory feasible: Some(",
        ),
    ];
    assert_said(said, &expected);
    let said = spoilt(|plan, problem| {
        if problem.bounds.is_none() {
            plan.violation = 0.0;
        }
    });
    let around = "a region around everything: calls a trajectory feasible: Some(";
    assert_said(said, &[(EXTREME, around)]);
    let said = spoilt(|plan, problem| {
        if problem.vehicle.turn_radius_m > 1e4 {
            plan.violation = f64::NAN;
        }
    });
    assert_said(said, &[(EXTREME, "a clumsy vehicle: gives cost")]);
}

#[test]
fn whatever_is_feasible_must_be_called_so() {
    let said = spoilt(|plan, _| plan.violation += 0.5);
    let expected = [
        ("open water is crossed", "takes 3"),
        (ONE_PLACE, "violation 0.5 where start and target are one"),
        (
            "a region that is gone is not in the way",
            "violation 0.5 where the water is clear",
        ),
    ];
    assert_said(said, &expected);
    let said = spoilt(|plan, _| plan.blocked_by = None);
    let blocked = ("a blocked target is named", "violation ");
    assert_said(said, &[blocked]);
}

#[test]
fn the_ends_must_be_those_asked_for() {
    let end = |problem: &PathProblem<'_>, metres: f64| {
        let away = PathProblem {
            target: problem.target + Vector3::x() * metres,
            ..*problem
        };
        away.timed(&[away.start, away.target])
    };
    let said = spoilt(|plan, problem| {
        if let (true, Ok(short)) = (plan.violation > 0.0, end(problem, 0.01)) {
            plan.best = short;
        }
    });
    assert_said(said, &[(ENDS, "leads from ")]);
    let said = spoilt(|plan, problem| {
        let start = problem.start + Vector3::y() * 0.01;
        let beside = PathProblem { start, ..*problem }.timed(&[start, problem.target]);
        if let (true, Ok(beside)) = (plan.violation > 0.0, beside) {
            plan.best = beside;
        }
    });
    assert_said(said, &[(ENDS, "leads from ")]);
    let said = spoilt(|plan, problem| {
        let late = PathProblem {
            departure_s: problem.departure_s + 0.01,
            ..*problem
        };
        if let (true, Ok(late)) = (
            plan.violation > 0.0,
            late.timed(&[problem.start, problem.target]),
        ) {
            plan.best = late;
        }
    });
    assert_said(said, &[(ENDS, "leads from ")]);
}

#[test]
fn checks_of_one_limit_blame_no_other_fault() {
    // A centimetre beside the target, and called feasible.
    let said = spoilt(|plan, problem| {
        let target = problem.target + Vector3::x() * 0.01;
        if let Ok(beside) = problem.timed(&[problem.start, target]) {
            plan.best = beside;
        }
    });
    assert!(blames(&said, FEASIBLE), "{said:?}");
    for check in [
        "the speed through the water is kept",
        "the clearance is kept",
        "a flat bed is kept clear of",
    ] {
        assert!(!blames(&said, check), "{check}: {said:?}");
    }
}

#[test]
fn open_water_may_be_crossed_with_a_small_detour() {
    let with_detour = |share: f64| {
        of(move |run, problem| {
            let mut plan = sound(run, problem)?;
            let way = problem.target - problem.start;
            let aside = problem.start + way * 0.5 + Vector3::new(-way.y, way.x, 0.0) * share;
            let points = [problem.start, aside, problem.target];
            if let (0.0, Ok(detour)) = (plan.violation, problem.timed(&points)) {
                (plan.cost, plan.best) = (detour.duration_s(), detour);
            }
            Ok(plan)
        })
    };
    // 1.17 and 1.22 times as long as the straight way.
    assert!(!blames(&with_detour(0.3), "open water is crossed"));
    assert!(blames(&with_detour(0.35), "open water is crossed"));
}

#[test]
fn plans_must_be_the_same_in_every_bit_among_few_regions_and_many() {
    let check = "same seed and budget give the same bits";
    let calls = AtomicU32::new(0);
    let said = spoilt(|plan, _| {
        let call = calls.fetch_add(1, Ordering::Relaxed);
        plan.blocked_by = Some(ObstacleId(call));
    });
    assert!(blames(&said, check), "{said:?}");
    let said = spoilt(|plan, _| {
        let is_odd = calls.fetch_add(1, Ordering::Relaxed) % 2 == 1;
        plan.violation = if is_odd { -0.0 } else { 0.0 };
    });
    assert!(blames(&said, check), "{said:?}");
    for count in [8, 25] {
        let said = spoilt(|plan, problem| {
            let is_late = problem.departure_s > 0.0 && problem.clearance_m > 0.0;
            if problem.regions.len() == count && is_late {
                plan.cost += f64::from(calls.fetch_add(1, Ordering::Relaxed));
            }
        });
        assert!(blames(&said, check), "{count} regions: {said:?}");
    }
}

#[test]
fn every_extreme_value_is_tried() {
    let nan_where = |name: &str, is_there: fn(&PathProblem<'_>) -> bool| {
        let said = spoilt(|plan, problem| {
            if is_there(problem) {
                plan.cost = f64::NAN;
            }
        });
        assert_said(said, &[(EXTREME, &format!("{name}: gives cost NaN"))]);
    };
    nan_where("a far target", |problem| {
        problem.target.x > 1e6 && problem.target.y < -1e6
    });
    nan_where("a near target", |problem| {
        let way = problem.target - problem.start;
        way.x > 0.0 && way.norm() < 1e-6
    });
    nan_where("a late departure", |problem| problem.departure_s > 1e8);
    nan_where("a box of one point", |problem| {
        problem
            .bounds
            .is_some_and(|bounds| bounds.low == bounds.high)
    });
    nan_where("a region around everything", |problem| {
        problem.clearance_m > 1e5
    });
    nan_where("a slow vehicle", |problem| {
        let vehicle = problem.vehicle;
        vehicle.min_speed_mps <= 0.0 && vehicle.max_speed_mps < 0.01
    });
    nan_where("a clumsy vehicle", |problem| {
        problem.vehicle.max_pitch_rad < 0.02 && problem.vehicle.turn_radius_m > 1e4
    });
}

#[test]
fn what_the_problem_says_must_be_read_as_it_is() {
    for (check, misread) in MISREAD {
        let said = of(move |run, problem| misread(&StraightPath, run, problem));
        let reason = match check {
            "a region that is gone is not in the way" => "violation 100.",
            "a place below the bed is not called feasible" | FOREIGN => {
                "calls a trajectory feasible that "
            }
            WARM => "gives Score",
            _ => CALLED,
        };
        assert_said(said.clone(), &[(check, reason)]);
        if check == "the box is kept" {
            let out = "out of the box, 1 evaluations: calls a trajectory feasible that ";
            assert_said(said, &[(FEASIBLE, out)]);
        }
    }
}

#[test]
fn a_fault_is_told_by_its_own_check_alone() {
    // Far round all regions, high over the ridge, and much too fast.
    let said = of(|run, problem| {
        let mut plan = sound(run, problem)?;
        let quick = Vehicle {
            speed_mps: 900.0,
            max_speed_mps: 900.0,
            ..Vehicle::paper()
        };
        let round = PathProblem {
            vehicle: &quick,
            current: None,
            ..*problem
        };
        let points = [
            problem.start,
            Point3::new(450.0, 800.0, 5.0),
            problem.target,
        ];
        if let Ok(way) = round.timed(&points) {
            let is_too_low = |bed: &dyn auv_ocean::SeaBed| {
                bed.depth_at(problem.target.x, problem.target.y) < 60.0
            };
            plan.violation = f64::from(u8::from(problem.sea_bed.is_some_and(is_too_low)));
            plan.best = way;
        }
        Ok(plan)
    });
    assert!(blames(&said, "the speed through the water is kept"));
    for check in [
        "the clearance is kept",
        "moving regions are passed clear",
        "growing regions are passed clear",
        "a region that appears later is passed clear",
        "a bed that slopes is kept clear of",
        "a flat bed is kept clear of",
        "an uncertain bed is kept clear of",
        "the pitch limit is kept",
    ] {
        assert!(!blames(&said, check), "{check}: {said:?}");
    }
}

#[test]
fn a_current_must_not_be_left_out() {
    let said = of(|run, problem| {
        sound(
            run,
            &PathProblem {
                current: None,
                ..*problem
            },
        )
    });
    assert_said(said, &[(STRONG, "calls it feasible")]);
}

#[test]
fn malformed_input_must_be_refused_whatever_is_wrong() {
    let accepted = |what: &'static str, mend: fn(&mut PathProblem<'_>)| {
        let said = of(move |run, problem| {
            let mut mended = *problem;
            mend(&mut mended);
            sound(run, &mended)
        });
        assert_said(said, &[(MALFORMED, what)]);
    };
    accepted("malformed start: gives Ok(", |problem| {
        if problem.start.y.is_nan() {
            problem.start = problem.target;
        }
    });
    accepted("malformed target: gives Ok(", |problem| {
        if problem.target.y.is_nan() {
            problem.target = problem.start;
        }
    });
    accepted("malformed departure_s: gives Ok(", |problem| {
        if problem.departure_s.is_nan() {
            problem.departure_s = 0.0;
        }
    });
    accepted("malformed clearance_m: gives Ok(", |problem| {
        if problem.clearance_m.is_nan() {
            problem.clearance_m = 0.0;
        }
    });
    accepted("malformed clearance_m below 0: gives Ok(", |problem| {
        problem.clearance_m = problem.clearance_m.abs();
    });
    accepted("malformed min_altitude_m: gives Ok(", |problem| {
        if problem.min_altitude_m.is_nan() {
            problem.min_altitude_m = 0.0;
        }
    });
    accepted("malformed start_velocity: gives Ok(", |problem| {
        if problem
            .start_velocity
            .is_some_and(|velocity| velocity.x > 1e9)
        {
            problem.start_velocity = None;
        }
    });
    accepted("malformed bounds: gives Ok(", |problem| {
        if problem
            .bounds
            .is_some_and(|bounds| bounds.low.x > bounds.high.x)
        {
            problem.bounds = None;
        }
    });
    let said = among(|region, _| {
        if region.radius_m.is_nan() {
            region.radius_m = 1.0;
        }
    });
    assert_said(said, &[(MALFORMED, "malformed region: gives Ok(")]);
    let said = of(|run, problem| {
        let is_wrong = problem.vehicle.speed_mps.is_nan();
        let mended = Vehicle::paper();
        let vehicle = if is_wrong { &mended } else { problem.vehicle };
        sound(
            run,
            &PathProblem {
                vehicle,
                ..*problem
            },
        )
    });
    assert_said(said, &[(MALFORMED, "malformed vehicle: gives Ok(")]);
}

#[test]
fn threads_must_change_nothing() {
    let check = "the number of threads changes nothing";
    let dear = Faulty(|run: &mut Run<'_>, problem: &PathProblem<'_>| {
        let mut plan = sound(run, problem)?;
        plan.cost += 1.0;
        Ok(plan)
    });
    let said = conformance::paths_on_threads(&[&StraightPath, &dear]);
    assert_said(said, &[(check, "planner 1 gives Planned")]);
    assert_eq!(conformance::paths_on_threads(&[&dear, &dear]), Ok(()));
}

#[test]
fn a_planner_that_never_ends_is_named_by_its_check() {
    let endless = Arc::new(Faulty(|run: &mut Run<'_>, problem: &PathProblem<'_>| {
        if problem.start == problem.target {
            hangs();
        }
        sound(run, problem)
    }));
    let said = conformance::path_planner_within(endless, Duration::from_secs(4));
    let hung = FailedCheck {
        check: ONE_PLACE,
        reason: "has not ended after 4 s".into(),
    };
    assert_eq!(said, Err(FailedChecks(vec![hung])));
}
