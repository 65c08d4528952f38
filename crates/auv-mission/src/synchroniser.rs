//! The synchroniser: a state machine that flies a mission leg by leg (Fig. 3 and 4).

use crate::contingency::{Contingency, Fall};
use crate::drift::Drift;
use crate::leg::Leg;
use crate::{
    AbortReason, Command, ComputeCharge, Event, Mission, Observation, Outcome, PathCall,
    ReplanPolicy, RouteCall, RouteReason, SyncSettings, check, here,
};
use auv_graph::{EdgeSet, NodeId};
use auv_obstacles::Region;
use auv_planning::Trajectory;
use auv_types::{Point3, Seed, Vector3, Violations};
use std::sync::Arc;

/// Flies a mission: `(state, event) -> (state, commands)`. It never blocks, reads no clock and calls
/// no planner; whoever drives it does (see [`crate::driver`]).
///
/// # Determinism
/// Equal mission, settings, seed and events give equal commands.
#[derive(Clone, Debug)]
pub struct Synchroniser {
    pub(crate) mission: Arc<Mission>,
    pub(crate) settings: SyncSettings,
    pub(crate) seed: Seed,
    pub(crate) home_s: Vec<f64>,
    pub(crate) state: State,
}

/// What the synchroniser is doing.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Phase {
    /// Waiting for the first tick.
    Ready,
    /// Waiting for a route.
    Routing {
        request: u64,
        reason: RouteReason,
        from: RouteFrom,
    },
    /// Flying a leg, or waiting for its first path.
    Flying,
    /// The mission is given up; a contingency is flown.
    Falling(Fall),
    /// Over.
    Finished(Outcome),
}

/// Where a route asked for begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum RouteFrom {
    /// At the last waypoint reached.
    Waypoint,
    /// At the vehicle's own place.
    Here,
    /// At the target of the leg being flown, when it is reached.
    Target,
}

/// Everything that changes: plain data.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    pub(crate) phase: Phase,
    pub(crate) started_s: f64,
    pub(crate) now_s: f64,
    /// Time of the last fix that was believed.
    pub(crate) fixed_s: f64,
    /// Time of the last measured altitude, once there is one.
    pub(crate) altitude_s: Option<f64>,
    /// Whether one was told since the last tick.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) altitude_told: bool,
    /// Ticks in a row at which the clock stood still.
    pub(crate) stalled: u32,
    pub(crate) position: Point3<f64>,
    pub(crate) velocity: Vector3<f64>,
    pub(crate) regions: Vec<Region>,
    pub(crate) drift: Drift,
    /// The last waypoint reached.
    pub(crate) at: NodeId,
    /// The rest of the route in force; its first node is where the next leg begins.
    pub(crate) route: Vec<NodeId>,
    pub(crate) removed: EdgeSet,
    pub(crate) visited: Vec<NodeId>,
    pub(crate) weight: f64,
    pub(crate) tasks: usize,
    pub(crate) charged_s: f64,
    pub(crate) used_j: f64,
    /// On the quickest way home, leaving tasks undone.
    pub(crate) homeward: bool,
    pub(crate) next_request: u64,
    pub(crate) leg: Option<Leg>,
    pub(crate) in_force: Option<Trajectory>,
    pub(crate) contingency: Option<Contingency>,
    pub(crate) route_calls: Vec<RouteCall>,
    pub(crate) path_calls: Vec<PathCall>,
}

impl Synchroniser {
    /// A synchroniser for one mission.
    ///
    /// # Errors
    /// Everything that keeps the mission from starting.
    pub fn new(
        mission: Arc<Mission>,
        settings: SyncSettings,
        seed: Seed,
    ) -> Result<Self, Violations> {
        let mut violations = mission.validate();
        violations.absorb("settings.", settings.validate());
        violations.into_result()?;
        let state = State {
            phase: Phase::Ready,
            started_s: 0.0,
            now_s: 0.0,
            fixed_s: 0.0,
            altitude_s: None,
            altitude_told: false,
            stalled: 0,
            position: mission.position_of(mission.start),
            velocity: Vector3::zeros(),
            regions: Vec::new(),
            drift: Drift::default(),
            at: mission.start,
            route: Vec::new(),
            removed: EdgeSet::empty(),
            visited: vec![mission.start],
            weight: 0.0,
            tasks: 0,
            charged_s: 0.0,
            used_j: 0.0,
            homeward: false,
            next_request: 0,
            leg: None,
            in_force: None,
            contingency: None,
            route_calls: Vec::new(),
            path_calls: Vec::new(),
        };
        let home_s = here::home_times_s(&mission, mission.launch_s);
        Ok(Self {
            mission,
            settings,
            seed,
            home_s,
            state,
        })
    }

    /// Takes in an event; returns what is to be done, in order.
    ///
    /// Answers to requests that are no longer waited for are ignored. After the end nothing is done.
    pub fn step(&mut self, event: Event) -> Vec<Command> {
        let mut commands = Vec::new();
        match event {
            _ if self.outcome().is_some() => {}
            Event::Tick(observation) => self.on_tick(&observation, &mut commands),
            Event::BatteryMeasured { left_j } => {
                let used_j = self
                    .mission
                    .battery
                    .map(|battery| battery.usable_j - left_j);
                if let Some(used_j) = used_j.filter(|used_j| used_j.is_finite()) {
                    self.state.used_j = used_j;
                }
            }
            Event::SonarSilent { age_s } => self.on_sonar_silent(age_s, &mut commands),
            Event::AltitudeMeasured { altitude_m } => self.on_altitude(altitude_m, &mut commands),
            Event::RoutePlanned {
                request,
                result,
                compute_s,
            } => {
                let (result, compute_s) = check::in_numbers(result, compute_s);
                self.on_route(request, result, compute_s, &mut commands);
            }
            Event::PathPlanned {
                request,
                result,
                compute_s,
            } => {
                let (result, compute_s) = check::in_numbers(result, compute_s);
                self.on_path(request, result, compute_s, &mut commands);
            }
        }
        commands
    }

    /// How the mission ended, once it has.
    #[must_use]
    pub fn outcome(&self) -> Option<Outcome> {
        match self.state.phase {
            Phase::Finished(outcome) => Some(outcome),
            _ => None,
        }
    }

    /// Mission time left of the budget in seconds, charged computing taken off, or how long the
    /// battery lasts if that is less; negative when late.
    #[must_use]
    pub fn available_s(&self) -> f64 {
        let spent_s = self.state.now_s - self.state.started_s;
        let left_s = self.mission.budget_s - spent_s - self.state.charged_s;
        self.mission.available_s(left_s, self.state.used_j)
    }

    /// The waypoints reached, in order, the start included.
    #[must_use]
    pub fn visited(&self) -> &[NodeId] {
        &self.state.visited
    }

    /// Weight of the tasks done.
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.state.weight
    }

    /// Number of tasks done; a transit is none.
    #[must_use]
    pub fn tasks(&self) -> usize {
        self.state.tasks
    }

    /// The rest of the route in force, from the last waypoint (or the vehicle's place) on.
    #[must_use]
    pub fn route(&self) -> &[NodeId] {
        &self.state.route
    }

    /// The trajectory in force.
    #[must_use]
    pub fn trajectory(&self) -> Option<&Trajectory> {
        self.state.in_force.as_ref()
    }

    /// The table of route calls so far.
    #[must_use]
    pub fn route_calls(&self) -> &[RouteCall] {
        &self.state.route_calls
    }

    /// The table of legs so far.
    #[must_use]
    pub fn path_calls(&self) -> &[PathCall] {
        &self.state.path_calls
    }

    /// The contingency flown after the mission was given up, if it came to that.
    #[must_use]
    pub fn contingency(&self) -> Option<Contingency> {
        self.state.contingency
    }

    /// The mission.
    #[must_use]
    pub fn mission(&self) -> &Arc<Mission> {
        &self.mission
    }

    /// When the next tick is due at the latest: the end of the trajectory in force.
    #[must_use]
    pub fn due_s(&self) -> f64 {
        self.state
            .in_force
            .as_ref()
            .map_or(self.state.now_s, |t| t.end().time_s)
    }

    /// The question to a planner that is still to be answered, if there is one.
    #[must_use]
    pub fn outstanding(&self) -> Option<Command> {
        match self.state.phase {
            Phase::Routing { request, from, .. } => Some(Command::PlanRoute(self.request_with(
                request,
                self.seed.split(request),
                from,
            ))),
            Phase::Flying => {
                let id = self.state.leg.as_ref()?.pending?;
                Some(Command::PlanPath(
                    self.path_request(id, self.seed.split(id)),
                ))
            }
            Phase::Ready | Phase::Falling(_) | Phase::Finished(_) => None,
        }
    }

    fn on_tick(&mut self, observation: &Observation, commands: &mut Vec<Command>) {
        let starting = self.state.phase == Phase::Ready;
        let believed = self.believed_time_s(observation.time_s).and_then(|time_s| {
            let (position, velocity) = self.believed_place(observation, time_s)?;
            Ok((time_s, position, velocity))
        });
        let (time_s, position, velocity) = match believed {
            Ok(believed) => believed,
            Err(outcome) => return self.finish(outcome, commands),
        };
        if !starting {
            self.drain_battery(time_s, position);
        }
        self.date_altitude(time_s);
        self.observe_drift(time_s, &position);
        self.state.now_s = time_s;
        self.state.position = position;
        self.state.velocity = velocity;
        self.take_regions(&observation.regions);
        if starting {
            self.state.started_s = time_s;
            if self.mission.start == self.mission.destination {
                return self.finish(Outcome::Docked, commands);
            }
            return self.ask_route(RouteReason::Start, RouteFrom::Waypoint, commands);
        }
        let spent_s = self.state.now_s - self.state.started_s;
        let timed_out = spent_s > self.settings.timeout_factor * self.mission.budget_s;
        match self.state.phase {
            Phase::Falling(fall) => self.keep_falling(fall, commands),
            _ if timed_out => self.abort(AbortReason::TimedOut, commands),
            _ if self.misses_altitude() => self.abort(AbortReason::NoAltitude, commands),
            Phase::Flying => self.fly(commands),
            Phase::Routing {
                from: RouteFrom::Target,
                ..
            } if self.has_arrived() => self.complete_leg(commands),
            Phase::Routing { .. } => self.keep_clear(commands),
            Phase::Ready | Phase::Finished(_) => {}
        }
    }

    /// Books the energy used since the last tick: the way through the water, as the current is
    /// forecast.
    fn drain_battery(&mut self, now_s: f64, position: Point3<f64>) {
        let Some(battery) = &self.mission.battery else {
            return;
        };
        let time_s = now_s - self.state.now_s;
        let mut way = position - self.state.position;
        if let Some(current) = &self.mission.current {
            way -= current.velocity_at(&self.state.position, self.state.now_s) * time_s;
        }
        self.state.used_j += battery.used_j(time_s, way.norm());
    }

    /// The leg's waypoint is reached and its task done: ledger, passed edge, replan rule.
    pub(crate) fn complete_leg(&mut self, commands: &mut Vec<Command>) {
        let Some(leg) = self.state.leg.take() else {
            return;
        };
        self.state.at = leg.to;
        self.state.visited.push(leg.to);
        if let Some(edge) = leg.edge {
            if leg.task_skipped {
                self.state.removed.insert(edge);
            } else {
                for done in self.mission.done_with(edge) {
                    self.state.removed.insert(done);
                }
                let task = self.mission.network.task(edge);
                self.state.weight += task.weight();
                self.state.tasks += usize::from(task.weight() > 0.0);
            }
        }
        let late = self.is_late(&leg);
        let at_dock = leg.to == self.mission.destination;
        let replan = !at_dock && !self.state.homeward && self.wants_route(late);
        self.record_leg(&leg, true, replan, !replan && !at_dock);
        self.state.route.remove(0);
        if at_dock {
            let outcome = if self.available_s() >= 0.0 {
                Outcome::Docked
            } else {
                Outcome::Late
            };
            self.finish(outcome, commands);
        } else if replan {
            self.ask_route(
                if late {
                    RouteReason::Late
                } else {
                    RouteReason::Waypoint
                },
                RouteFrom::Waypoint,
                commands,
            );
        } else {
            self.next_leg(commands);
        }
    }

    fn wants_route(&self, late: bool) -> bool {
        match self.settings.replan {
            ReplanPolicy::Late | ReplanPolicy::Projected => late,
            ReplanPolicy::EveryWaypoint => true,
        }
    }

    /// Charges computing time to the mission; returns what was charged.
    pub(crate) fn charge(&mut self, measured_s: f64, is_route: bool) -> f64 {
        let charge_s = match self.settings.compute {
            ComputeCharge::None => 0.0,
            ComputeCharge::Fixed { route_s, path_s } => {
                if is_route {
                    route_s
                } else {
                    path_s
                }
            }
            ComputeCharge::Measured => {
                if measured_s.is_finite() {
                    measured_s.max(0.0)
                } else {
                    0.0
                }
            }
        };
        self.state.charged_s += charge_s;
        charge_s
    }

    pub(crate) fn next_request(&mut self) -> (u64, Seed) {
        let id = self.state.next_request;
        self.state.next_request = id.saturating_add(1);
        (id, self.seed.split(id))
    }

    pub(crate) fn finish(&mut self, outcome: Outcome, commands: &mut Vec<Command>) {
        self.state.phase = Phase::Finished(outcome);
        commands.push(Command::Finished(outcome));
    }
}
