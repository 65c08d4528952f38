//! The closed loop of sea, vehicle, sonar, tracker and synchroniser.

use crate::disturbance::{Disturbance, Moment, SensingError};
use crate::limits::Asked;
use crate::oracle::SeaInterval;
use crate::vehicle::SimulatedVehicle;
use crate::way::Way;
use crate::{EndReason, Entry, Following, Judgement, MissionOutcome, Recorder, Scenario, Summary};
use auv_mission::driver::Stepped;
use auv_mission::{Command, Contingency, Event, Observation, Outcome, Synchroniser};
use auv_obstacles::{ObstacleId, ObstaclePredictor, Region, RegionSource, TimedPoint, Tracker};
use auv_ocean::{CurrentField, SeaBed};
use auv_planning::Trajectory;
use auv_types::{ChaCha8Rng, Point3, Vector3, Violations, libm};
use std::ops::Range;
use std::sync::Arc;

/// Flies a scenario to its end.
///
/// # Determinism
/// The result depends on the scenario and the planners only.
///
/// # Errors
/// Every reason why the scenario is invalid.
pub fn simulate(
    scenario: &Scenario,
    driver: &Stepped<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Summary, Violations> {
    fly(scenario, driver, &mut (), recorder)
}

/// A mission that lasts longer than this many budgets, and this many ticks more, counts as endless.
const MOST_BUDGETS: f64 = 10.0;
const SPARE_TICKS: f64 = 100_000.0;
/// Longest time between two scans, seconds. Over a longer one an echo of an unknown contact is expected so
/// far away that false echoes pass for it, and form tracks.
const LONGEST_SCAN_S: f64 = 10.0;
/// Number of commands in one tick after which the tick counts as endless.
const MAX_COMMANDS: u32 = 1_000;

/// Flies a scenario to its end under a disturbance.
pub(crate) fn fly(
    scenario: &Scenario,
    driver: &Stepped<'_>,
    disturbance: &mut dyn Disturbance,
    recorder: &mut dyn Recorder,
) -> Result<Summary, Violations> {
    scenario.validate().into_result()?;
    let mut closed_loop = ClosedLoop::new(scenario)?;
    recorder.record(Entry::Started(scenario));
    closed_loop.tick(driver, disturbance, recorder);
    let most_ticks = most_ticks(scenario);
    for ticks in 1_u64.. {
        if closed_loop.synchroniser.outcome().is_some() {
            break;
        }
        if ticks > most_ticks {
            disturbance.fail("the mission does not end".into());
            break;
        }
        closed_loop.fly_to_next_tick(disturbance, recorder);
        closed_loop.tick(driver, disturbance, recorder);
    }
    let summary = closed_loop.summary();
    recorder.record(Entry::Ended(&summary));
    Ok(summary)
}

/// Number of ticks after which a mission counts as endless. It grows with the budget, so that a long
/// mission with short ticks is flown to its end.
fn most_ticks(scenario: &Scenario) -> u64 {
    let longest_s = MOST_BUDGETS * scenario.mission.budget_s + Contingency::LONGEST_S;
    (longest_s / scenario.tick_s + SPARE_TICKS) as u64
}

struct ClosedLoop<'a> {
    scenario: &'a Scenario,
    synchroniser: Synchroniser,
    field: auv_obstacles::truth::ObstacleField,
    vehicle: SimulatedVehicle,
    tracker: Tracker,
    charted: Vec<Region>,
    predicted: Arc<[Region]>,
    /// The trajectory the vehicle follows, in its own clock and coordinates.
    trajectory: Option<Arc<Trajectory>>,
    /// The trajectory to follow from this tick on.
    ordered: Option<Arc<Trajectory>>,
    judgement: Judgement,
    following: Following,
    sonar_random: ChaCha8Rng,
    altimeter_random: ChaCha8Rng,
    time_s: f64,
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
    fn new(scenario: &'a Scenario) -> Result<Self, Violations> {
        let mission = &scenario.mission;
        let charted = scenario.field.charted();
        let mut tracker = Tracker::new(scenario.tracker.clone())?;
        tracker.charted(charted.clone());
        let ships = scenario.field.ships().len() as u32;
        let obstacles = scenario
            .field
            .now()
            .iter()
            .map(|r| r.obstacle.0 + 1)
            .max()
            .unwrap_or(0);
        Ok(Self {
            scenario,
            synchroniser: Synchroniser::new(
                Arc::clone(mission),
                scenario.settings.clone(),
                scenario.seed.split(0),
            )?,
            field: scenario.field.clone(),
            vehicle: SimulatedVehicle::new(
                scenario.body,
                mission,
                scenario.guidance_error_m,
                scenario.seed.split(2),
            ),
            tracker,
            charted: charted
                .into_iter()
                .map(|region| scenario.clearance.inflated(RegionSource::Charted, region))
                .collect(),
            predicted: [].into(),
            trajectory: None,
            ordered: None,
            judgement: Judgement::default(),
            following: Following::default(),
            sonar_random: scenario.seed.split(1).stream(0),
            altimeter_random: scenario.seed.split(4).stream(0),
            time_s: 0.0,
            next_scan_s: 0.0,
            next_tick_s: 0.0,
            logged: (0, 0),
            ships: obstacles.saturating_sub(ships)..obstacles,
            track: Vec::new(),
        })
    }

    /// Time between two scans: a tick, or an even part of one.
    fn scan_s(&self) -> f64 {
        let tick_s = self.scenario.tick_s;
        tick_s / (tick_s / LONGEST_SCAN_S).ceil().max(1.0)
    }

    /// Scans if a scan is due.
    fn scan_in_time(&mut self, now: &Moment, disturbance: &mut dyn Disturbance) {
        if self.time_s >= self.next_scan_s - 1e-9 {
            self.scan(now, disturbance);
            self.next_scan_s = self.time_s + self.scan_s();
        }
    }

    /// Whether the synchroniser is told nothing now: between two ticks the sonar scans alone.
    fn only_scans(&self) -> bool {
        let due = self.time_s >= self.synchroniser.due_s() - 1e-9;
        self.time_s < self.next_tick_s - 1e-9 && !due
    }

    /// One tick: scans, tracks, steps the synchroniser and carries out its commands.
    fn tick(
        &mut self,
        driver: &Stepped<'_>,
        disturbance: &mut dyn Disturbance,
        recorder: &mut dyn Recorder,
    ) {
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
        if disturbance.restart(&mut self.synchroniser, &mut self.tracker) {
            // A resumed checkpoint may hold fewer calls.
            let calls = self.calls();
            self.logged = (self.logged.0.min(calls.0), self.logged.1.min(calls.1));
            let outstanding = self.synchroniser.outstanding();
            self.carry_out(driver, disturbance, outstanding.into_iter().collect());
        }
        self.scan_in_time(&now, disturbance);
        if self.scan_s() < self.scenario.tick_s {
            if self.only_scans() {
                return;
            }
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
        events.push(Event::Tick(self.observation(disturbance.sensing_error())));
        for event in events {
            let commands = self.synchroniser.step(event);
            self.carry_out(driver, disturbance, commands);
        }
        for call in &self.synchroniser.route_calls()[self.logged.0..] {
            recorder.record(Entry::Route(call));
        }
        for call in &self.synchroniser.path_calls()[self.logged.1..] {
            recorder.record(Entry::Leg(call));
        }
        self.logged = self.calls();
        if let Some(trajectory) = self.ordered.take() {
            let trajectory = disturbance.follow(trajectory, &self.synchroniser);
            let clock_s = self.time_s + disturbance.sensing_error().clock_s;
            recorder.record(Entry::Follow(clock_s, &trajectory));
            self.vehicle.take(&trajectory, clock_s);
            self.trajectory = Some(trajectory);
        }
    }

    /// What the altimeter answers, if there is one and it answers.
    fn measured_altitude(&mut self) -> Option<f64> {
        let scenario = self.scenario;
        let altimeter = scenario.altimeter.as_ref()?;
        let bed = scenario.bed_between(self.time_s, self.time_s)?;
        let place = self.vehicle.position();
        let altitude_m = bed.depth_at(place.x, place.y) - place.z;
        altimeter.measure(altitude_m, &mut self.altimeter_random)
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

    /// Carries out commands and the commands that follow from the answers. The last trajectory to follow is
    /// kept in `ordered`.
    fn carry_out(
        &mut self,
        driver: &Stepped<'_>,
        disturbance: &mut dyn Disturbance,
        mut commands: Vec<Command>,
    ) {
        let mut count = 0;
        while !commands.is_empty() {
            let mut next = Vec::new();
            for command in commands {
                if let Command::Follow(trajectory) = &command {
                    self.ordered = Some(Arc::clone(trajectory));
                }
                count += 1;
                if let Some(answer) = disturbance.answer(driver, &command, self.time_s) {
                    next.extend(self.synchroniser.step(answer));
                }
            }
            commands = next;
            if count > MAX_COMMANDS {
                return disturbance.fail("commands without end in one tick".into());
            }
        }
    }

    /// Scans the true sea. The tracker gets the echoes relative to the position the vehicle believes.
    fn scan(&mut self, now: &Moment, disturbance: &mut dyn Disturbance) {
        let velocity = self.vehicle.velocity();
        let heading_rad = if velocity.xy().norm() > 1e-6 {
            libm::atan2(velocity.y, velocity.x)
        } else {
            0.0
        };
        let unknown = disturbance.obstacles();
        let whole: Vec<Region>;
        let truth = if unknown.is_empty() {
            self.field.now()
        } else {
            whole = [self.field.now(), unknown].concat();
            &whole
        };
        let mut scan = self.scenario.sonar.scan(
            truth,
            &self.vehicle.position(),
            heading_rad,
            self.time_s,
            &mut self.sonar_random,
        );
        let error = disturbance.sensing_error();
        if error.shift != Vector3::zeros() {
            scan.from += error.shift;
            for echo in &mut scan.detections {
                echo.position += error.shift;
            }
        }
        if error.lost {
            scan.from.x = f64::NAN;
        }
        for scan in disturbance.scans(now, scan) {
            self.tracker.observe(&scan);
        }
    }

    /// The observation the synchroniser gets.
    fn observation(&self, error: SensingError) -> Observation {
        let slip_s = error.clock_s + error.stamp_s;
        let mut observation = Observation {
            time_s: self.time_s,
            position: self.vehicle.position(),
            velocity: self.vehicle.velocity(),
            regions: Arc::clone(&self.predicted),
        };
        if error.lost {
            observation.position.x = f64::NAN;
        } else if error.shift != Vector3::zeros() {
            observation.position += error.shift;
        }
        if slip_s != 0.0 {
            observation.time_s += slip_s;
            let later = |region: &Region| Region {
                at_s: region.at_s + slip_s,
                from_s: region.from_s + slip_s,
                until_s: region.until_s + slip_s,
                ..*region
            };
            observation.regions = self.predicted.iter().map(later).collect();
        }
        observation
    }

    /// Predicts regions from the chart, the tracks, and the ships as their transponders report them.
    fn predict(&mut self) {
        let policy = &self.scenario.clearance;
        let mut regions = self.charted.clone();
        let mut tracked = Vec::new();
        self.tracker.tracked_into(self.time_s, &mut tracked);
        regions.extend(
            tracked
                .into_iter()
                .map(|region| policy.inflated(RegionSource::Contact, region)),
        );
        let horizon_s = self.scenario.tracker.horizon_s;
        for (k, ship) in self.field.ships().iter().enumerate() {
            let id = ObstacleId(self.ships.start.saturating_add(k as u32));
            if let Some(reported) = ship.region_at(id, self.time_s) {
                let ahead = Region {
                    from_s: self.time_s,
                    until_s: self.time_s + horizon_s,
                    ..reported
                };
                regions.push(policy.inflated(RegionSource::Ship, ahead));
            }
        }
        self.predicted = regions.into();
    }

    /// Advances sea and vehicle until the next scan or the time the synchroniser is due.
    fn fly_to_next_tick(&mut self, disturbance: &mut dyn Disturbance, recorder: &mut dyn Recorder) {
        let error = disturbance.sensing_error();
        let mut until_s = self.next_scan_s;
        let due_s = self.synchroniser.due_s() - error.clock_s;
        if due_s > self.time_s {
            until_s = until_s.min(due_s);
        }
        if until_s <= self.time_s {
            until_s = self.time_s + self.scenario.tick_s;
        }
        let water = self.scenario.true_current.as_deref();
        let added = disturbance.water(self.time_s);
        self.field.step(until_s - self.time_s, &|place, time_s| {
            let natural = water.map_or_else(Vector3::zeros, |w| w.velocity_at(place, time_s));
            added.map_or(natural, |added| natural + added)
        });
        self.track.clear();
        self.track
            .push(TimedPoint::new(self.vehicle.position(), self.time_s));
        let pace = disturbance.pace(self.time_s);
        self.follow(until_s, error, pace, added);
        if let Some(trajectory) = &self.trajectory {
            for at in &self.track[1..] {
                let told = trajectory.at(at.time_s + error.clock_s).0 - error.shift;
                self.following.see((at.position - told).norm());
            }
        }
        let bed = self.scenario.bed_between(self.time_s, until_s);
        let bed = bed.as_ref().map(|bed| bed as &dyn SeaBed);
        let whole: Vec<Region>;
        let truth = if disturbance.obstacles().is_empty() {
            self.field.regions()
        } else {
            whole = [self.field.regions(), disturbance.obstacles()].concat();
            &whole
        };
        let scenario = self.scenario;
        let asked = Asked::of(&scenario.mission, scenario.guidance_error_m);
        let judgement = &mut self.judgement;
        judgement.judge(&self.track, truth, &self.ships, bed, &asked);
        if disturbance.wants_truth() {
            disturbance.record_truth(self.interval(until_s, truth, (pace, added)));
        }
        recorder.record(Entry::Flown {
            track: &self.track,
            truth,
            predicted: &self.predicted,
        });
        self.time_s = until_s;
    }

    /// The truth since the last tick, for the oracle.
    fn interval(
        &self,
        until_s: f64,
        truth: &[Region],
        (pace, added): (f64, Option<Vector3<f64>>),
    ) -> SeaInterval {
        let natural = self.scenario.true_current.as_deref();
        let natural = natural.filter(|_| self.scenario.current_moves_vehicle);
        SeaInterval {
            from_s: self.time_s,
            until_s,
            place: self.track[0].position,
            regions: truth.to_vec(),
            water: added.unwrap_or_else(Vector3::zeros),
            water_differs_mps: natural.map_or(0.0, CurrentField::max_speed_mps),
            max_speed_mps: self.scenario.mission.vehicle.max_speed_mps * pace,
        }
    }

    /// Moves the vehicle along what it follows.
    fn follow(
        &mut self,
        until_s: f64,
        error: SensingError,
        pace: f64,
        added: Option<Vector3<f64>>,
    ) {
        let natural = self.scenario.true_current.as_deref();
        let natural = natural.filter(|_| self.scenario.current_moves_vehicle);
        let pushed = added.map(|added| Pushed { natural, added });
        let water = pushed
            .as_ref()
            .map_or(natural, |w| Some(w as &dyn CurrentField));
        let Some(trajectory) = &self.trajectory else {
            let here = TimedPoint::new(self.vehicle.position(), until_s);
            return self.track.push(here);
        };
        if error == SensingError::NONE && (pace - 1.0).abs() <= 0.0 {
            let way = Way {
                trajectory,
                from_s: self.time_s,
                until_s,
                pace: 1.0,
            };
            let mission = &self.scenario.mission;
            return self.vehicle.advance(way, mission, water, &mut self.track);
        }
        // The trajectory in true time and true coordinates; a pace above 1 brings later points forward.
        let hurry = pace.max(1.0);
        let truly = |p: &TimedPoint| {
            let time_s = p.time_s - error.clock_s;
            let time_s = self.time_s + (time_s - self.time_s) / hurry;
            TimedPoint::new(p.position - error.shift, time_s)
        };
        let here = TimedPoint::new(self.vehicle.position(), self.time_s);
        let trajectory = Trajectory::new(trajectory.points().iter().map(truly).collect())
            .unwrap_or_else(|_| Trajectory::hover(here, until_s - self.time_s));
        let way = Way {
            trajectory: &trajectory,
            from_s: self.time_s,
            until_s,
            pace,
        };
        let mission = &self.scenario.mission;
        self.vehicle.advance(way, mission, water, &mut self.track);
    }

    fn summary(&self) -> Summary {
        let synchroniser = &self.synchroniser;
        let ended = synchroniser.outcome().unwrap_or(Outcome::Late);
        let judgement = &self.judgement;
        let (outcome, reason) = match ended {
            _ if judgement.collisions > 0 => (MissionOutcome::Collided, EndReason::TouchedObstacle),
            _ if judgement.groundings > 0 => (MissionOutcome::Collided, EndReason::TouchedSeaBed),
            Outcome::Docked => (MissionOutcome::Docked, EndReason::InTime),
            Outcome::Aborted(reason) => {
                let contingency = synchroniser.contingency();
                let reason = EndReason::Aborted {
                    reason,
                    contingency,
                };
                (MissionOutcome::Aborted, reason)
            }
            _ => (MissionOutcome::Late, EndReason::AfterBudget),
        };
        Summary {
            outcome,
            reason,
            visited: synchroniser.visited().to_vec(),
            mission_weight: synchroniser.weight(),
            tasks: synchroniser.tasks(),
            time_s: self.time_s,
            remaining_s: synchroniser.available_s(),
            route_calls: synchroniser.route_calls().to_vec(),
            path_calls: synchroniser.path_calls().to_vec(),
            climbs: synchroniser.climbs(),
            raised: synchroniser.raised().to_vec(),
            dock_error_m: (ended == Outcome::Docked).then(|| {
                let dock = synchroniser
                    .mission()
                    .position_of(synchroniser.mission().destination);
                (self.vehicle.position() - dock).norm()
            }),
            following: self.following.clone(),
            judgement: judgement.clone(),
        }
    }
}

/// The sum of a current and a uniform one.
#[derive(Debug)]
struct Pushed<'a> {
    natural: Option<&'a dyn CurrentField>,
    added: Vector3<f64>,
}

impl CurrentField for Pushed<'_> {
    fn velocity_at(&self, place: &Point3<f64>, time_s: f64) -> Vector3<f64> {
        let natural = self.natural.map(|field| field.velocity_at(place, time_s));
        natural.unwrap_or_else(Vector3::zeros) + self.added
    }

    fn max_speed_mps(&self) -> f64 {
        self.natural.map_or(0.0, |field| field.max_speed_mps()) + self.added.norm()
    }
}
