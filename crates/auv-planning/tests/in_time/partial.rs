//! What the baseline and the partial routes find, against an enumeration.

use crate::drawn::Drawn;
use crate::enumeration::most_weight;
use auv_graph::Route;
use auv_planning::baseline::GreedyRoute;
use auv_planning::timed::{Extended, PartialRoutes, fill, most_of_all, pieces, plan_in_time};
use auv_planning::{Budget, PlanError, Planned, RoutePlanner, RouteProblem, Run, StopReason};
use auv_types::Seed;

/// A plan by all partial routes; `is_filled`: after a quick one was offered.
fn proven(
    problem: &RouteProblem<'_>,
    budget: Budget,
    is_filled: bool,
) -> Result<Planned<Route>, PlanError> {
    let run = &mut Run::new(Seed(1), budget);
    let model = problem.time_model.unwrap();
    let mut bound = 0.0;
    let mut planned = plan_in_time(run, problem, model, "proof", |run, tables, tour| {
        if is_filled {
            fill(tables, tour, &pieces(tables));
        }
        let mut partial = PartialRoutes::new(run, tables, Some(tour)).unwrap();
        let extended = partial.extend(run, u64::MAX, 1_000_000);
        if let Some(best) = partial.best() {
            *tour = best;
        }
        bound = partial.bound();
        assert!(tour.weight() <= most_of_all(tables) + 1e-9);
        match extended {
            Extended::All => StopReason::Optimal,
            Extended::Some => StopReason::Finished,
            Extended::Stopped => run.stats(StopReason::Finished).stop,
        }
    })?;
    planned.bound = Some(-bound);
    Ok(planned)
}

/// What an answer weighs; `None` where it says that the rules cannot all be kept.
fn weight(answer: Result<Planned<Route>, PlanError>) -> Option<f64> {
    match answer {
        Ok(planned) => (planned.violation <= 0.0).then_some(-planned.cost),
        Err(PlanError::Impossible { .. } | PlanError::Failed { .. }) => None,
        Err(error) => unreachable!("{error}"),
    }
}

fn is_close(a: Option<f64>, b: Option<f64>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() < 1e-9,
        (a, b) => a == b,
    }
}

#[test]
fn the_proof_and_the_enumeration_find_the_same_weight() {
    let mut found = 0;
    for seed in 0..150 {
        let drawn = Drawn::new(seed, 5);
        let problem = drawn.problem();
        let most = most_weight(&problem);
        found += u32::from(most.is_some());
        for is_filled in [false, true] {
            let answer = proven(&problem, Budget::to_the_cap(), is_filled);
            if let Ok(plan) = &answer
                && plan.stats.stop != StopReason::Optimal
            {
                // Only with places to be met again some routes are left undecided.
                assert!(drawn.features.visits, "{seed}");
                assert!(
                    most <= plan.bound.map(|bound| 1e-9 - bound),
                    "{seed}: {plan:?}"
                );
                continue;
            }
            let weight = weight(answer);
            // The enumeration begins everything as early as possible; between places to be met later may
            // be better.
            let is_more = drawn.features.visits && weight.is_some() && weight > most;
            let features = drawn.features;
            assert!(
                is_more || is_close(weight, most),
                "{seed}: {weight:?} of {most:?} {features:?}"
            );
        }
    }
    assert!((50..150).contains(&found), "{found} of 150 can be solved");
}

#[test]
fn the_baseline_keeps_every_rule_and_finds_no_more_than_there_is() {
    let (mut greedy, mut all) = (0.0, 0.0);
    for seed in 200..350 {
        let drawn = Drawn::new(seed, 5);
        let problem = drawn.problem();
        let run = &mut Run::new(Seed(1), Budget::evaluations(1));
        let weight = weight(GreedyRoute.plan_route(run, &problem));
        let most = most_weight(&problem);
        if drawn.features.visits {
            continue;
        }
        assert!(
            weight.is_none() || weight <= most.map(|most| most + 1e-9),
            "{seed}: {weight:?} of {most:?}"
        );
        greedy += weight.unwrap_or(0.0);
        all += most.unwrap_or(0.0);
    }
    assert!(greedy > 0.8 * all, "{greedy} of {all}");
}

#[test]
fn a_proof_cut_short_gives_a_bound_that_holds() {
    let mut is_cut = 0;
    for seed in 400..440 {
        let drawn = Drawn::new(seed, 6);
        let problem = drawn.problem();
        let whole = proven(&problem, Budget::to_the_cap(), true);
        for evaluations in [0, 64, 640] {
            let short = proven(&problem, Budget::evaluations(evaluations), false);
            let (Ok(whole), Ok(short)) = (&whole, short) else {
                continue;
            };
            is_cut += u32::from(short.stats.stop == StopReason::EvaluationsSpent);
            let bound = short.bound.unwrap();
            assert!(
                bound <= whole.cost + 1e-9,
                "{seed}: {bound} above {}",
                whole.cost
            );
            assert!(short.score() >= whole.score() || short.cost > whole.cost - 1e-9);
        }
    }
    assert!(is_cut > 20, "only {is_cut} were cut short");
}
