//! Route planners with one fault each, and what the kit says of it.

use crate::faulty::Faulty;
use crate::faulty_planners::{assert_said, blames, gives_up, hangs};
use auv_graph::{NodeId, Route};
use auv_planning::baseline::GreedyRoute;
use auv_planning::{PlanError, Planned, RoutePlanner, RouteProblem, Run, StopReason};
use auv_types::Seed;
use auv_verify::conformance::{self, FailedCheck, FailedChecks};
use std::sync::Arc;
use std::time::Duration;

type Answer = Result<Planned<Route>, PlanError>;

const FEASIBLE: &str = "a plan called feasible is";
const TINY: &str = "tiny networks are solved";

fn sound(run: &mut Run<'_>, problem: &RouteProblem<'_>) -> Answer {
    GreedyRoute.plan_route(run, problem)
}

fn of(planner: impl Fn(&mut Run<'_>, &RouteProblem<'_>) -> Answer + Send + Sync) -> Outcome {
    conformance::route_planner(&Faulty(planner))
}

type Outcome = Result<(), FailedChecks>;

/// What the kit says of the baseline with every plan spoilt.
fn spoilt(spoil: impl Fn(&mut Planned<Route>, &RouteProblem<'_>) + Send + Sync) -> Outcome {
    of(|run, problem| {
        let mut plan = sound(run, problem)?;
        spoil(&mut plan, problem);
        Ok(plan)
    })
}

#[test]
fn an_error_for_a_sound_problem_is_told() {
    let reason = "gives an error for a sound problem: planner faulty failed: on purpose";
    let expected = [
        "same seed and budget give the same bits",
        "another problem in between changes nothing",
        "calls at the same time change nothing",
        "the evaluation budget is exact",
        "cost and violation are finite",
        "a cancelled run gives a plan",
        "a run ends soon after it is cancelled",
        "a run ends soon after its deadline",
        "a run without time gives a plan",
        FEASIBLE,
        "removed edges are not used",
        "changed times are honoured",
        "an incumbent is never made worse",
        "start and destination may be one node",
        TINY,
        "too little time gives the quickest route",
    ];
    let outcome = of(|_, _| Err(gives_up()));
    assert_said(outcome.clone(), &expected.map(|check| (check, reason)));
    let in_time = "gives an error for a sound problem in time: planner faulty failed: on purpose";
    let others = [
        ("routes in time are planned or declined", in_time),
        ("an unreachable destination is an error", "gives Err(Failed"),
        (
            "malformed input is refused",
            "malformed time: gives Err(Failed",
        ),
    ];
    assert_said(outcome, &others);
}

#[test]
fn what_a_run_spends_and_why_it_ends_must_be_true() {
    let budget = "the evaluation budget is exact";
    let said = spoilt(|plan, _| plan.stats.evaluations += 1);
    let spent = [
        (budget, "of 1 evaluations 1 were spent and 2 reported"),
        (
            "a cancelled run gives a plan",
            "cancelled beforehand it spends 1 evaluations and stops as cancelled",
        ),
        (
            "a run without time gives a plan",
            "spends 1 evaluations after its deadline",
        ),
    ];
    assert_said(said, &spent);
    let said = spoilt(|plan, _| plan.stats.stop = StopReason::EvaluationsSpent);
    assert_said(
        said,
        &[(budget, "says that 2 evaluations are spent after 1")],
    );
    let said = spoilt(|plan, _| plan.stats.stop = StopReason::DeadlinePassed);
    let stop = "says it was stopped by deadline_passed in a run without deadline";
    assert_said(said, &[(budget, stop)]);
    let said = of(|run, problem| {
        let is_cancelled = run.should_stop();
        let mut plan = sound(run, problem)?;
        if is_cancelled {
            plan.stats.stop = StopReason::Finished;
        }
        Ok(plan)
    });
    let stop = "cancelled beforehand it spends 0 evaluations and stops as finished";
    assert_said(said, &[("a cancelled run gives a plan", stop)]);
    // One generation may be under way when the flag is set, no more.
    let generations = |more| spoilt(move |plan, _| plan.stats.generations += more);
    assert_eq!(generations(1), Ok(()));
    let late = "goes on for 3 generations after it was cancelled";
    assert_said(
        generations(2),
        &[("a run ends soon after it is cancelled", late)],
    );
}

#[test]
fn figures_that_are_not_sound_are_told() {
    let finite = "cost and violation are finite";
    for (cost, violation, reason) in [
        (f64::NAN, 0.0, "gives cost NaN and violation 0"),
        (f64::INFINITY, 0.0, "gives cost inf and violation 0"),
        (-1.0, f64::NAN, "gives cost -1 and violation NaN"),
        (-1.0, f64::INFINITY, "gives cost -1 and violation inf"),
        (-1.0, -0.5, "gives cost -1 and violation -0.5"),
    ] {
        let said = spoilt(|plan, _| (plan.cost, plan.violation) = (cost, violation));
        assert_said(
            said,
            &[
                (finite, reason),
                (FEASIBLE, "3 nodes, 1 evaluations: gives cost"),
            ],
        );
    }
}

#[test]
fn claims_that_are_not_the_verifiers_figures_are_told() {
    let said = spoilt(|plan, _| plan.cost -= 1e-6);
    assert_said(said, &[(FEASIBLE, "3 nodes, 1 evaluations: claims cost")]);
    // Rounding of a sum is no false claim.
    let rounded = |share: f64| spoilt(move |plan, _| plan.cost += share * (1.0 + plan.cost.abs()));
    assert!(!blames(&rounded(9e-10), FEASIBLE));
    assert!(blames(&rounded(2e-9), FEASIBLE));
    let above = |share: f64| {
        spoilt(move |plan, _| plan.bound = Some(plan.cost + share * (1.0 + plan.cost.abs())))
    };
    assert!(!blames(&above(9e-10), FEASIBLE));
    assert!(blames(&above(2e-9), FEASIBLE));
    let said = spoilt(|plan, _| plan.violation += 0.5);
    let wrong = "3 nodes, 1 evaluations: claims violation 0.5 for a route of";
    assert_said(said, &[(FEASIBLE, wrong), (TINY, "claims violation 0.5")]);
    let said = spoilt(|plan, _| plan.violation = 0.0);
    let late = [(
        "too little time gives the quickest route",
        "claims violation 0 for",
    )];
    assert_said(said, &late);
    let bound = |above| spoilt(move |plan, _| plan.bound = Some(plan.cost + above));
    assert_eq!(bound(0.0), Ok(()));
    assert_eq!(bound(-1.0), Ok(()));
    let wrong = "3 nodes, 1 evaluations: claims bound Some(";
    assert_said(bound(1e-3), &[(FEASIBLE, wrong)]);
    let said = spoilt(|plan, _| {
        plan.best = Route::new(plan.best.nodes().iter().rev().copied().collect());
    });
    assert_said(
        said,
        &[(FEASIBLE, "3 nodes, 1 evaluations: Route"), (TINY, "Route")],
    );
}

#[test]
fn what_the_problem_says_must_be_heeded() {
    let said = of(|run, problem| {
        let whole = RouteProblem::new(
            problem.network,
            problem.start,
            problem.destination,
            problem.time_available_s,
        );
        sound(
            run,
            &RouteProblem {
                removed: whole.removed,
                ..*problem
            },
        )
    });
    assert_said(said, &[("removed edges are not used", "Route")]);
    let said = of(|run, problem| {
        sound(
            run,
            &RouteProblem {
                times: None,
                ..*problem
            },
        )
    });
    let expected = [
        ("changed times are honoured", "claims "),
        ("malformed input is refused", "malformed times: gives Ok("),
    ];
    assert_said(said, &expected);
    let said = of(|run, problem| {
        let spare_s = 0.5 * problem.time_available_s;
        let time_available_s = if problem.incumbent.is_some() {
            spare_s
        } else {
            2.0 * spare_s
        };
        sound(
            run,
            &RouteProblem {
                incumbent: None,
                time_available_s,
                ..*problem
            },
        )
    });
    assert_said(said, &[("an incumbent is never made worse", "cost -")]);
}

#[test]
fn an_incumbent_may_get_dearer_by_rounding_alone() {
    let kept = "an incumbent is never made worse";
    let dearer = |share: f64| {
        spoilt(move |plan, problem| {
            if problem.incumbent.is_some() {
                plan.cost += share * plan.cost.abs();
            }
        })
    };
    for share in [-9e-13, 0.0, 9e-13] {
        assert!(!blames(&dearer(share), kept), "{share}");
    }
    assert_said(dearer(2e-12), &[(kept, "cost -")]);
}

#[test]
fn the_only_route_and_the_quickest_must_be_found() {
    let said = spoilt(|plan, problem| {
        if problem.start == problem.destination {
            plan.best = Route::new(vec![problem.start, problem.start]);
        }
    });
    let one = [
        ("start and destination may be one node", "plans Route"),
        (TINY, "Route"),
    ];
    assert_said(said, &one);
    // A detour where time is too short, and called what it is.
    let said = of(|run, problem| {
        let plan = sound(run, problem)?;
        if plan.violation > 0.0 {
            return detour(run, problem);
        }
        Ok(plan)
    });
    let quickest = "too little time gives the quickest route";
    assert_said(said, &[(quickest, "takes ")]);
    // A detour where the quickest route just fits.
    let said = of(|run, problem| {
        let (_, quickest) = problem.quickest()?;
        let spare_s = problem.time_available_s - quickest.time_s;
        if (0.0..1e-6).contains(&spare_s)
            && problem.network.num_nodes() > 2
            && quickest.time_s > 0.0
        {
            return detour(run, problem);
        }
        sound(run, problem)
    });
    assert_said(
        said,
        &[(quickest, "misses the quickest route, which just fits")],
    );
}

/// The baseline's route with time to spare, with its true cost and violation.
fn detour(run: &mut Run<'_>, problem: &RouteProblem<'_>) -> Answer {
    let mut plan = sound(
        run,
        &RouteProblem {
            time_available_s: 1e6,
            ..*problem
        },
    )?;
    let network = problem.network;
    let totals = network.evaluate(&plan.best, problem.removed, problem.times);
    let score = problem.score(&totals.map_err(|_| gives_up())?);
    (plan.cost, plan.violation) = (score.cost, score.violation);
    Ok(plan)
}

#[test]
fn calls_at_the_same_time_must_be_alone() {
    let at_once = "calls at the same time change nothing";
    // The kit's calls at the same time are on threads without a name.
    let is_among_others = || std::thread::current().name().is_none();
    let said = spoilt(|plan, _| plan.cost += f64::from(u8::from(is_among_others())));
    assert_said(said, &[(at_once, "among other calls seed 0 gives")]);
    let said = spoilt(|_, _| assert!(!is_among_others(), "on purpose"));
    assert_said(said, &[(at_once, "panics")]);
}

#[test]
fn routes_in_time_must_be_what_they_claim() {
    let in_time = "routes in time are planned or declined";
    let said = |spoil: fn(&mut Planned<Route>)| {
        spoilt(move |plan, problem| {
            if problem.time_model.is_some() {
                spoil(plan);
            }
        })
    };
    let none = said(|plan| plan.schedule = None);
    assert_said(
        none,
        &[(in_time, "gives a route in time without its schedule")],
    );
    let late = said(|plan| plan.violation = 2.0);
    assert_said(late, &[(in_time, "claims violation 2, but breaks []")]);
    let cheap = said(|plan| plan.cost -= 1.0);
    assert_said(cheap, &[(in_time, "claims cost -")]);
    let evaluations = said(|plan| plan.stats.evaluations += 1);
    assert_said(
        evaluations,
        &[(in_time, "of 1 evaluations 1 were spent and 2 reported")],
    );
    let declined = of(|run, problem| {
        if problem.time_model.is_some() {
            return Err(PlanError::NotInTime);
        }
        sound(run, problem)
    });
    assert_eq!(declined, Ok(()));
}

#[test]
fn threads_must_change_nothing() {
    let check = "the number of threads changes nothing";
    let dear = Faulty(|run: &mut Run<'_>, problem: &RouteProblem<'_>| {
        let mut plan = sound(run, problem)?;
        plan.cost += 1.0;
        Ok(plan)
    });
    let said = conformance::routes_on_threads(&[&GreedyRoute, &GreedyRoute, &dear]);
    assert_said(said, &[(check, "planner 2 gives Planned")]);
    let none = Faulty(|_: &mut Run<'_>, _: &RouteProblem<'_>| Err(gives_up()));
    let said = conformance::routes_on_threads(&[&GreedyRoute, &none]);
    assert_said(
        said,
        &[(check, "gives an error for a sound problem: planner faulty")],
    );
    assert_eq!(
        conformance::routes_on_threads(&[&GreedyRoute, &GreedyRoute]),
        Ok(())
    );
}

#[test]
fn a_planner_that_never_ends_is_named_by_its_check() {
    let endless = Arc::new(Faulty(|run: &mut Run<'_>, problem: &RouteProblem<'_>| {
        if problem.start == NodeId(4) && problem.destination == NodeId(4) {
            hangs();
        }
        sound(run, problem)
    }));
    let said = conformance::route_planner_within(endless, Duration::from_secs(4));
    let hung = FailedCheck {
        check: "start and destination may be one node",
        reason: "has not ended after 4 s".into(),
    };
    assert_eq!(said, Err(FailedChecks(vec![hung])));
    let limit = Duration::from_secs(60);
    assert_eq!(
        conformance::route_planner_within(Arc::new(GreedyRoute), limit),
        Ok(())
    );
    let panics = Arc::new(Faulty(|run: &mut Run<'_>, problem: &RouteProblem<'_>| {
        assert!(run.seed() != Seed(4), "on purpose");
        sound(run, problem)
    }));
    let said = conformance::route_planner_within(panics, limit);
    assert_said(
        said,
        &[("the evaluation budget is exact", "the planner panics")],
    );
}

#[test]
fn failed_checks_are_shown_one_a_line() {
    let failed = |check, reason: &str| FailedCheck {
        check,
        reason: reason.into(),
    };
    let both = FailedChecks(vec![
        failed("a claim", "it is not so"),
        failed("another", "nor this"),
    ]);
    assert_eq!(both.to_string(), "a claim: it is not so\nanother: nor this");
}
