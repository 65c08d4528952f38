//! One leg: its path, its watch, its task, its ledger entry.

use crate::synchroniser::{Phase, RouteFrom};
use crate::{AbortReason, Command, PathCall, PathRequest, RouteReason, Synchroniser, here, times};
use auv_graph::{EdgeId, NodeId};
use auv_obstacles::TimedPoint;
use auv_planning::motion::distance_to_regions_m;
use auv_planning::{PlanError, Planned, Trajectory};
use auv_types::{Bounds, Point3, Vector3};
use std::sync::Arc;

/// A leg being flown.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Leg {
    pub(crate) from: NodeId,
    pub(crate) to: NodeId,
    pub(crate) edge: Option<EdgeId>,
    pub(crate) started_s: f64,
    pub(crate) charged_s: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub(crate) expected_s: f64,
    /// Task time still to be spent at the target.
    pub(crate) task_left_s: f64,
    pub(crate) task_skipped: bool,
    /// When the trajectory in force begins to stay at the target (`None`: it only waits).
    pub(crate) stays_from_s: Option<f64>,
    pub(crate) waiting: bool,
    /// The trajectory in force ends near the target, not at it.
    pub(crate) approaching: bool,
    /// A route for an arrival later than expected was asked for.
    pub(crate) projected: bool,
    /// The path asked for is only to shorten a way that is good as it is.
    pub(crate) improving: bool,
    pub(crate) waited_s: f64,
    /// Up to when time is booked as task or waiting.
    pub(crate) booked_s: f64,
    pub(crate) asked_s: f64,
    pub(crate) departure: Departure,
    pub(crate) pending: Option<u64>,
    pub(crate) failures: u32,
    pub(crate) calls: u32,
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub(crate) violation: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub(crate) cost: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub(crate) compute_s: f64,
}

/// Where, how fast and when the path asked for departs, and where it ends if not at the target.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Departure {
    pub(crate) place: TimedPoint,
    pub(crate) velocity: Vector3<f64>,
    pub(crate) stand_off: Option<Point3<f64>>,
}

impl Synchroniser {
    /// Begins the next leg of the route in force.
    pub(crate) fn next_leg(&mut self, commands: &mut Vec<Command>) {
        // A route taken as claimed may lead nowhere.
        let &[from, to, ..] = self.state.route.as_slice() else {
            return self.abort(AbortReason::Unreachable, commands);
        };
        let arc = self.mission.network.arc_between(from, to);
        let edge = arc.map(|arc| self.mission.network.arcs()[arc.index()].edge);
        let already_done = edge.is_some_and(|edge| self.state.removed.contains(edge));
        let task_skipped = self.state.homeward || already_done || edge.is_none();
        let task_left_s = edge.filter(|_| !task_skipped).map_or(0.0, |edge| {
            self.mission.network.task(edge).completion_time_s
        });
        let travel_s = arc
            .and_then(|arc| times::travel_s(&self.mission, arc, self.state.now_s))
            .unwrap_or_else(|| self.straight_s(&self.mission.position_of(to)));
        self.home_s = here::home_times_s(&self.mission, self.state.now_s);
        self.state.leg = Some(Leg {
            from,
            to,
            edge,
            started_s: self.state.now_s,
            charged_s: 0.0,
            expected_s: self.expected_s(travel_s + self.settings.planning_s, task_left_s),
            task_left_s,
            task_skipped,
            stays_from_s: None,
            waiting: false,
            approaching: false,
            projected: false,
            improving: false,
            waited_s: 0.0,
            booked_s: self.state.now_s,
            asked_s: self.state.now_s,
            departure: self.departure(),
            pending: None,
            failures: 0,
            calls: 0,
            violation: 0.0,
            cost: 0.0,
            compute_s: 0.0,
        });
        self.state.phase = Phase::Flying;
        self.ask_path(commands);
    }

    pub(crate) fn record_leg(&mut self, leg: &Leg, completed: bool, replan: bool, next_leg: bool) {
        let row = PathCall {
            route_call: self.state.route_calls.len(),
            call: self.state.path_calls.len() + 1,
            from: leg.from,
            to: leg.to,
            at_s: leg.started_s,
            violation: leg.violation,
            cost: leg.cost,
            compute_s: leg.compute_s,
            leg_s: self.leg_s(leg),
            expected_s: leg.expected_s,
            available_s: self.available_s(),
            replan,
            next_leg,
            replanned_paths: leg.calls.saturating_sub(1),
            waited_s: leg.waited_s,
            completed,
        };
        self.state.path_calls.push(row);
    }

    /// Asks for a path from the vehicle's place to the leg's target or, while that is sure to be
    /// covered on arrival, to the place nearest to it where the vehicle can wait. A leg that was asked
    /// for too often is given up, but not the way to the dock.
    pub(crate) fn ask_path(&mut self, commands: &mut Vec<Command>) {
        let spent = |leg: &Leg| {
            leg.calls >= self.settings.max_path_calls && leg.to != self.mission.destination
        };
        if self.state.leg.as_ref().is_some_and(spent) {
            return self.drop_leg(commands);
        }
        let covered = self.target_will_be_covered();
        let stand_off = if covered { self.stand_off() } else { None };
        if covered && stand_off.is_none() {
            if let Some(leg) = &mut self.state.leg {
                leg.asked_s = self.state.now_s;
                leg.improving = false;
                leg.failures = leg.failures.saturating_add(1);
            }
            return self.path_failed(commands);
        }
        let (id, seed) = self.next_request();
        let departure = self.departure();
        let Some(leg) = &mut self.state.leg else {
            return;
        };
        leg.departure = Departure {
            stand_off,
            ..departure
        };
        leg.pending = Some(id);
        leg.asked_s = self.state.now_s;
        leg.calls = leg.calls.saturating_add(1);
        let request = self.path_request(id, seed);
        commands.push(Command::PlanPath(request));
    }

    /// The request as it is (or was) asked: it depends on the state alone.
    pub(crate) fn path_request(&self, id: u64, seed: auv_types::Seed) -> PathRequest {
        let leg = self.state.leg.as_ref();
        let leg_to = leg.map_or(self.mission.destination, |leg| leg.to);
        let Departure {
            place,
            velocity,
            stand_off,
        } = leg.map_or_else(|| self.departure(), |leg| leg.departure);
        let steers = self.mission.vehicle.turn_radius_m > 0.0 && velocity.norm() > 0.05;
        let (min_altitude_m, altitude_sigmas) = self.mission.altitude_to_ask(&place.position);
        PathRequest {
            id,
            mission: Arc::clone(&self.mission),
            bounds: self.bounds(),
            min_altitude_m: min_altitude_m.max(0.0),
            altitude_sigmas,
            start: place.position,
            start_velocity: steers.then_some(velocity),
            target: stand_off.unwrap_or_else(|| self.mission.position_of(leg_to)),
            departure_s: place.time_s,
            regions: self.state.regions.as_slice().into(),
            clearance_m: self.clearance_to_ask_m(place),
            warm_start: self.warm_start(place, stand_off).map(Arc::new),
            seed,
            budget: self.settings.path_budget,
        }
    }

    /// Where the vehicle is when the path is ready: here and now, or, when planning is given time,
    /// where the trajectory in force or else its velocity takes it until then.
    fn departure(&self) -> Departure {
        let (now_s, velocity) = (self.state.now_s, self.state.velocity);
        let ahead_s = self.settings.planning_s;
        let then_s = now_s + ahead_s;
        let followed = self
            .state
            .in_force
            .as_ref()
            .filter(|in_force| then_s < in_force.end().time_s && self.is_on_track());
        let (position, velocity) = match followed {
            Some(in_force) if ahead_s > 0.0 => in_force.at(then_s),
            _ => (self.state.position + velocity * ahead_s, velocity),
        };
        Departure {
            place: TimedPoint::new(position, then_s),
            velocity,
            stand_off: None,
        }
    }

    /// The mission's clearance and the hysteresis, or what is left of it where the vehicle is: a path
    /// cannot begin further from an obstacle than the vehicle is.
    pub(crate) fn clearance_to_ask_m(&self, here: TimedPoint) -> f64 {
        let wanted_m = self.mission.clearance_m + self.settings.hysteresis_m;
        let here_m = distance_to_regions_m(&here, &self.state.regions, wanted_m + 1.0) - 1.0;
        wanted_m.min(here_m.max(0.0))
    }

    /// The rest of the trajectory in force, or the arc's guide round the land.
    fn warm_start(&self, from: TimedPoint, stand_off: Option<Point3<f64>>) -> Option<Trajectory> {
        let leg = self.state.leg.as_ref()?;
        if let (Some(in_force), Some(stays_from_s)) = (&self.state.in_force, leg.stays_from_s) {
            let rest = in_force.until(stays_from_s).after(from.time_s);
            return (rest.points().len() > 1).then_some(rest);
        }
        let arc = self.mission.network.arc_between(leg.from, leg.to)?;
        let guide = self.mission.guides.get(&arc)?;
        let mut points: Vec<Point3<f64>> = vec![from.position];
        points.extend(guide[..guide.len().saturating_sub(1)].iter().skip(1));
        points.push(stand_off.unwrap_or_else(|| self.mission.position_of(leg.to)));
        self.bare_problem_request().problem().timed(&points).ok()
    }

    /// The mission's box, with the vehicle in it.
    fn bounds(&self) -> Option<Bounds> {
        let bounds = self.mission.bounds?;
        Some(bounds.grown_to(&self.state.position))
    }

    /// A path request without search data, for timing and checking the synchroniser's own ways.
    pub(crate) fn bare_problem_request(&self) -> PathRequest {
        let (min_altitude_m, altitude_sigmas) = self.mission.altitude_to_ask(&self.state.position);
        PathRequest {
            id: 0,
            mission: Arc::clone(&self.mission),
            bounds: self.bounds(),
            min_altitude_m,
            altitude_sigmas,
            start: self.state.position,
            start_velocity: None,
            target: self.state.position,
            departure_s: self.state.now_s,
            regions: self.state.regions.as_slice().into(),
            clearance_m: self.mission.clearance_m,
            warm_start: None,
            seed: self.seed,
            budget: self.settings.path_budget,
        }
    }

    pub(crate) fn on_path(
        &mut self,
        request: u64,
        result: Result<Planned<Trajectory>, PlanError>,
        compute_s: f64,
        commands: &mut Vec<Command>,
    ) {
        if self.state.leg.as_ref().and_then(|leg| leg.pending) != Some(request) {
            return;
        }
        let charge_s = self.charge(compute_s, false);
        let asked = self.path_request(request, self.seed.split(request));
        let verdict = match &result {
            Ok(planned) => self.accepted(&asked, planned),
            Err(_) => None,
        };
        let Some(leg) = &mut self.state.leg else {
            return;
        };
        leg.pending = None;
        leg.charged_s += charge_s;
        leg.compute_s += compute_s;
        if let (1, Ok(planned)) = (leg.calls, &result) {
            (leg.violation, leg.cost) = (planned.violation, planned.cost);
        }
        // An attempt to shorten the way: what is in force stays unless the new one arrives earlier.
        if std::mem::take(&mut leg.improving) {
            let arrives_s = leg.stays_from_s.unwrap_or(f64::INFINITY);
            if verdict
                .as_ref()
                .is_none_or(|(_, stays_from_s)| *stays_from_s > arrives_s - 1.0)
            {
                return;
            }
        }
        match verdict {
            Some((whole, stays_from_s)) => {
                leg.failures = 0;
                leg.waiting = false;
                leg.approaching = leg.departure.stand_off.is_some();
                leg.stays_from_s = Some(stays_from_s);
                self.follow(whole, commands);
            }
            None => self.path_failed(commands),
        }
    }

    /// Whether the vehicle is at the leg's target and its task done.
    pub(crate) fn has_arrived(&self) -> bool {
        let leg = self.state.leg.as_ref();
        let leads_there = leg.is_some_and(|leg| leg.stays_from_s.is_some() && !leg.approaching);
        leads_there && self.in_force_is_over() && self.is_on_track()
    }

    /// A tick in the middle of a leg.
    pub(crate) fn fly(&mut self, commands: &mut Vec<Command>) {
        let now_s = self.state.now_s;
        let over = self.in_force_is_over();
        let Some(leg) = &self.state.leg else { return };
        if self.state.in_force.is_none() {
            return;
        }
        if self.has_arrived() {
            return self.complete_leg(commands);
        }
        if leg.pending.is_some() {
            return self.keep_clear(commands);
        }
        self.account_time();
        if self.runs_short_of_time() {
            return self.drop_leg(commands);
        }
        let Some(leg) = &self.state.leg else { return };
        if leg.waiting {
            // A dock that is covered is waited for: the vehicle is beside it, not shut in.
            let waits_to_dock =
                || leg.to == self.mission.destination && self.target_will_be_covered();
            if self.shut_in_s() > self.settings.max_shut_in_s && !waits_to_dock() {
                return self.abort(AbortReason::ShutIn, commands);
            }
            if self.needs_energy_left_to_surface() {
                return self.abort(AbortReason::EnergySpent, commands);
            }
            if leg.waited_s > self.settings.max_wait_s && leg.to != self.mission.destination {
                return self.drop_leg(commands);
            }
            if over || now_s - leg.asked_s >= self.settings.retry_s {
                self.ask_path(commands);
            } else if !self.in_force_is_clear() {
                self.get_out_of_the_way(commands);
            }
        } else if over || !self.is_on_track() || !self.in_force_is_clear() {
            if over || now_s - leg.asked_s >= self.settings.react_s {
                self.ask_path(commands);
            } else {
                self.get_out_of_the_way(commands);
            }
        } else if self.is_projected_late(leg) {
            if let Some(leg) = &mut self.state.leg {
                leg.projected = true;
            }
            self.ask_route(RouteReason::Projected, RouteFrom::Target, commands);
        } else if leg.approaching {
            if now_s - leg.asked_s >= self.settings.retry_s && !self.target_will_be_covered() {
                self.ask_path(commands);
            }
        } else if now_s - leg.asked_s >= self.settings.improve_s
            && leg.calls < self.settings.max_path_calls
            && self.goes_a_long_way()
            && !self.target_will_be_covered()
        {
            if let Some(leg) = &mut self.state.leg {
                leg.improving = true;
            }
            self.ask_path(commands);
        }
    }

    /// Books the time since the last tick as waiting, or as work at the target where the vehicle is there.
    fn account_time(&mut self) {
        let (now_s, on_track) = (self.state.now_s, self.is_on_track());
        let Some(leg) = &mut self.state.leg else {
            return;
        };
        let waits_off = leg.approaching && leg.stays_from_s.is_some_and(|from_s| now_s > from_s);
        if leg.waiting || waits_off {
            leg.waited_s += now_s - leg.booked_s;
        } else if let Some(stays_from_s) = leg.stays_from_s.filter(|&s| on_track && now_s > s) {
            leg.task_left_s = (leg.task_left_s - (now_s - stays_from_s)).max(0.0);
            leg.stays_from_s = Some(now_s);
        }
        leg.booked_s = now_s;
    }

    /// Gives the leg up: its edge is taken out and a route from here is asked for.
    fn drop_leg(&mut self, commands: &mut Vec<Command>) {
        if let Some(leg) = self.state.leg.clone() {
            if let Some(edge) = leg.edge {
                self.state.removed.insert(edge);
            }
            self.record_leg(&leg, false, true, false);
        }
        self.ask_route(RouteReason::LegDropped, RouteFrom::Here, commands);
    }
}
