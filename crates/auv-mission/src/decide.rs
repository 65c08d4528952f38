//! The decision table: what is done next, from the mode, what happened, and the facts.
//!
//! Each mode has an ordered list of rules; the first that holds decides. `docs/synchroniser.md` is
//! printed from these lists.

use crate::facts::Fact::{self, *};
use crate::facts::Facts;
use crate::mode::{Awaited, LegMode, Mode, NextRoute};
use crate::trigger::Trigger;
use crate::{AbortReason, Outcome, RouteReason};

/// What is done next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Decision {
    /// Nothing changes.
    Continue,
    /// The mission ends.
    Finish(Outcome),
    /// The aborted mission ends.
    EndContingency,
    /// A route is asked for from the last waypoint.
    AskRoute(RouteReason),
    /// A route from the leg's target is asked for while the leg is flown.
    AskNextRoute,
    /// The same question is asked again with a new seed.
    AskRouteAgain,
    /// The route goes into force and its first leg starts.
    AdoptRoute,
    /// The route after the leg goes into force; the leg goes on.
    AdoptNextRoute,
    /// The route answer is recorded; the leg goes on.
    KeepLeg,
    /// The quickest way home goes into force; no planner is asked.
    GoHome,
    /// The leg is recorded and its task booked.
    CompleteLeg(AfterLeg),
    /// The leg is given up, its edge taken out, and a route from here asked for.
    DropLeg,
    /// A path is wanted: where it may lead is computed first.
    WantPath,
    /// A path is asked for.
    AskPath,
    /// A shorter path is asked for.
    AskShorterPath,
    /// The accepted path goes into force.
    Follow,
    /// The vehicle stays where it is until the current lets it pass; where it cannot, a path is wanted at once.
    Hold,
    /// The vehicle follows the trajectory in force, which leads to no target, and waits.
    Wait,
    /// The vehicle evades at once, without a planner.
    Evade,
    /// The vehicle climbs at once, clear of the bed as measured.
    Climb,
    /// The vehicle surfaces for a fix.
    Surface,
    /// Another way on from the end of the trajectory in force is sought.
    RenewWayOn,
    /// The mission is aborted: a contingency is sought.
    Abort(AbortReason),
    /// A contingency is sought again.
    SeekAgain,
}

/// What follows a completed leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AfterLeg {
    /// The mission ends at its destination.
    Finish(Outcome),
    /// A route is asked for.
    AskRoute(RouteReason),
    /// The next leg of the route starts.
    NextLeg,
}

/// Whether a fact must hold or must not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum When {
    Is(Fact),
    Not(Fact),
}
use When::{Is, Not};

/// If all conditions hold, this is decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rule {
    pub(crate) when: &'static [When],
    pub(crate) then: Decision,
}

const fn rule(when: &'static [When], then: Decision) -> Rule {
    Rule { when, then }
}

impl Rule {
    fn holds(&self, facts: Facts) -> bool {
        self.when.iter().all(|when| match *when {
            Is(fact) => facts.holds(fact),
            Not(fact) => !facts.holds(fact),
        })
    }
}

/// A mode as decisions see it: without its times and places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Situation {
    Ready,
    AwaitRoute,
    /// On a leg, with nothing asked.
    AwaitFirstPath,
    Holding,
    Underway,
    AtTarget,
    ToStandOff,
    AtStandOff,
    Evading,
    Climbing,
    Surfacing,
    /// On a leg in any mode, with this asked.
    LegAwaitsPath,
    LegAwaitsShorterPath,
    LegAwaitsNextRoute,
    Contingency,
    Finished,
}

impl Situation {
    pub(crate) fn of(mode: &Mode) -> Self {
        let leg = match mode {
            Mode::Ready => return Self::Ready,
            Mode::AwaitRoute(_) => return Self::AwaitRoute,
            Mode::Contingency(_) => return Self::Contingency,
            Mode::Finished { .. } => return Self::Finished,
            Mode::Leg(leg) => leg,
        };
        match (&leg.awaited, &leg.next_route, leg.mode) {
            (Awaited::Path(_), ..) => Self::LegAwaitsPath,
            (Awaited::ShorterPath(_), ..) => Self::LegAwaitsShorterPath,
            (Awaited::Nothing, NextRoute::Asked(_), _) => Self::LegAwaitsNextRoute,
            (Awaited::Nothing, _, LegMode::AwaitFirstPath) => Self::AwaitFirstPath,
            (Awaited::Nothing, _, LegMode::Holding) => Self::Holding,
            (Awaited::Nothing, _, LegMode::Underway { .. }) => Self::Underway,
            (Awaited::Nothing, _, LegMode::AtTarget { .. }) => Self::AtTarget,
            (Awaited::Nothing, _, LegMode::ToStandOff { .. }) => Self::ToStandOff,
            (Awaited::Nothing, _, LegMode::AtStandOff { .. }) => Self::AtStandOff,
            (Awaited::Nothing, _, LegMode::Evading) => Self::Evading,
            (Awaited::Nothing, _, LegMode::Climbing) => Self::Climbing,
            (Awaited::Nothing, _, LegMode::Surfacing) => Self::Surfacing,
        }
    }

    fn is_under_way(self) -> bool {
        !matches!(self, Self::Ready | Self::Contingency | Self::Finished)
    }

    fn is_on_leg(self) -> bool {
        self.is_under_way() && self != Self::AwaitRoute
    }
}

/// What is done next. Pure: equal arguments give equal decisions.
pub(crate) fn decide(situation: Situation, trigger: Trigger, facts: Facts) -> Decision {
    let rules = rules(situation, trigger)
        .iter()
        .flat_map(|list| list.iter());
    rules
        .into_iter()
        .find(|rule| rule.holds(facts))
        .map_or(Decision::Continue, |rule| rule.then)
}

/// The rules of a situation, list after list.
pub(crate) fn rules(situation: Situation, trigger: Trigger) -> &'static [&'static [Rule]] {
    use Situation as S;
    use Trigger as H;
    match (trigger, situation) {
        (_, S::Finished) => &[],
        (H::ClockLost, _) => &[CLOCK_LOST],
        (H::PositionLost, _) => &[POSITION_LOST],
        (H::NoManoeuvre, _) => &[END],
        (H::NoLeg | H::NoWayHome, _) => &[UNREACHABLE],
        (H::BedTooNear, _) if situation.is_under_way() => &[BED_TOO_NEAR],
        (H::SonarLost, S::AwaitRoute | S::LegAwaitsNextRoute) => &[WITHOUT_SONAR],
        (H::SonarLost, _) if situation.is_under_way() => &[WITHOUT_SONAR, HOME_WITHOUT_SONAR],
        (H::CannotFollow, _) if situation.is_under_way() => &[ASTRAY],
        (H::Leak, _) if situation.is_under_way() => &[LEAK],
        (H::BedTooNear | H::SonarLost | H::CannotFollow | H::Leak, _) => &[],
        (H::Tick, S::Ready) => &[LAUNCH],
        (H::Tick, S::Contingency) => &[CONTINGENCY],
        (H::Tick, S::AwaitRoute | S::AwaitFirstPath) => &[WATCHDOGS, KEEP_CLEAR],
        (H::Tick, S::LegAwaitsPath | S::LegAwaitsShorterPath | S::LegAwaitsNextRoute) => {
            &[WATCHDOGS, ARRIVAL, KEEP_CLEAR]
        }
        (H::Tick, S::Underway | S::AtTarget) => &[WATCHDOGS, FIX, ARRIVAL, TIME, TRACK, TO_TARGET],
        (H::Tick, S::ToStandOff | S::AtStandOff) => &[WATCHDOGS, FIX, TIME, TRACK, TO_STAND_OFF],
        (H::Tick, S::Holding) => &[WATCHDOGS, TIME, HOLDING],
        (H::Tick, S::Evading) => &[WATCHDOGS, TIME, SHUT_IN, FIX, EVADING],
        (H::Tick, S::Climbing) => &[WATCHDOGS, TIME, SHUT_IN, CLIMBING],
        (H::Tick, S::Surfacing) => &[WATCHDOGS, SURFACING],
        (H::RouteAnswered, S::LegAwaitsNextRoute) => &[NEXT_ROUTE],
        (H::RouteAnswered, S::AwaitRoute) => &[ROUTE],
        (H::PathAnswered, S::LegAwaitsShorterPath) => &[SHORTER_PATH],
        (H::PathAnswered, S::LegAwaitsPath) => &[PATH, NO_PATH],
        (H::PathWanted, _) if situation.is_on_leg() => &[PATH_WANTED, NO_PATH],
        (H::RouteAnswered | H::PathAnswered | H::PathWanted, _) => &[],
    }
}

/// The first tick.
const LAUNCH: &[Rule] = &[
    rule(&[Is(StartIsDestination)], Decision::Finish(Outcome::Docked)),
    rule(&[], Decision::AskRoute(RouteReason::Start)),
];

/// What aborts every mission under way.
const WATCHDOGS: &[Rule] = &[
    rule(&[Is(TimedOut)], Decision::Abort(AbortReason::TimedOut)),
    rule(
        &[Is(AltitudeLost)],
        Decision::Abort(AbortReason::NoAltitude),
    ),
    rule(
        &[Is(CannotFollow)],
        Decision::Abort(AbortReason::CannotFollow),
    ),
    rule(&[Not(InForce)], Decision::Continue),
];

/// Where the vehicle is must be known before anything else is done there.
const FIX: &[Rule] = &[rule(
    &[Is(FixDue), Is(OnTrack), Is(Clear)],
    Decision::Surface,
)];

/// The leg is complete.
const ARRIVAL: &[Rule] = &[
    rule(
        &[Is(Arrived), Is(ToDestination), Is(InTime)],
        Decision::CompleteLeg(AfterLeg::Finish(Outcome::Docked)),
    ),
    rule(
        &[Is(Arrived), Is(ToDestination)],
        Decision::CompleteLeg(AfterLeg::Finish(Outcome::Late)),
    ),
    rule(
        &[Is(Arrived), Is(RouteWanted), Is(Late)],
        Decision::CompleteLeg(AfterLeg::AskRoute(RouteReason::Late)),
    ),
    rule(
        &[Is(Arrived), Is(RouteWanted)],
        Decision::CompleteLeg(AfterLeg::AskRoute(RouteReason::Waypoint)),
    ),
    rule(&[Is(Arrived)], Decision::CompleteLeg(AfterLeg::NextLeg)),
];

/// While an answer is awaited.
const KEEP_CLEAR: &[Rule] = &[
    rule(&[Is(Over), Not(GoesOn)], Decision::Evade),
    rule(&[Is(TooLow), Not(Clear)], Decision::Climb),
    rule(&[Not(Clear)], Decision::Evade),
    rule(&[Is(WayOnBlocked)], Decision::RenewWayOn),
];

const TIME: &[Rule] = &[rule(&[Is(ShortOfTime)], Decision::DropLeg)];

/// On a path: it must be flown, and it must be clear.
const TRACK: &[Rule] = &[
    rule(&[Is(TooLow)], Decision::Climb),
    rule(&[Is(Over), Not(GoesOn)], Decision::WantPath),
    rule(&[Is(Over), Is(ReactDue)], Decision::WantPath),
    rule(&[Not(OnTrack), Is(ReactDue)], Decision::WantPath),
    rule(&[Not(Clear), Is(ReactDue)], Decision::WantPath),
    rule(&[Not(Clear)], Decision::Evade),
    rule(&[Not(OnTrack)], Decision::Continue),
];

const TO_TARGET: &[Rule] = &[
    rule(&[Is(ProjectedLate)], Decision::AskNextRoute),
    rule(&[Is(ImproveDue), Not(Covered)], Decision::AskShorterPath),
    rule(&[Is(WayOnBlocked)], Decision::RenewWayOn),
];

const TO_STAND_OFF: &[Rule] = &[
    rule(&[Is(RetryDue), Not(Covered)], Decision::WantPath),
    rule(&[Is(WayOnBlocked)], Decision::RenewWayOn),
];

/// No path leads to the target. A vehicle that waits for a covered destination does not count as shut
/// in.
const SHUT_IN: &[Rule] = &[
    rule(
        &[Is(ShutIn), Not(ToDestination)],
        Decision::Abort(AbortReason::ShutIn),
    ),
    rule(
        &[Is(ShutIn), Not(Covered)],
        Decision::Abort(AbortReason::ShutIn),
    ),
    rule(&[Is(EnergyLow)], Decision::Abort(AbortReason::EnergySpent)),
    rule(&[Is(WaitedTooLong), Not(ToDestination)], Decision::DropLeg),
];

/// The current is against the leg. A path is asked for when it lets the vehicle pass.
const HOLDING: &[Rule] = &[
    rule(&[Is(TooLow), Not(Clear)], Decision::Climb),
    rule(&[Not(Clear)], Decision::Evade),
    rule(&[Is(Over)], Decision::WantPath),
    rule(&[Is(WayOnBlocked)], Decision::RenewWayOn),
];

const EVADING: &[Rule] = &[
    rule(&[Is(Over), Not(GoesOn)], Decision::WantPath),
    rule(&[Is(TooLow), Not(Clear)], Decision::Climb),
    rule(&[Is(RetryDue)], Decision::WantPath),
    rule(&[Not(Clear)], Decision::Evade),
    rule(&[Is(WayOnBlocked)], Decision::RenewWayOn),
];

/// A path is asked for from where the climb ends, or before where obstacles are in the way.
const CLIMBING: &[Rule] = &[
    rule(&[Is(TooLow), Not(Clear)], Decision::Climb),
    rule(&[Is(Over), Not(GoesOn)], Decision::WantPath),
    rule(&[Is(TooLow), Not(Over)], Decision::Continue),
    rule(&[Is(Over), Is(ReactDue)], Decision::WantPath),
    rule(&[Not(Clear), Is(ReactDue)], Decision::WantPath),
    rule(&[Not(Clear)], Decision::Evade),
    rule(&[Is(WayOnBlocked)], Decision::RenewWayOn),
];

/// Once the place is known, or cannot be, the leg goes on.
const SURFACING: &[Rule] = &[
    rule(&[Not(FixDue)], Decision::WantPath),
    rule(&[Not(Clear)], Decision::Evade),
    rule(&[Is(Over)], Decision::Surface),
];

const PATH_WANTED: &[Rule] = &[
    rule(&[Is(TooEarly)], Decision::Hold),
    rule(&[Is(OverShoal), Not(ToDestination)], Decision::DropLeg),
    rule(&[Is(OverShoal)], Decision::Abort(AbortReason::TooLow)),
    rule(&[Is(CallsSpent), Not(ToDestination)], Decision::DropLeg),
    rule(&[Not(Covered)], Decision::AskPath),
    rule(&[Is(StandOffFree)], Decision::AskPath),
];

const PATH: &[Rule] = &[
    rule(&[Is(Accepted)], Decision::Follow),
    rule(&[Is(FirstFailure)], Decision::WantPath),
];

const SHORTER_PATH: &[Rule] = &[rule(&[Is(Accepted), Is(Earlier)], Decision::Follow)];

/// There is no path now.
const NO_PATH: &[Rule] = &[
    rule(&[Is(Over), Not(GoesOn)], Decision::Evade),
    rule(&[Not(Clear)], Decision::Evade),
    rule(&[Is(LeadsOn)], Decision::Continue),
    rule(&[], Decision::Wait),
];

const ROUTE: &[Rule] = &[
    rule(&[Is(RouteThere)], Decision::AdoptRoute),
    rule(&[Is(PlannerFailed), Is(TriesLeft)], Decision::AskRouteAgain),
    rule(&[], Decision::GoHome),
];

const NEXT_ROUTE: &[Rule] = &[
    rule(&[Is(RouteThere)], Decision::AdoptNextRoute),
    rule(&[], Decision::KeepLeg),
];

const WITHOUT_SONAR: &[Rule] = &[rule(
    &[Not(HomeWithoutSonar)],
    Decision::Abort(AbortReason::SonarLost),
)];

const HOME_WITHOUT_SONAR: &[Rule] = &[rule(&[Not(Homeward)], Decision::GoHome)];

/// A contingency is flown to its end, as long as it stays clear.
const CONTINGENCY: &[Rule] = &[
    rule(&[Is(ContingencyFlown), Is(Over)], Decision::EndContingency),
    rule(&[Is(Over), Not(MaySeek)], Decision::EndContingency),
    rule(&[Not(Clear), Not(MaySeek)], Decision::EndContingency),
    rule(&[Is(Over)], Decision::SeekAgain),
    rule(&[Not(Clear)], Decision::SeekAgain),
];

const CLOCK_LOST: &[Rule] = &[rule(
    &[],
    Decision::Finish(Outcome::Aborted(AbortReason::BadClock)),
)];

const POSITION_LOST: &[Rule] = &[rule(
    &[],
    Decision::Finish(Outcome::Aborted(AbortReason::BadPosition)),
)];

const BED_TOO_NEAR: &[Rule] = &[rule(&[], Decision::Abort(AbortReason::TooLow))];

const ASTRAY: &[Rule] = &[rule(&[], Decision::Abort(AbortReason::CannotFollow))];
/// Water in the vehicle.
const LEAK: &[Rule] = &[rule(&[], Decision::Abort(AbortReason::Leak))];

const UNREACHABLE: &[Rule] = &[rule(&[], Decision::Abort(AbortReason::Unreachable))];

const END: &[Rule] = &[rule(&[], Decision::EndContingency)];
