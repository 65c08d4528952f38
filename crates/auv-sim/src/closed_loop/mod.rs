//! The closed loop of sea, vehicle, sonar, tracker and synchroniser.

mod ending;
mod motion;
mod sensing;

use crate::body::{Body, SteeredRemus};
use crate::disturbance::{Disturbance, Moment, Restart};
use crate::navigator::Navigator;
use crate::point_vehicle::PointVehicle;
use crate::scans::scan_s;
use crate::{Entry, Following, Judgement, Recorder, Scenario, SimulatedSonar, SimulatedVehicle};
use auv_mission::driver::Orders;
use auv_mission::{Event, Navigation, Synchroniser};
use auv_obstacles::truth::ObstacleField;
use auv_obstacles::{ObstaclePredictor, Region, TimedPoint, Tracker};
use auv_planning::Trajectory;
use auv_types::{ChaCha8Rng, Point3, Violations};
use std::ops::Range;
use std::sync::Arc;

/// The ids of the ships: the last of all.
pub(crate) fn ship_ids(field: &ObstacleField) -> Range<u32> {
    let ships = field.ships().len() as u32;
    let ids = field.now().iter().map(|region| region.obstacle.0 + 1);
    let end = ids.max().unwrap_or(0);
    end.saturating_sub(ships)..end
}

/// The vehicle of a scenario, at rest at the mission's start, its bow towards the first waypoint that an arc leads to.
fn vehicle(scenario: &Scenario) -> Box<dyn SimulatedVehicle> {
    let mission = &scenario.mission;
    let position = mission.position_of(mission.start);
    match scenario.body {
        Body::Point => Box::new(PointVehicle::new(
            mission.vehicle,
            position,
            scenario.guidance_error_m,
            scenario.seed.split(2),
        )),
        Body::Remus100 => {
            let first = mission.network.arcs_from(mission.start).next();
            let ahead = first.map_or(mission.destination, |(_, arc)| arc.head);
            let towards = mission.position_of(ahead) - position;
            Box::new(SteeredRemus::at(position, &towards))
        }
    }
}

/// The tracker of a scenario, with what is charted.
fn tracker(scenario: &Scenario) -> Result<Tracker, Violations> {
    let mut tracker = Tracker::new(scenario.tracker.clone())?;
    tracker.charted(scenario.field.charted());
    Ok(tracker)
}

/// A mission under way.
pub(crate) struct ClosedLoop<'a> {
    scenario: &'a Scenario,
    pub(crate) synchroniser: Synchroniser,
    pub(crate) field: ObstacleField,
    pub(crate) vehicle: Box<dyn SimulatedVehicle + 'a>,
    pub(crate) sonar: Box<dyn SimulatedSonar + 'a>,
    /// Where it believes to be; `None`: where it is.
    pub(crate) navigator: Option<Navigator>,
    /// Whether the vehicle is above its box on purpose.
    surfaces: bool,
    pub(crate) tracker: Box<dyn ObstaclePredictor + 'a>,
    pub(crate) predicted: Arc<[Region]>,
    /// What holds of the mission's fences for a time or at some depths.
    fences: Vec<Region>,
    /// The trajectory the vehicle follows, in its own clock and coordinates.
    pub(crate) trajectory: Option<Arc<Trajectory>>,
    /// The trajectory to follow from this tick on.
    ordered: Option<Arc<Trajectory>>,
    judgement: Judgement,
    /// Least distance of the true place from the destination on the leg there, metres.
    nearest_dock_m: f64,
    following: Following,
    sonar_random: ChaCha8Rng,
    altimeter_random: ChaCha8Rng,
    pub(crate) time_s: f64,
    next_scan_s: f64,
    next_tick_s: f64,
    /// Numbers of route and path calls already recorded.
    logged: (usize, usize),
    /// Ids of the ships.
    ships: Range<u32>,
    /// The true track of the current tick.
    track: Vec<TimedPoint>,
}

impl<'a> ClosedLoop<'a> {
    pub(crate) fn new(scenario: &'a Scenario) -> Result<Self, Violations> {
        let mission = &scenario.mission;
        Ok(Self {
            scenario,
            synchroniser: Synchroniser::new(
                Arc::clone(mission),
                scenario.settings.clone(),
                scenario.seed.split(0),
            )?,
            field: scenario.field.clone(),
            vehicle: vehicle(scenario),
            sonar: Box::new(scenario.sonar.clone()),
            navigator: mission
                .navigation
                .map(|navigation| Navigator::new(navigation, scenario.seed.split(5))),
            surfaces: false,
            tracker: Box::new(tracker(scenario)?),
            predicted: [].into(),
            fences: scenario.fences.regions(mission.bounds.as_ref()),
            trajectory: None,
            ordered: None,
            judgement: Judgement::default(),
            nearest_dock_m: f64::INFINITY,
            following: Following::default(),
            sonar_random: scenario.seed.split(1).stream(0),
            altimeter_random: scenario.seed.split(4).stream(0),
            time_s: 0.0,
            next_scan_s: 0.0,
            next_tick_s: 0.0,
            logged: (0, 0),
            ships: ship_ids(&scenario.field),
            track: Vec::new(),
        })
    }

    /// Whether the mission is over.
    pub(crate) fn is_over(&self) -> bool {
        self.synchroniser.outcome().is_some()
    }

    /// Scans if a scan is due.
    fn scan_in_time(&mut self, now: &Moment, disturbance: &mut dyn Disturbance) {
        if self.time_s >= self.next_scan_s - 1e-9 {
            let error_m = Navigation::SIGMAS * self.sigma_m();
            self.tracker.unsure_of_place(error_m);
            let ships = self.reported_ships();
            self.tracker.reported(ships);
            self.scan(now, disturbance);
            let scenario = self.scenario;
            self.next_scan_s = self.time_s + scan_s(scenario.tick_s, scenario.sonar.period_s);
        }
    }

    /// Whether the synchroniser is told nothing now: between two ticks the sonar scans alone, unless something closes in.
    fn only_scans(&self) -> bool {
        let due = self.time_s >= self.synchroniser.due_s() - 1e-9;
        self.time_s < self.next_tick_s - 1e-9 && !due && !self.tracker.is_urgent()
    }

    /// One tick: scans, tracks, steps the synchroniser and carries out its commands.
    pub(crate) fn tick(&mut self, disturbance: &mut dyn Disturbance, recorder: &mut dyn Recorder) {
        let mut now = Moment {
            time_s: self.time_s,
            since_s: 0.0,
            position: self.vehicle.position(),
            velocity: self.vehicle.velocity(),
            target: self.target(),
        };
        disturbance.tick(&mut now);
        if disturbance.is_down(self.time_s) {
            self.next_scan_s = self.time_s + self.scenario.tick_s;
            return;
        }
        self.restart(disturbance);
        self.scan_in_time(&now, disturbance);
        if self.only_scans() {
            return;
        }
        if self.time_s >= self.next_tick_s - 1e-9 {
            self.next_tick_s = self.time_s + self.scenario.tick_s;
        }
        self.predict();
        let fresh_s = self.tracker.fresh_s().unwrap_or(0.0);
        let mut events = disturbance.events(&now);
        let altitude = self.measured_altitude();
        events.extend(altitude.map(|altitude_m| Event::AltitudeMeasured { altitude_m }));
        if self.time_s - fresh_s > 2.0 * self.scenario.tick_s {
            events.push(Event::SonarSilent {
                age_s: self.time_s - fresh_s,
            });
        }
        events.extend(self.dock_contact());
        events.push(Event::Tick(self.observation(self.error(disturbance))));
        for event in events {
            let orders = disturbance.tell(&mut self.synchroniser, event, self.time_s);
            self.take(orders);
        }
        self.record_calls(recorder);
        if let Some(trajectory) = self.ordered.take() {
            let trajectory = disturbance.follow(trajectory, &self.synchroniser);
            let clock_s = self.time_s + disturbance.sensing_error().clock_s;
            recorder.record(Entry::Follow(clock_s, &trajectory));
            self.vehicle.take(&trajectory, clock_s);
            self.trajectory = Some(trajectory);
        }
    }

    /// Restarts the software if it crashed.
    fn restart(&mut self, disturbance: &mut dyn Disturbance) {
        let restart = disturbance.restart(&mut self.synchroniser);
        if restart == Restart::None {
            return;
        }
        if restart == Restart::WithoutTracks {
            match tracker(self.scenario) {
                Ok(empty) => self.tracker = Box::new(empty),
                Err(violations) => disturbance.fail(violations.to_string()),
            }
        }
        // A resumed checkpoint may hold fewer calls.
        let calls = self.calls();
        self.logged = (self.logged.0.min(calls.0), self.logged.1.min(calls.1));
        let orders = disturbance.carry_on(&mut self.synchroniser, self.time_s);
        self.take(orders);
    }

    /// Keeps the last trajectory to follow.
    fn take(&mut self, orders: Orders) {
        self.ordered = orders.follow.or(self.ordered.take());
    }

    /// Records the route and path calls that are new.
    fn record_calls(&mut self, recorder: &mut dyn Recorder) {
        for call in &self.synchroniser.route_calls()[self.logged.0..] {
            recorder.record(Entry::Route(call));
        }
        for call in &self.synchroniser.path_calls()[self.logged.1..] {
            recorder.record(Entry::Leg(call));
        }
        self.logged = self.calls();
    }

    /// Numbers of route and path calls so far.
    fn calls(&self) -> (usize, usize) {
        (
            self.synchroniser.route_calls().len(),
            self.synchroniser.path_calls().len(),
        )
    }

    /// The end of the current leg.
    fn target(&self) -> Point3<f64> {
        let mission = self.synchroniser.mission();
        let next = self.synchroniser.route().get(1);
        mission.position_of(next.copied().unwrap_or(mission.destination))
    }
}
