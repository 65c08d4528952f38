//! Applying events: beliefs, energy, time and charges are booked, answers of planners are judged.

use crate::Synchroniser;
use crate::beliefs::Altimeter;
use crate::ledger::Ledger;
use crate::mode::{Awaited, Leg, LegMode, Mode, NextRoute};
use crate::path_question;
use crate::question::{PathQuestion, RouteQuestion};
use crate::trigger::{Payload, Trigger};
use crate::{
    AbortReason, ComputeCharge, Event, Observation, astray, check, route_question, senses,
};
use auv_graph::Route;
use auv_planning::{PlanError, Planned, Trajectory};

impl Synchroniser {
    /// Takes in an event; returns what it means for the mission, if anything is to be decided.
    pub(in crate::synchroniser) fn apply_event(
        &mut self,
        event: Event,
    ) -> Option<(Trigger, Payload)> {
        match event {
            Event::Tick(observation) => {
                let trigger = self.take_observation(&observation);
                Some((trigger, Payload::None))
            }
            Event::BatteryMeasured { left_j } => {
                let battery = self.known.battery?;
                let used_j = battery.usable_j - left_j;
                if used_j.is_finite() {
                    self.state.ledger.used_j = used_j;
                }
                None
            }
            Event::SonarSilent { age_s } => {
                let tolerated = age_s <= self.settings.watchdogs.sonar_silence_s;
                (!tolerated).then_some((Trigger::SonarLost, Payload::None))
            }
            Event::AltitudeMeasured { altitude_m } => {
                if altitude_m.is_nan() || altitude_m < 0.0 {
                    return None;
                }
                self.state.beliefs.altimeter = Altimeter::Fresh(altitude_m);
                let near = altitude_m < 0.5 * self.known.min_altitude_m;
                near.then_some((Trigger::BedTooNear, Payload::None))
            }
            Event::DockContact { docked } => {
                if let Mode::Leg(leg) = &mut self.state.mode {
                    leg.dock_contact = Some(docked);
                }
                None
            }
            Event::CannotFollow => Some((Trigger::CannotFollow, Payload::None)),
            Event::Leak => Some((Trigger::Leak, Payload::None)),
            Event::RoutePlanned {
                request,
                result,
                compute_s,
            } => {
                let (result, compute_s) = check::in_numbers(result, compute_s);
                self.take_route_answer(request, result, compute_s)
            }
            Event::PathPlanned {
                request,
                result,
                compute_s,
            } => {
                let (result, compute_s) = check::in_numbers(result, compute_s);
                self.take_path_answer(request, &result, compute_s)
            }
        }
    }

    fn take_observation(&mut self, observation: &Observation) -> Trigger {
        let starts = self.state.mode == Mode::Ready;
        let before = self.view().here();
        let altimeter = self.state.beliefs.altimeter;
        self.state.beliefs = match senses::beliefs_after(self.view(), observation) {
            Ok(beliefs) => beliefs,
            Err(AbortReason::BadClock) => return Trigger::ClockLost,
            Err(_) => return Trigger::PositionLost,
        };
        let here = self.view().here();
        if starts {
            self.state.ledger.started_s = here.time_s;
        } else {
            self.state.ledger.book_energy(&self.known, before, here);
        }
        self.book_leg_time();
        let astray = self.view().leg().map(|leg| astray::after(self.view(), leg));
        if let (Some(astray), Mode::Leg(leg)) = (astray, &mut self.state.mode) {
            leg.astray = astray;
        }
        if let Altimeter::Fresh(altitude_m) = altimeter {
            self.take_sounding(altitude_m);
        }
        Trigger::Tick
    }

    /// Takes in an altitude where the vehicle is now: the bed is as measured from now on. Without a fix it has
    /// no place.
    fn take_sounding(&mut self, altitude_m: f64) {
        let beliefs = &self.state.beliefs;
        let off_track_m = self.settings.margins.off_track_m;
        if beliefs.fixed_s < beliefs.now_s {
            return;
        }
        let place = beliefs.position;
        let soundings = &mut self.state.soundings;
        if soundings.take(&self.mission, off_track_m, &place, altitude_m) {
            self.known = soundings.over(&self.mission);
        }
    }

    /// Books the time since the last booking as waiting, or as work where the vehicle is at the
    /// target. While an answer is awaited nothing is booked: the answer may change what the time was
    /// spent on.
    fn book_leg_time(&mut self) {
        let (now_s, on_track) = (self.view().now_s(), self.view().is_on_track());
        let Mode::Leg(leg) = &mut self.state.mode else {
            return;
        };
        let awaits = leg.awaited != Awaited::Nothing;
        if awaits || matches!(leg.next_route, NextRoute::Asked(_)) {
            return;
        }
        match leg.mode {
            LegMode::AwaitFirstPath | LegMode::Holding | LegMode::Surfacing => {}
            LegMode::Evading | LegMode::Climbing => leg.waited_s += now_s - leg.booked_s,
            LegMode::ToStandOff { arrives_s: since_s } | LegMode::AtStandOff { since_s } => {
                if now_s > since_s {
                    leg.waited_s += now_s - leg.booked_s;
                    leg.mode = LegMode::AtStandOff { since_s };
                }
            }
            LegMode::Underway {
                arrives_s: booked_s,
            }
            | LegMode::AtTarget { booked_s } => {
                if on_track && now_s > booked_s {
                    leg.task_left_s = (leg.task_left_s - (now_s - booked_s)).max(0.0);
                    leg.mode = LegMode::AtTarget { booked_s: now_s };
                    leg.worked |= leg.works.first().is_some_and(|work| work.start_s < now_s);
                }
            }
        }
        leg.booked_s = now_s;
    }

    fn take_route_answer(
        &mut self,
        id: u64,
        result: Result<Planned<Route>, PlanError>,
        compute_s: f64,
    ) -> Option<(Trigger, Payload)> {
        let question = open_route_question(&self.state.mode).filter(|open| open.id == id)?;
        let question = question.clone();
        let charge_s = match self.settings.planning.compute {
            ComputeCharge::None => 0.0,
            ComputeCharge::Fixed { route_s, .. } => route_s,
            ComputeCharge::Measured => compute_s.max(0.0),
        };
        self.state.ledger.charge(charge_s);
        let judged = route_question::judge(self.view(), question, result, compute_s);
        Some((Trigger::RouteAnswered, Payload::Route(Box::new(judged))))
    }

    fn take_path_answer(
        &mut self,
        id: u64,
        result: &Result<Planned<Trajectory>, PlanError>,
        compute_s: f64,
    ) -> Option<(Trigger, Payload)> {
        let view = self.view();
        let leg = view.leg()?;
        let question = leg.awaited.question().filter(|open| open.id == id)?;
        let accepted = self.judge_path(leg, question, result.as_ref().ok());
        let charge_s = match self.settings.planning.compute {
            ComputeCharge::None => 0.0,
            ComputeCharge::Fixed { path_s, .. } => path_s,
            ComputeCharge::Measured => compute_s.max(0.0),
        };
        self.state.ledger.charge(charge_s);
        let Mode::Leg(leg) = &mut self.state.mode else {
            return None;
        };
        leg.charged_s = (leg.charged_s + charge_s).min(Ledger::MOST_CHARGED_S);
        leg.compute_s += compute_s;
        if let (1, Ok(planned)) = (leg.calls, result) {
            (leg.violation, leg.cost) = (planned.violation, planned.cost);
        }
        Some((Trigger::PathAnswered, Payload::Path(accepted.map(Box::new))))
    }

    fn judge_path(
        &self,
        leg: &Leg,
        question: &PathQuestion,
        planned: Option<&Planned<Trajectory>>,
    ) -> Option<path_question::Accepted> {
        path_question::judge(self.view(), leg, question, planned?)
    }
}

fn open_route_question(mode: &Mode) -> Option<&RouteQuestion> {
    match mode {
        Mode::AwaitRoute(question) => Some(question),
        Mode::Leg(leg) => match &leg.next_route {
            NextRoute::Asked(question) => Some(question),
            NextRoute::AtTarget | NextRoute::Decided => None,
        },
        Mode::Ready | Mode::Contingency(_) | Mode::Finished { .. } => None,
    }
}

#[cfg(test)]
mod tests;
