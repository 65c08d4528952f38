//! Facts: what a decision depends on, apart from the mode and the trigger.

use crate::astray;
use crate::leg_time;
use crate::mode::{Leg, Mode};
use crate::path_question::Reach;
use crate::surfacing;
use crate::trigger::{Payload, Trigger};
use crate::view::{MOMENT_S, View};
use crate::{ReplanPolicy, WithoutSonar};
use auv_types::libm;

/// A route is asked for again while fewer answers in a row were invalid. After as many panics a driver
/// lets a baseline answer.
const MOST_ROUTE_FAILURES: usize = 3;
/// Manoeuvres sought again at most.
const MOST_SOUGHT: u32 = 50;
/// A shorter path must arrive earlier by this, seconds.
const LEAST_GAIN_S: f64 = 1.0;
/// Surfacing must be possible this many times with the energy left.
const SURFACINGS: f64 = 2.0;
/// The least sine of the pitch with which the energy to surface is computed.
const LEAST_SLOPE: f64 = 0.01;

macro_rules! facts {
    ($($name:ident: $holds:literal, $else:literal;)*) => {
        /// Something that is true or not at a moment.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub(crate) enum Fact {
            $(#[doc = $holds] $name),*
        }

        #[cfg(test)]
        impl Fact {
            /// What it says when it holds, and when it does not.
            pub(crate) const fn texts(self) -> [&'static str; 2] {
                match self {
                    $(Self::$name => [$holds, $else]),*
                }
            }
        }
    };
}

facts! {
    StartIsDestination: "start and destination are the same place", "start and destination differ";
    TimedOut: "the mission has lasted `timeout_factor` times its budget", "the mission is within `timeout_factor` times its budget";
    AltitudeLost: "the altitude has been silent for longer than `altitude_silence_s`", "the altitude is measured, or never was";
    InForce: "a trajectory is in force", "no trajectory is in force";
    Over: "the trajectory in force is flown to its end", "the trajectory in force goes on";
    GoesOn: "the way on from there is being flown", "there is no way on from there, or it is flown to its end";
    OnTrack: "the vehicle is on the trajectory in force", "the vehicle is off the trajectory in force";
    Clear: "the trajectory in force is clear", "the trajectory in force is not clear";
    TooLow: "the vehicle is too low over the bed as measured", "the vehicle is not too low over the bed as measured";
    WayOnBlocked: "the way on from the end of the trajectory in force is not clear", "the way on from the end of the trajectory in force is clear, or there is none";
    Arrived: "the vehicle is at the target and the task is done", "the vehicle is not at the target, or the task is not done";
    OverShoal: "the vehicle is over the target, and the bed as measured lets it no nearer than `off_track_m`", "the bed as measured lets the vehicle to the target";
    LeadsOn: "the trajectory in force leads to the target or a stand-off", "the trajectory in force leads to neither";
    ToDestination: "the leg leads to the destination", "the leg leads to another waypoint";
    InTime: "time is left", "no time is left";
    Late: "the leg took longer than expected", "the leg took no longer than expected";
    RouteWanted: "the replan policy asks for a route after this leg", "the replan policy asks for no route after this leg";
    Homeward: "the quickest way home is being flown", "tasks are being flown";
    ShortOfTime: "finishing the leg would leave too little time for the way home", "finishing the leg leaves enough time for the way home";
    ShutIn: "the vehicle has made no progress for longer than `max_shut_in_s`", "the vehicle has made progress within `max_shut_in_s`";
    EnergyLow: "the energy left is needed to surface", "energy is left beyond surfacing";
    WaitedTooLong: "the target has been waited for longer than `max_wait_s`", "the target has been waited for no longer than `max_wait_s`";
    RetryDue: "the last path call is at least `retry_s` ago", "the last path call is less than `retry_s` ago";
    ReactDue: "the last path call is at least `react_s` ago", "the last path call is less than `react_s` ago";
    ImproveDue: "the path makes a detour, the last path call is at least `improve_s` ago and calls are left", "no shorter path is due";
    ProjectedLate: "the policy is `projected`, the leg will be late, and no route was asked for that yet", "no lateness is projected";
    Covered: "the target is covered on arrival", "the target is free on arrival";
    StandOffFree: "a place to wait near the target is free", "no place to wait near the target is free";
    CallsSpent: "the leg's path calls are spent", "path calls of the leg are left";
    Accepted: "the path may go into force", "the path may not go into force";
    Earlier: "it arrives at least 1 s earlier", "it does not arrive 1 s earlier";
    FirstFailure: "it is the first failure since a path was accepted", "attempts have failed before";
    RouteThere: "a valid route is there: the new one, or the one in force", "no valid route is there";
    PlannerFailed: "the planner failed, or called a route feasible that is not valid", "the planner found no feasible route";
    TriesLeft: "fewer than three answers in a row were invalid before", "three answers in a row were invalid before";
    ContingencyFlown: "a contingency is being flown", "the vehicle evades because no contingency can be flown";
    MaySeek: "manoeuvres were sought again fewer than 50 times", "manoeuvres were sought again 50 times";
    TooEarly: "the current lets the vehicle pass later only", "the current lets the vehicle pass now";
    CannotFollow: "the vehicle has left its trajectories for longer than `cannot_follow_s` and gets no nearer to the target", "the vehicle follows its trajectories, or gets nearer to the target";
    FixDue: "the place is known too badly, and a fix at the surface is due", "no fix at the surface is due";
    HomeWithoutSonar: "`without_sonar` is `go_home`", "`without_sonar` is `give_up`";
}

/// The facts that hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Facts(u64);

impl Facts {
    pub(crate) fn holds(self, fact: Fact) -> bool {
        self.0 & (1 << fact as u64) != 0
    }

    pub(crate) fn with(self, fact: Fact, holds: bool) -> Self {
        if holds {
            Self(self.0 | (1 << fact as u64))
        } else {
            self
        }
    }

    /// The facts that matter for a trigger.
    pub(crate) fn at(view: View<'_>, trigger: Trigger, payload: &Payload) -> Self {
        let facts = Self::default();
        match trigger {
            Trigger::Tick => facts.of_mission(view).of_trajectory(view).of_mode(view),
            Trigger::SonarLost => facts.of_mission(view),
            Trigger::PathWanted | Trigger::PathAnswered => facts
                .of_trajectory(view)
                .of_mode(view)
                .of_payload(view, payload),
            Trigger::RouteAnswered => facts.of_payload(view, payload),
            Trigger::ClockLost
            | Trigger::PositionLost
            | Trigger::BedTooNear
            | Trigger::CannotFollow
            | Trigger::Leak
            | Trigger::NoLeg
            | Trigger::NoWayHome
            | Trigger::NoManoeuvre => facts,
        }
    }

    fn of_mission(self, view: View<'_>) -> Self {
        let mission = view.mission;
        let spent_s = view.now_s() - view.state.ledger.started_s;
        let watchdogs = &view.settings.watchdogs;
        let timed_out = spent_s > watchdogs.timeout_factor * mission.budget_s;
        let altitude_lost = view
            .beliefs()
            .altitude_is_lost(watchdogs.altitude_silence_s);
        let goes_home = watchdogs.without_sonar == WithoutSonar::GoHome;
        self.with(
            Fact::StartIsDestination,
            mission.start == mission.destination,
        )
        .with(Fact::TimedOut, timed_out)
        .with(Fact::AltitudeLost, altitude_lost)
        .with(Fact::InTime, view.available_s() >= 0.0)
        .with(Fact::Homeward, view.state.route.is_homeward())
        .with(Fact::HomeWithoutSonar, goes_home)
    }

    fn of_trajectory(self, view: View<'_>) -> Self {
        self.with(Fact::InForce, view.state.in_force.is_some())
            .with(Fact::Over, view.is_over())
            .with(Fact::GoesOn, view.goes_on())
            .with(Fact::WayOnBlocked, view.way_on_is_blocked())
            .with(Fact::OnTrack, view.is_on_track())
            .with(Fact::TooLow, view.is_too_low())
            .with(Fact::Clear, view.in_force_is_clear())
    }

    fn of_mode(self, view: View<'_>) -> Self {
        match &view.state.mode {
            Mode::Leg(leg) => self.of_leg(view, leg),
            Mode::Contingency(state) => self
                .with(Fact::ContingencyFlown, state.flown.is_some())
                .with(Fact::MaySeek, state.sought < MOST_SOUGHT),
            Mode::Ready | Mode::AwaitRoute(_) | Mode::Finished { .. } => self,
        }
    }

    fn of_leg(self, view: View<'_>, leg: &Leg) -> Self {
        let waiting = &view.settings.waiting;
        let since_s = view.now_s() - leg.asked_s;
        let late = leg_time::is_late(view, leg);
        let homeward = view.state.route.is_homeward();
        let over_shoal = view.is_over_shoal(leg.to);
        let over_and_there = view.is_over() && view.is_on_track();
        let shut_in_s = |leg_s| view.state.ledger.shut_in_s(leg.waited_s, leg_s);
        let improve_due = since_s >= view.settings.replan.improve_s
            && leg.calls < waiting.max_path_calls
            && leg_time::makes_a_detour(view, leg);
        self.with(
            Fact::Arrived,
            leg.mode.leads_to_target()
                && view.state.in_force.is_some()
                && over_and_there
                && !over_shoal
                && !surfacing::blocks_docking(view, leg)
                && !surfacing::misses_dock(view, leg),
        )
        .with(Fact::FixDue, surfacing::is_due(view, leg))
        .with(Fact::CannotFollow, astray::cannot_follow(view, leg))
        .with(Fact::OverShoal, over_shoal)
        .with(Fact::LeadsOn, leg.mode.arrives_s().is_some())
        .with(Fact::ToDestination, view.mission.is_dock(leg.to))
        .with(Fact::Late, late)
        .with(Fact::RouteWanted, !homeward && wants_route(view, late))
        .with(Fact::ShortOfTime, leg_time::is_short_of_time(view, leg))
        .with(
            Fact::ShutIn,
            shut_in_s(leg_time::leg_s(view, leg)) > waiting.max_shut_in_s,
        )
        .with(Fact::EnergyLow, energy_is_low(view))
        .with(Fact::WaitedTooLong, leg.waited_s > waiting.max_wait_s)
        .with(Fact::RetryDue, since_s >= waiting.retry_s)
        .with(Fact::ReactDue, since_s >= waiting.react_s)
        .with(Fact::ImproveDue, improve_due)
        .with(Fact::ProjectedLate, leg_time::is_projected_late(view, leg))
        .with(Fact::TooEarly, view.now_s() < leg.departs_s - MOMENT_S)
        .with(Fact::Covered, leg_time::target_is_covered(view, leg))
        .with(Fact::CallsSpent, leg.calls >= waiting.max_path_calls)
        .with(Fact::FirstFailure, leg.failures == 0)
    }

    fn of_payload(self, view: View<'_>, payload: &Payload) -> Self {
        match payload {
            Payload::None => self,
            Payload::Reach(reach) => {
                self.with(Fact::StandOffFree, matches!(reach, Reach::StandOff(_)))
            }
            Payload::Path(accepted) => {
                let arrives_s = view.leg().and_then(|leg| leg.mode.arrives_s());
                let latest_s = arrives_s.unwrap_or(f64::INFINITY) - LEAST_GAIN_S;
                let accepted = accepted.as_ref();
                self.with(Fact::Accepted, accepted.is_some()).with(
                    Fact::Earlier,
                    accepted.is_some_and(|new| new.arrives_s <= latest_s),
                )
            }
            Payload::Route(judged) => {
                let failures = view.state.ledger.invalid_routes();
                self.with(Fact::RouteThere, judged.chosen.is_some())
                    .with(Fact::PlannerFailed, judged.failed)
                    .with(Fact::TriesLeft, failures < MOST_ROUTE_FAILURES)
            }
        }
    }
}

fn wants_route(view: View<'_>, late: bool) -> bool {
    match view.settings.replan.policy {
        ReplanPolicy::Late | ReplanPolicy::Projected => late,
        ReplanPolicy::EveryWaypoint => true,
    }
}

/// Whether the battery holds no more than surfacing from here takes, twice.
fn energy_is_low(view: View<'_>) -> bool {
    view.mission.battery.as_ref().is_some_and(|battery| {
        let vehicle = &view.mission.vehicle;
        let rise_m = view.beliefs().position.z.max(0.0);
        let way_m = rise_m / libm::sin(vehicle.max_pitch_rad).max(LEAST_SLOPE);
        let surfacing_j = battery.used_j(way_m / vehicle.speed_mps, way_m);
        battery.usable_j - view.state.ledger.used_j <= SURFACINGS * surfacing_j
    })
}

#[cfg(test)]
mod tests;
