//! The decision table is complete, has no dead rule, and stands in `docs/synchroniser.md`.

#![cfg(test)]

use crate::decide::{AfterLeg, Decision, Rule, Situation, When, decide, rules};
use crate::facts::{Fact, Facts};
use crate::trigger::Trigger;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

const SITUATIONS: [(Situation, &str); 16] = [
    (Situation::Ready, "the first tick has not come"),
    (
        Situation::AwaitRoute,
        "a route is awaited; the vehicle goes on along the trajectory in force",
    ),
    (
        Situation::AwaitFirstPath,
        "a leg has started; its first path is about to be asked for",
    ),
    (
        Situation::Holding,
        "the current is against the leg; staying at its start until it lets the vehicle pass",
    ),
    (Situation::Underway, "on a path to the target"),
    (Situation::AtTarget, "at the target, working on the task"),
    (
        Situation::ToStandOff,
        "the target is covered; on a path to a place near it",
    ),
    (
        Situation::AtStandOff,
        "waiting at a place near the covered target",
    ),
    (
        Situation::Evading,
        "no path leads to the target; keeping clear and waiting",
    ),
    (
        Situation::Climbing,
        "too low over the bed as measured; climbing",
    ),
    (
        Situation::Surfacing,
        "on the way to the surface for a fix of the position, or there",
    ),
    (
        Situation::LegAwaitsPath,
        "on a leg, in any of the modes above, while a path is awaited",
    ),
    (
        Situation::LegAwaitsShorterPath,
        "on a leg, while a shorter path is awaited",
    ),
    (
        Situation::LegAwaitsNextRoute,
        "on a leg, while the route after it is awaited",
    ),
    (
        Situation::Contingency,
        "the mission is aborted; a contingency or an evasion is flown",
    ),
    (Situation::Finished, "the mission is over"),
];

const TRIGGERS: [(Trigger, &str); 13] = [
    (Trigger::Tick, "a tick comes"),
    (Trigger::RouteAnswered, "the route planner answers"),
    (Trigger::PathAnswered, "the path planner answers"),
    (Trigger::PathWanted, "a path is wanted"),
    (
        Trigger::SonarLost,
        "the sonar has been silent for longer than `sonar_silence_s`",
    ),
    (
        Trigger::BedTooNear,
        "the measured altitude is below half the least altitude",
    ),
    (
        Trigger::CannotFollow,
        "the vehicle reports that it cannot follow trajectories any more",
    ),
    (Trigger::Leak, "the vehicle reports water inside"),
    (
        Trigger::ClockLost,
        "the clock jumps back, stands still for too long or is not a number",
    ),
    (
        Trigger::PositionLost,
        "the position is lost for longer than `position_silence_s`",
    ),
    (Trigger::NoLeg, "the route has no next leg"),
    (Trigger::NoWayHome, "no way leads home"),
    (
        Trigger::NoManoeuvre,
        "no contingency and no evasion can be flown",
    ),
];

fn text(decision: Decision) -> String {
    match decision {
        Decision::Continue => "nothing changes".into(),
        Decision::Finish(outcome) => format!("the mission ends: {outcome}"),
        Decision::EndContingency => "the mission ends: aborted".into(),
        Decision::AskRoute(reason) => format!("ask for a route (`{}`)", reason.as_str()),
        Decision::AskNextRoute => "ask for the route after this leg; the leg goes on".into(),
        Decision::AskRouteAgain => "ask again with a new seed".into(),
        Decision::AdoptRoute => {
            "the route goes into force; its first leg starts, and a path is wanted".into()
        }
        Decision::AdoptNextRoute => {
            "the route goes into force after this leg; the leg goes on".into()
        }
        Decision::KeepLeg => "the leg goes on; what follows is decided at its end".into(),
        Decision::GoHome => "the quickest way home goes into force; a path is wanted".into(),
        Decision::CompleteLeg(AfterLeg::Finish(outcome)) => {
            format!("book the task; the mission ends: {outcome}")
        }
        Decision::CompleteLeg(AfterLeg::AskRoute(reason)) => {
            format!("book the task; ask for a route (`{}`)", reason.as_str())
        }
        Decision::CompleteLeg(AfterLeg::NextLeg) => {
            "book the task; the next leg starts, and a path is wanted".into()
        }
        Decision::DropLeg => "give the leg up, remove its edge, ask for a route from here".into(),
        Decision::WantPath => "a path is wanted".into(),
        Decision::AskPath => "ask for a path to the target, or to the free place near it".into(),
        Decision::AskShorterPath => "ask for a shorter path".into(),
        Decision::Follow => "the path goes into force".into(),
        Decision::Hold => {
            "stay here until the current lets the vehicle pass, or want a path where it cannot stay; the mode is Holding".into()
        }
        Decision::Wait => "wait on the trajectory in force; the mode is Evading".into(),
        Decision::RenewWayOn => {
            "take another way on from the end of the trajectory in force, if one is clear".into()
        }
        Decision::Evade => "evade at once, without a planner; on a leg the mode is Evading".into(),
        Decision::Climb => {
            "climb at once, clear of the bed as measured, or evade where no climb is free; on a leg the mode is Climbing".into()
        }
        Decision::Surface => {
            "surface for a fix; where that is not clear, go on, or evade at the end of the trajectory; on a leg the mode is Surfacing".into()
        }
        Decision::Abort(reason) => {
            format!("abort: {reason}; fly the first contingency that can be flown")
        }
        Decision::SeekAgain => "seek a contingency again".into(),
    }
}

fn listed(situation: Situation, trigger: Trigger) -> Vec<&'static Rule> {
    let lists = rules(situation, trigger);
    lists.iter().flat_map(|list| list.iter()).collect()
}

fn condition(when: &When) -> &'static str {
    match when {
        When::Is(fact) => fact.texts()[0],
        When::Not(fact) => fact.texts()[1],
    }
}

/// The facts that rules mention.
fn mentioned(rules: &[&Rule]) -> Vec<Fact> {
    let facts = rules
        .iter()
        .flat_map(|rule| rule.when)
        .map(|when| match when {
            When::Is(fact) | When::Not(fact) => *fact,
        });
    facts.collect::<BTreeSet<Fact>>().into_iter().collect()
}

/// Every combination of the facts that can matter.
fn worlds(facts: &[Fact]) -> impl Iterator<Item = Facts> + '_ {
    (0..1_u64 << facts.len()).map(|bits| {
        let facts = facts.iter().enumerate();
        facts.fold(Facts::default(), |world, (i, &fact)| {
            world.with(fact, bits & (1 << i) != 0)
        })
    })
}

/// Calls a function for all modes, triggers and facts that can matter.
fn everywhere(mut claim: impl FnMut(Situation, Trigger, Facts, Decision)) {
    for (situation, _) in SITUATIONS {
        for (trigger, _) in TRIGGERS {
            let facts = mentioned(&listed(situation, trigger));
            for world in worlds(&facts) {
                let decision = decide(situation, trigger, world);
                claim(situation, trigger, world, decision);
            }
        }
    }
}

fn is_leg(situation: Situation) -> bool {
    !matches!(
        situation,
        Situation::Ready | Situation::AwaitRoute | Situation::Contingency | Situation::Finished
    )
}

#[test]
fn every_rule_decides_somewhere() {
    for (situation, _) in SITUATIONS {
        for (trigger, _) in TRIGGERS {
            let rules = listed(situation, trigger);
            let facts = mentioned(&rules);
            let mut deciding = BTreeSet::new();
            for world in worlds(&facts) {
                let holds = |when: &When| match *when {
                    When::Is(fact) => world.holds(fact),
                    When::Not(fact) => !world.holds(fact),
                };
                deciding.extend(rules.iter().position(|rule| rule.when.iter().all(holds)));
            }
            let all: BTreeSet<usize> = (0..rules.len()).collect();
            assert_eq!(deciding, all, "{situation:?}, {trigger:?}");
        }
    }
}

#[test]
fn an_ended_mission_changes_nothing_and_an_aborted_one_never_plans() {
    everywhere(|situation, trigger, _, decision| {
        let allowed = match situation {
            Situation::Finished => decision == Decision::Continue,
            Situation::Contingency => matches!(
                decision,
                Decision::Continue
                    | Decision::SeekAgain
                    | Decision::EndContingency
                    | Decision::Finish(_)
                    | Decision::Abort(crate::AbortReason::Unreachable)
            ),
            _ => true,
        };
        assert!(allowed, "{situation:?}, {trigger:?}: {decision:?}");
    });
}

#[test]
fn one_question_is_open_at_a_time() {
    everywhere(|situation, trigger, facts, decision| {
        let awaits = matches!(
            situation,
            Situation::AwaitRoute
                | Situation::LegAwaitsPath
                | Situation::LegAwaitsShorterPath
                | Situation::LegAwaitsNextRoute
        );
        if awaits && trigger == Trigger::Tick {
            let arrives = matches!(decision, Decision::CompleteLeg(_));
            let keeps = matches!(
                decision,
                Decision::Continue
                    | Decision::Evade
                    | Decision::Climb
                    | Decision::RenewWayOn
                    | Decision::Abort(_)
            );
            assert!(arrives || keeps, "{situation:?}, {facts:?}: {decision:?}");
        }
    });
}

#[test]
fn a_trajectory_that_is_not_clear_is_never_just_followed() {
    everywhere(|situation, trigger, facts, decision| {
        let flies = is_leg(situation) || situation == Situation::AwaitRoute;
        let threatened = facts.holds(Fact::InForce) && !facts.holds(Fact::Clear);
        if trigger == Trigger::Tick && flies && threatened && !facts.holds(Fact::Arrived) {
            let passive = matches!(
                decision,
                Decision::Continue | Decision::AskShorterPath | Decision::AskNextRoute
            );
            assert!(!passive, "{situation:?}, {facts:?}: {decision:?}");
        }
    });
}

/// Decisions written down apart from the rules.
mod written_down {
    use crate::decide::{Decision as D, Situation as S};
    use crate::facts::Fact::{self, *};
    use crate::trigger::Trigger as T;
    use crate::{AbortReason, Outcome, RouteReason};

    pub(super) const EXPECTED: &[(S, T, &[Fact], D)] = &[
        (S::Ready, T::Tick, &[], D::AskRoute(RouteReason::Start)),
        (
            S::Underway,
            T::Tick,
            &[InForce, OnTrack, Clear],
            D::Continue,
        ),
        (S::Underway, T::Tick, &[InForce, Clear], D::Continue),
        (
            S::Underway,
            T::Tick,
            &[InForce, Clear, ReactDue],
            D::WantPath,
        ),
        (S::Underway, T::Tick, &[InForce, OnTrack], D::Evade),
        (
            S::Underway,
            T::Tick,
            &[InForce, OnTrack, ReactDue],
            D::WantPath,
        ),
        (
            S::Underway,
            T::Tick,
            &[InForce, Clear, ProjectedLate],
            D::Continue,
        ),
        (
            S::Underway,
            T::Tick,
            &[InForce, OnTrack, Clear, ImproveDue],
            D::AskShorterPath,
        ),
        (
            S::Underway,
            T::Tick,
            &[InForce, OnTrack, Clear, ImproveDue, Covered],
            D::Continue,
        ),
        (
            S::Underway,
            T::Tick,
            &[InForce, OnTrack, Clear, ShortOfTime],
            D::DropLeg,
        ),
        (
            S::AtStandOff,
            T::Tick,
            &[InForce, OnTrack, Clear, RetryDue],
            D::WantPath,
        ),
        (
            S::AtStandOff,
            T::Tick,
            &[InForce, OnTrack, Clear, RetryDue, Covered],
            D::Continue,
        ),
        (
            S::Evading,
            T::Tick,
            &[InForce, Clear, ShutIn, ToDestination],
            D::Abort(AbortReason::ShutIn),
        ),
        (
            S::Evading,
            T::Tick,
            &[InForce, Clear, ShutIn, ToDestination, Covered],
            D::Continue,
        ),
        (
            S::Evading,
            T::Tick,
            &[InForce, Clear, WaitedTooLong],
            D::DropLeg,
        ),
        (
            S::Evading,
            T::Tick,
            &[InForce, Clear, WaitedTooLong, ToDestination],
            D::Continue,
        ),
        (
            S::Evading,
            T::Tick,
            &[InForce, Clear, EnergyLow, ToDestination, Covered],
            D::Abort(AbortReason::EnergySpent),
        ),
        (
            S::LegAwaitsPath,
            T::Tick,
            &[InForce, OnTrack, Clear, Over],
            D::Evade,
        ),
        (
            S::LegAwaitsPath,
            T::PathAnswered,
            &[FirstFailure, Clear],
            D::WantPath,
        ),
        (
            S::LegAwaitsPath,
            T::PathAnswered,
            &[Clear, LeadsOn],
            D::Continue,
        ),
        (S::LegAwaitsPath, T::PathAnswered, &[Clear], D::Wait),
        (S::LegAwaitsPath, T::PathAnswered, &[Accepted], D::Follow),
        (
            S::LegAwaitsShorterPath,
            T::PathAnswered,
            &[Accepted],
            D::Continue,
        ),
        (
            S::LegAwaitsShorterPath,
            T::PathAnswered,
            &[Accepted, Earlier],
            D::Follow,
        ),
        (S::Evading, T::PathWanted, &[CallsSpent], D::DropLeg),
        (
            S::Evading,
            T::PathWanted,
            &[CallsSpent, ToDestination],
            D::AskPath,
        ),
        (
            S::Evading,
            T::PathWanted,
            &[Covered, StandOffFree],
            D::AskPath,
        ),
        (S::Evading, T::PathWanted, &[Covered, Clear], D::Wait),
        (
            S::AwaitRoute,
            T::RouteAnswered,
            &[PlannerFailed, TriesLeft],
            D::AskRouteAgain,
        ),
        (S::AwaitRoute, T::RouteAnswered, &[PlannerFailed], D::GoHome),
        (S::AwaitRoute, T::RouteAnswered, &[TriesLeft], D::GoHome),
        (
            S::LegAwaitsNextRoute,
            T::RouteAnswered,
            &[PlannerFailed, TriesLeft],
            D::KeepLeg,
        ),
        (
            S::LegAwaitsNextRoute,
            T::SonarLost,
            &[],
            D::Abort(AbortReason::SonarLost),
        ),
        (
            S::LegAwaitsNextRoute,
            T::SonarLost,
            &[HomeWithoutSonar],
            D::Continue,
        ),
        (S::Underway, T::SonarLost, &[HomeWithoutSonar], D::GoHome),
        (
            S::Underway,
            T::SonarLost,
            &[HomeWithoutSonar, Homeward],
            D::Continue,
        ),
        (
            S::Contingency,
            T::Tick,
            &[Clear, ContingencyFlown, MaySeek],
            D::Continue,
        ),
        (
            S::Contingency,
            T::Tick,
            &[ContingencyFlown, MaySeek],
            D::SeekAgain,
        ),
        (
            S::Contingency,
            T::Tick,
            &[Clear, Over, ContingencyFlown, MaySeek],
            D::EndContingency,
        ),
        (
            S::Contingency,
            T::Tick,
            &[Clear, Over, MaySeek],
            D::SeekAgain,
        ),
        (
            S::Contingency,
            T::ClockLost,
            &[],
            D::Finish(Outcome::Aborted(AbortReason::BadClock)),
        ),
    ];
}

#[test]
fn decisions_are_as_written_down() {
    for (situation, trigger, facts, decision) in written_down::EXPECTED {
        let facts = facts
            .iter()
            .fold(Facts::default(), |all, fact| all.with(*fact, true));
        assert_eq!(
            decide(*situation, *trigger, facts),
            *decision,
            "{situation:?}, {trigger:?}, {facts:?}"
        );
    }
}

#[test]
fn watchdogs_come_first() {
    everywhere(|situation, trigger, facts, decision| {
        let flies = is_leg(situation) || situation == Situation::AwaitRoute;
        if trigger == Trigger::Tick && flies {
            let due = facts.holds(Fact::TimedOut) || facts.holds(Fact::AltitudeLost);
            let aborts = matches!(
                decision,
                Decision::Abort(crate::AbortReason::TimedOut | crate::AbortReason::NoAltitude)
            );
            assert_eq!(due, aborts, "{situation:?}, {facts:?}: {decision:?}");
        }
    });
}

/// The generated part of `docs/synchroniser.md`: by what happens, modes with equal rules together.
fn table() -> String {
    let mut out = String::from("\n## Modes\n\n| mode | meaning |\n|---|---|\n");
    for (situation, meaning) in SITUATIONS {
        let _ = writeln!(out, "| {situation:?} | {meaning} |");
    }
    for (trigger, said) in TRIGGERS.into_iter().take(5) {
        let _ = write!(out, "\n## When {said}\n");
        let mut printed: Vec<Vec<Situation>> = Vec::new();
        for (situation, _) in SITUATIONS
            .into_iter()
            .filter(|(s, _)| can_happen(*s, trigger))
        {
            let same =
                |group: &&mut Vec<Situation>| rules(group[0], trigger) == rules(situation, trigger);
            match printed.iter_mut().find(same) {
                Some(group) => group.push(situation),
                None => printed.push(vec![situation]),
            }
        }
        for group in printed {
            print_rules(&mut out, &group, &listed(group[0], trigger));
        }
    }
    out.push_str("\n## In every mode\n\n| when | then |\n|---|---|\n");
    for (trigger, said) in TRIGGERS.into_iter().skip(5) {
        let decision = decide(Situation::Underway, trigger, Facts::default());
        let _ = writeln!(out, "| {said} | {} |", text(decision));
    }
    out.push_str("\nBefore the first tick, and once aborted, a mission ignores the altitude and the sonar. An ended mission ignores everything.\n");
    out
}

fn print_rules(out: &mut String, modes: &[Situation], rules: &[&Rule]) {
    if rules.is_empty() {
        return;
    }
    let modes: Vec<String> = modes.iter().map(|mode| format!("{mode:?}")).collect();
    let _ = write!(
        out,
        "\n### {}\n\n| if | then |\n|---|---|\n",
        modes.join(", ")
    );
    for rule in rules {
        let conditions: Vec<&str> = rule.when.iter().map(condition).collect();
        let when = if conditions.is_empty() {
            "else".into()
        } else {
            conditions.join("; ")
        };
        let _ = writeln!(out, "| {when} | {} |", text(rule.then));
    }
    if rules.last().is_some_and(|rule| !rule.when.is_empty()) {
        let _ = writeln!(out, "| else | nothing changes |");
    }
}

/// Whether a table is printed: an answer comes only where a question is open.
fn can_happen(situation: Situation, trigger: Trigger) -> bool {
    match trigger {
        Trigger::RouteAnswered => {
            matches!(
                situation,
                Situation::AwaitRoute | Situation::LegAwaitsNextRoute
            )
        }
        Trigger::PathAnswered => {
            matches!(
                situation,
                Situation::LegAwaitsPath | Situation::LegAwaitsShorterPath
            )
        }
        // A path is wanted while nothing is asked.
        Trigger::PathWanted => {
            Situation::AwaitFirstPath <= situation && situation <= Situation::Surfacing
        }
        _ => true,
    }
}

#[test]
fn the_table_stands_in_the_docs() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/synchroniser.md");
    // A package has no docs folder.
    let Ok(old) = std::fs::read_to_string(&file) else {
        return;
    };
    let mark = "<!-- printed by the tests of auv-mission from here on -->\n";
    let (head, printed) = old.split_once(mark).unwrap();
    if std::env::var("UPDATE_GOLDEN").is_ok_and(|value| value == "1") {
        std::fs::write(&file, format!("{head}{mark}{}", table())).unwrap();
        return;
    }
    let same = printed == table();
    assert!(same, "write docs/synchroniser.md with UPDATE_GOLDEN=1");
}
