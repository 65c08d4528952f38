use super::{Fault, FaultPlan, FaultResponse, Intensity, Trial, fly_with_faults};
use crate::{Campaign, Log, Scenario, simulate};
use auv_mission::driver::Stepped;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_types::Seed;

/// A mission of the campaign with few obstacles: straight paths suffice.
fn calm(k: u64) -> Scenario {
    let mut campaign = Campaign::table2(Seed(5)).unwrap();
    campaign.obstacles = 4;
    campaign.scenario(k).unwrap()
}

fn flown(scenario: &Scenario, faults: &[Fault], degree: u8) -> (Trial, String) {
    let plan = FaultPlan {
        faults: faults.to_vec(),
        intensity: Intensity::new(degree).unwrap(),
        seed: Seed(3),
    };
    let mut log = Log::hash_only();
    let trial = fly_with_faults(scenario, &GreedyRoute, &StraightPath, &plan, &mut log).unwrap();
    (trial, log.sha256())
}

#[test]
fn the_canary_is_reported() {
    let scenario = calm(0);
    let (trial, hash) = flown(&scenario, &[Fault::Canary], 1);
    assert!(!trial.is_in_order());
    assert!(trial.failures[0].contains("cannot be flown"), "{trial:?}");
    // Two runs differ, so a double check finds it as well.
    assert_ne!(flown(&scenario, &[Fault::Canary], 1).1, hash);
}

#[test]
fn a_plan_without_faults_changes_nothing() {
    let scenario = calm(1);
    let mut log = Log::hash_only();
    let summary = simulate(
        &scenario,
        &Stepped::new(&GreedyRoute, &StraightPath),
        &mut log,
    );
    let (trial, hash) = flown(&scenario, &[], 1);
    assert_eq!(
        (trial.summary, hash),
        (Some(summary.unwrap()), log.sha256())
    );
}

#[test]
fn broken_input_is_refused() {
    let scenario = calm(2);
    for &fault in Fault::all().iter().filter(|fault| !fault.is_in_flight()) {
        for degree in 1..=4 {
            let (trial, _) = flown(&scenario, &[fault], degree);
            assert!(trial.is_in_order(), "{fault:?} {degree}: {trial:?}");
            let expected = fault.expected(Intensity::new(degree).unwrap());
            assert_eq!(trial.response, expected, "{fault:?} {degree}");
        }
    }
}

/// With baseline planners a mission may be late or end early, but nothing that must never happen does,
/// and a run can be repeated.
#[test]
fn nothing_that_must_never_happen_does() {
    let scenario = calm(3);
    let never = ["panic", "number", "force", "end", "adopted", "checkpoint"];
    for (i, &fault) in Fault::in_flight().iter().enumerate() {
        let other = Fault::in_flight()[(i + 5) % 17];
        let degree = 1 + (i % 4) as u8;
        let (trial, hash) = flown(&scenario, &[fault, other], degree);
        let forbidden = |failure: &String| never.iter().any(|word| failure.contains(word));
        assert!(
            !trial.failures.iter().any(forbidden),
            "{fault:?} {other:?}: {:?}",
            trial.failures
        );
        assert!(trial.started_s.is_some() && trial.response <= FaultResponse::FellBack);
        if i % 4 == 0 {
            assert_eq!(
                flown(&scenario, &[fault, other], degree).1,
                hash,
                "{fault:?}"
            );
        }
    }
}

/// A request made at the tick of the resumed checkpoint is lost with it.
#[test]
fn a_crash_right_after_a_replan_causes_no_panic() {
    for k in 0..6 {
        let (trial, _) = flown(&calm(k), &[Fault::Energy, Fault::Restart], 4);
        let panicked = trial.failures.iter().any(|f| f.contains("panic"));
        assert!(!panicked, "{k}: {:?}", trial.failures);
    }
}
