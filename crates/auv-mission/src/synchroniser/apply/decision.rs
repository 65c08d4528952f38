//! Applying decisions: what they change, and the commands they give.

use crate::decide::{AfterLeg, Decision};
use crate::mode::{Awaited, ContingencyState, Duty, Leg, LegMode, Mode, NextRoute};
use crate::path_question::{self, Accepted, Reach};
use crate::question::RouteFrom;
use crate::route_question::{self, JudgedRoute};
use crate::state::{InForce, RouteInForce};
use crate::trigger::{Payload, Trigger};
use crate::uncertainty::growth_m;
use crate::{
    AbortReason, Command, Navigation, Outcome, PathCall, RouteCall, RouteReason, RouteRequest,
    Synchroniser, agenda, climb_clear, due, ladder, leg_time, reflex, route_from_vehicle,
    surfacing, times,
};
use auv_graph::EdgeId;
use auv_types::Point3;
use std::sync::Arc;

/// How a leg ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LegEnd {
    Completed(AfterLeg),
    GivenUp,
}

impl Synchroniser {
    /// Carries out a decision; returns what is to be decided next because of it.
    pub(in crate::synchroniser) fn apply(
        &mut self,
        decision: Decision,
        payload: Payload,
        commands: &mut Vec<Command>,
    ) -> Option<Trigger> {
        self.close_question(&payload);
        match decision {
            Decision::Continue => {}
            Decision::Finish(outcome) => self.finish(outcome, commands),
            Decision::EndContingency => self.end_contingency(commands),
            Decision::AskRoute(reason) => self.ask_route(reason, RouteFrom::Waypoint, commands),
            Decision::AskNextRoute => self.ask_next_route(commands),
            Decision::AskRouteAgain => self.ask_route_again(payload, commands),
            Decision::AdoptRoute => return self.adopt_route(payload),
            Decision::AdoptNextRoute | Decision::KeepLeg => self.settle_next_route(payload),
            Decision::GoHome => return self.go_home(payload),
            Decision::CompleteLeg(after) => return self.complete_leg(after, commands),
            Decision::DropLeg => self.drop_leg(commands),
            Decision::WantPath => return Some(Trigger::PathWanted),
            Decision::AskPath => self.ask_path(payload, commands),
            Decision::AskShorterPath => self.ask_shorter_path(commands),
            Decision::Follow => self.follow_path(payload, commands),
            Decision::Hold => return self.hold(commands),
            Decision::Wait => self.set_leg_mode(LegMode::Evading),
            Decision::Evade => self.evade(commands),
            Decision::Climb => self.climb(commands),
            Decision::Surface => self.surface(commands),
            Decision::RenewWayOn => self.renew_way_on(commands),
            Decision::Abort(reason) => return self.abort(reason, commands),
            Decision::SeekAgain => return self.seek_manoeuvre(commands),
        }
        None
    }

    fn ask_route(&mut self, reason: RouteReason, from: RouteFrom, commands: &mut Vec<Command>) {
        let question = route_question::ask(self.view(), reason, from);
        self.take_number();
        let request = question.request(&self.known, self.tide.as_deref(), self.seed);
        commands.push(Command::PlanRoute(request));
        self.state.mode = Mode::AwaitRoute(Box::new(question));
    }

    fn ask_next_route(&mut self, commands: &mut Vec<Command>) {
        let (reason, from) = (RouteReason::Projected, RouteFrom::Target);
        let question = route_question::ask(self.view(), reason, from);
        self.take_number();
        let request = question.request(&self.known, self.tide.as_deref(), self.seed);
        commands.push(Command::PlanRoute(request));
        if let Mode::Leg(leg) = &mut self.state.mode {
            leg.next_route = NextRoute::Asked(Box::new(question));
        }
    }

    fn ask_route_again(&mut self, payload: Payload, commands: &mut Vec<Command>) {
        if let Payload::Route(judged) = payload {
            let JudgedRoute { question, row, .. } = *judged;
            self.state.ledger.route_calls.push(row);
            let from = route_question::from_here_again(self.view(), question.from);
            self.ask_route(question.reason, from, commands);
        }
    }

    fn adopt_route(&mut self, payload: Payload) -> Option<Trigger> {
        let Payload::Route(judged) = payload else {
            return None;
        };
        let JudgedRoute {
            asked,
            row,
            chosen,
            due,
            ..
        } = *judged;
        let route = RouteInForce::Planned(chosen?);
        self.start_route((route, due), &asked, row)
    }

    /// Leaves the leg and its tasks for the quickest way home; no planner is asked.
    fn go_home(&mut self, payload: Payload) -> Option<Trigger> {
        let (asked, row) = match payload {
            Payload::Route(judged) => (judged.asked, judged.row),
            Payload::None | Payload::Path(_) | Payload::Reach(_) => {
                let leg = self.view().leg()?.clone();
                self.record_leg(&leg, LegEnd::GivenUp);
                let from = route_question::from_vehicle(self.view(), &leg);
                let question = route_question::ask(self.view(), RouteReason::SonarLost, from);
                self.take_number();
                let asked = question.request(&self.known, self.tide.as_deref(), self.seed);
                let row = route_question::row(self.view(), &asked, question.reason, 0.0);
                (asked, row)
            }
        };
        match route_question::quickest_home(self.view(), &asked) {
            Some(nodes) => {
                let home = RouteInForce::QuickestHome(nodes);
                self.start_route((home, Vec::new()), &asked, row)
            }
            None => Some(Trigger::NoWayHome),
        }
    }

    fn start_route(
        &mut self,
        (route, due): (RouteInForce, Vec<usize>),
        asked: &RouteRequest,
        mut row: RouteCall,
    ) -> Option<Trigger> {
        let view = self.view();
        let how = (route.is_homeward(), view.under_way());
        route_question::complete_row(view, &mut row, asked, route.nodes(), how, &due);
        self.state.ledger.route_calls.push(row);
        self.state.route = route;
        self.state.due = due;
        self.start_leg()
    }

    /// Records the answer for the route after the leg; puts it in force if there is one.
    fn settle_next_route(&mut self, payload: Payload) {
        let (Payload::Route(judged), Mode::Leg(leg)) = (payload, &mut self.state.mode) else {
            return;
        };
        leg.next_route = NextRoute::Decided;
        let from = leg.from;
        let JudgedRoute {
            asked,
            mut row,
            chosen,
            due,
            ..
        } = *judged;
        if let Some(nodes) = chosen {
            let view = self.view();
            let how = (false, view.under_way_then());
            route_question::complete_row(view, &mut row, &asked, &nodes, how, &due);
            let doing = view.leg().map(|leg| due::due_of(view, leg));
            let nodes = std::iter::once(from).chain(nodes).collect();
            self.state.route = RouteInForce::Planned(nodes);
            self.state.due = doing.into_iter().flatten().chain(due).collect();
        }
        self.state.ledger.route_calls.push(row);
    }

    /// Starts the next leg of the route in force.
    fn start_leg(&mut self) -> Option<Trigger> {
        // A route that was not verified may lead nowhere.
        let &[from, to, ..] = self.state.route.nodes() else {
            return Some(Trigger::NoLeg);
        };
        let now_s = self.view().now_s();
        let network = &self.known.network;
        let arc = network.arc_between(from, to);
        let duty = self.duty(arc.map(|arc| network.arcs()[arc.index()].edge));
        let mut task_left_s = match duty {
            Duty::Task(edge) => network.task(edge).completion_time_s,
            Duty::NoEdge | Duty::Pass(_) => 0.0,
        };
        let tide = self.tide.as_deref();
        let departs_s = tide
            .zip(arc)
            .map_or(now_s, |(tide, arc)| tide.leaves_s(arc, now_s));
        let along = arc.map(|arc| times::leg(&self.known, arc, departs_s, self.view().under_way()));
        let straight = || self.view().leg_to(self.known.position_of(to), task_left_s);
        let leg = along.and_then(Result::ok).unwrap_or_else(straight);
        let planned_s = leg.under_way_s() + self.settings.planning.planning_s;
        let mut stay_s = if task_left_s > 0.0 { leg.stay_s } else { 0.0 };
        let due = agenda::due_at(&self.known, &self.state.due, to, duty.edge());
        if !due.is_empty() {
            task_left_s = due::stay(self.view(), &due, departs_s + planned_s).0;
            stay_s = task_left_s;
        }
        let expected_s = leg_time::expected_s(self.view(), planned_s, stay_s) + (departs_s - now_s);
        self.home_s = route_from_vehicle::home_times_s(&self.known, now_s);
        self.state.mode = Mode::Leg(Box::new(Leg {
            from,
            to,
            duty,
            mode: LegMode::AwaitFirstPath,
            awaited: Awaited::Nothing,
            next_route: NextRoute::AtTarget,
            started_s: now_s,
            departs_s,
            expected_s,
            charged_s: 0.0,
            task_left_s,
            works: Vec::new(),
            worked: false,
            waited_s: 0.0,
            booked_s: now_s,
            asked_s: now_s,
            fixes: 0,
            fix_asked_s: now_s,
            dock_contact: None,
            misses: 0,
            missed_s: 0.0,
            astray: None,
            failures: 0,
            calls: 0,
            violation: 0.0,
            cost: 0.0,
            compute_s: 0.0,
        }));
        Some(Trigger::PathWanted)
    }

    /// What is done along an edge.
    fn duty(&self, edge: Option<EdgeId>) -> Duty {
        match edge {
            None => Duty::NoEdge,
            Some(edge) if self.state.route.is_homeward() => Duty::Pass(edge),
            Some(edge) if self.state.ledger.removed.contains(edge) => Duty::Pass(edge),
            Some(edge) => Duty::Task(edge),
        }
    }

    /// The leg's target is reached and its task done.
    fn complete_leg(&mut self, after: AfterLeg, commands: &mut Vec<Command>) -> Option<Trigger> {
        let leg = self.view().leg()?.clone();
        let raised_m = self.view().raised_m(leg.to);
        let ledger = &mut self.state.ledger;
        if raised_m > 0.0 {
            ledger.raised.push((leg.to, raised_m));
        }
        ledger.visited.push(leg.to);
        match leg.duty {
            Duty::NoEdge => {}
            Duty::Pass(edge) => {
                ledger.removed.insert(edge);
            }
            Duty::Task(edge) => ledger.book_task(&self.known, edge),
        }
        for &done in &leg.works {
            self.state.ledger.book_timed(&self.known, done);
        }
        let due = due::due_of(self.view(), &leg).len();
        self.state.due.drain(..due);
        self.record_leg(&leg, LegEnd::Completed(after));
        let rest = self.state.route.nodes().iter().skip(1).copied().collect();
        self.state.route = self.state.route.with_nodes(rest);
        match after {
            AfterLeg::Finish(outcome) => self.finish(outcome, commands),
            AfterLeg::AskRoute(reason) => self.ask_route(reason, RouteFrom::Waypoint, commands),
            AfterLeg::NextLeg => return self.start_leg(),
        }
        None
    }

    /// The leg is given up: its edge is taken out and a route from here asked for.
    fn drop_leg(&mut self, commands: &mut Vec<Command>) {
        let Some(leg) = self.view().leg().cloned() else {
            return;
        };
        if let Some(edge) = leg.duty.edge() {
            self.state.ledger.removed.insert(edge);
        }
        self.record_leg(&leg, LegEnd::GivenUp);
        let from = route_question::from_vehicle(self.view(), &leg);
        self.ask_route(RouteReason::LegDropped, from, commands);
    }

    fn record_leg(&mut self, leg: &Leg, end: LegEnd) {
        let ledger = &self.state.ledger;
        let row = PathCall {
            route_call: ledger.route_calls.len(),
            call: ledger.path_calls.len() + 1,
            from: leg.from,
            to: leg.to,
            at_s: leg.started_s,
            violation: leg.violation,
            cost: leg.cost,
            compute_s: leg.compute_s,
            leg_s: leg_time::leg_s(self.view(), leg),
            expected_s: leg.expected_s,
            available_s: self.available_s(),
            replan: matches!(
                end,
                LegEnd::GivenUp | LegEnd::Completed(AfterLeg::AskRoute(_))
            ),
            next_leg: end == LegEnd::Completed(AfterLeg::NextLeg),
            replanned_paths: leg.calls.saturating_sub(1),
            waited_s: leg.waited_s,
            completed: end != LegEnd::GivenUp,
        };
        self.state.ledger.path_calls.push(row);
    }

    fn ask_path(&mut self, payload: Payload, commands: &mut Vec<Command>) {
        let stand_off = match payload {
            Payload::Reach(Reach::StandOff(place)) => Some(place),
            _ => None,
        };
        self.put_path_question(stand_off, Awaited::Path, commands);
    }

    fn ask_shorter_path(&mut self, commands: &mut Vec<Command>) {
        self.put_path_question(None, Awaited::ShorterPath, commands);
    }

    fn put_path_question(
        &mut self,
        stand_off: Option<Point3<f64>>,
        awaits: fn(crate::question::PathQuestion) -> Awaited,
        commands: &mut Vec<Command>,
    ) {
        self.look_around();
        let Some(leg) = self.view().leg() else { return };
        let question = path_question::ask(self.view(), leg, stand_off);
        self.take_number();
        let request = question.request(&self.known, self.seed);
        commands.push(Command::PlanPath(request));
        let now_s = self.view().now_s();
        if let Mode::Leg(leg) = &mut self.state.mode {
            leg.awaited = awaits(question);
            leg.asked_s = now_s;
            leg.calls = leg.calls.saturating_add(1);
        }
    }

    /// The next path is planned over a bed as shallow as it may be anywhere that the vehicle may then be.
    fn look_around(&mut self) {
        let view = self.view();
        let now_m = Navigation::SIGMAS * view.beliefs().sigma_m;
        let target = view.leg().map(|leg| view.mission.position_of(leg.to));
        let within_m = target.map_or(now_m, |target| now_m + growth_m(view, &target));
        if self.state.soundings.look_within(within_m) {
            self.known = self.state.soundings.over(&self.mission);
        }
    }

    fn follow_path(&mut self, payload: Payload, commands: &mut Vec<Command>) {
        let Payload::Path(Some(accepted)) = payload else {
            return;
        };
        let Accepted {
            in_force,
            arrives_s,
            stand_off,
        } = *accepted;
        let work = self.view().leg().filter(|leg| {
            let at_work = matches!(leg.mode, LegMode::AtTarget { .. });
            let begun = at_work || due::resumes(self.view(), leg);
            stand_off.is_none() && !begun && self.known.time_model.is_some()
        });
        let work = work.map(|leg| {
            let due = due::due_of(self.view(), leg);
            due::stay(self.view(), &due, arrives_s)
        });
        if let Mode::Leg(leg) = &mut self.state.mode {
            leg.failures = 0;
            if let Some(work) = work {
                (leg.task_left_s, leg.works) = work;
            }
        }
        self.set_leg_mode(match stand_off {
            Some(_) => LegMode::ToStandOff { arrives_s },
            None => LegMode::Underway { arrives_s },
        });
        self.follow(in_force, commands);
    }

    /// Stays until the current lets the vehicle pass.
    fn hold(&mut self, commands: &mut Vec<Command>) -> Option<Trigger> {
        let departs_s = self.view().leg()?.departs_s;
        if let Some(in_force) = path_question::stay_until(self.view(), departs_s) {
            self.set_leg_mode(LegMode::Holding);
            self.follow(in_force, commands);
            return None;
        }
        if let Mode::Leg(leg) = &mut self.state.mode {
            leg.departs_s = leg.started_s;
        }
        Some(Trigger::PathWanted)
    }

    /// Puts a trajectory in force, preceded by what is flown until it starts.
    fn follow(&mut self, in_force: InForce, commands: &mut Vec<Command>) {
        let InForce { whole, ends_s } = in_force;
        let whole = match path_question::lead_to(self.view(), whole.start()) {
            Some(lead) => lead.then(&whole).unwrap_or(whole),
            None => whole,
        };
        commands.push(Command::Follow(Arc::new(whole.clone())));
        self.state.in_force = Some(InForce { whole, ends_s });
    }

    /// Takes another way on from the end of the trajectory in force, if there is a clear one.
    fn renew_way_on(&mut self, commands: &mut Vec<Command>) {
        if let Some(in_force) = path_question::with_other_way_on(self.view()) {
            self.follow(in_force, commands);
        }
    }

    /// Evades to the nearest place to wait. Where every evasion leads below the bed's least altitude, out of
    /// the box or into what is charted, the vehicle goes on as it does, if that leads less deep; so it does
    /// where it evades already and no evasion is clearly better.
    fn evade(&mut self, commands: &mut Vec<Command>) {
        let evasion = reflex::evasion(self.view());
        self.set_leg_mode(LegMode::Evading);
        if let Some(in_force) = evasion {
            self.follow(in_force, commands);
        }
    }

    /// Climbs clear of the bed as measured; evades where no climb is free. A climb that is renewed counts once.
    fn climb(&mut self, commands: &mut Vec<Command>) {
        let Some(in_force) = climb_clear::climb(self.view()) else {
            return self.evade(commands);
        };
        let climbs = self
            .view()
            .leg()
            .is_some_and(|leg| leg.mode == LegMode::Climbing);
        let ledger = &mut self.state.ledger;
        ledger.climbs = ledger.climbs.saturating_add(u32::from(!climbs));
        self.set_leg_mode(LegMode::Climbing);
        self.follow(in_force, commands);
    }

    /// Surfaces for a fix; where that is not clear, goes on as it does and waits at the end.
    fn surface(&mut self, commands: &mut Vec<Command>) {
        let found = surfacing::surface_for_fix(self.view());
        let (now_s, flown) = (self.view().now_s(), self.view().is_over());
        let view = self.view();
        let missed = view
            .leg()
            .is_some_and(|leg| surfacing::misses_dock(view, leg));
        if let Mode::Leg(leg) = &mut self.state.mode {
            if missed {
                leg.misses = leg.misses.saturating_add(1);
                leg.missed_s = now_s;
            }
            leg.fixes = leg.fixes.saturating_add(1);
            leg.fix_asked_s = now_s;
        }
        match found {
            Some(in_force) => {
                self.set_leg_mode(LegMode::Surfacing);
                self.follow(in_force, commands);
            }
            None if flown => self.evade(commands),
            None => {}
        }
    }

    /// The path question that was answered is closed. An attempt that gave no path that leads on is
    /// counted: a refused answer, or a wanted path that can lead nowhere.
    fn close_question(&mut self, payload: &Payload) {
        let now_s = self.view().now_s();
        let Mode::Leg(leg) = &mut self.state.mode else {
            return;
        };
        let failed = match payload {
            Payload::Path(accepted) => {
                let asked = std::mem::replace(&mut leg.awaited, Awaited::Nothing);
                accepted.is_none() && matches!(asked, Awaited::Path(_))
            }
            Payload::Reach(Reach::Nowhere) => {
                leg.asked_s = now_s;
                true
            }
            Payload::None | Payload::Reach(_) | Payload::Route(_) => false,
        };
        leg.failures = leg.failures.saturating_add(u32::from(failed));
    }

    fn set_leg_mode(&mut self, mode: LegMode) {
        if let Mode::Leg(leg) = &mut self.state.mode {
            leg.mode = mode;
        }
    }

    /// Aborts the mission: the first contingency that can be flown is.
    fn abort(&mut self, reason: AbortReason, commands: &mut Vec<Command>) -> Option<Trigger> {
        self.state.mode = Mode::Contingency(ContingencyState {
            reason,
            flown: None,
            sought: 0,
        });
        self.fly_manoeuvre(0, commands)
    }

    fn seek_manoeuvre(&mut self, commands: &mut Vec<Command>) -> Option<Trigger> {
        self.fly_manoeuvre(1, commands)
    }

    fn fly_manoeuvre(&mut self, sought: u32, commands: &mut Vec<Command>) -> Option<Trigger> {
        let Some((flown, way)) = ladder::seek(self.view()) else {
            return Some(Trigger::NoManoeuvre);
        };
        if let Mode::Contingency(state) = &mut self.state.mode {
            state.flown = flown;
            state.sought = state.sought.saturating_add(sought);
        }
        self.follow(way, commands);
        None
    }

    fn end_contingency(&mut self, commands: &mut Vec<Command>) {
        if let Mode::Contingency(state) = self.state.mode {
            self.finish(Outcome::Aborted(state.reason), commands);
        }
    }

    fn finish(&mut self, outcome: Outcome, commands: &mut Vec<Command>) {
        let contingency = self.contingency();
        self.state.mode = Mode::Finished {
            outcome,
            contingency,
        };
        commands.push(Command::Finished(outcome));
    }

    /// Moves on to the number of the next question.
    fn take_number(&mut self) {
        self.state.next_question = self.state.next_question.saturating_add(1);
    }
}

#[cfg(test)]
mod tests;
