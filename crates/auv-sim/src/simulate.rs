//! The closed loop: true sea, vehicle, sonar, tracker, synchroniser.

use crate::vehicle::SimulatedVehicle;
use crate::{Judgement, MissionOutcome, Scenario, Summary};
use auv_mission::driver::Stepped;
use auv_mission::{Observation, Outcome, PathCall, RouteCall, Synchroniser};
use auv_obstacles::{Kind, ObstacleId, ObstaclePredictor, Region, TimedPoint, Tracker};
use auv_planning::Trajectory;
use auv_types::{ChaCha8Rng, Violations, libm};
use std::sync::Arc;

/// Something worth recording, as it happens.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Entry<'a> {
    /// The mission starts.
    Started(&'a Scenario),
    /// A route call was answered.
    Route(&'a RouteCall),
    /// A trajectory goes into force at a mission time.
    Follow(f64, &'a Trajectory),
    /// A leg is over.
    Leg(&'a PathCall),
    /// A piece of the true track with the truth over the same time, and what is predicted now.
    Flown {
        /// The true track, begin included.
        track: &'a [TimedPoint],
        /// The true obstacles over the same time.
        truth: &'a [Region],
        /// The obstacles as predicted at its end, clearances included.
        predicted: &'a [Region],
    },
    /// The mission is over.
    Ended(&'a Summary),
}

/// Takes down what happens in a mission.
pub trait Recorder {
    /// Takes down one entry.
    fn record(&mut self, entry: Entry<'_>);
}

/// Records nothing.
impl Recorder for () {
    fn record(&mut self, _entry: Entry<'_>) {}
}

impl<A: Recorder, B: Recorder> Recorder for (A, B) {
    fn record(&mut self, entry: Entry<'_>) {
        self.0.record(entry);
        self.1.record(entry);
    }
}

impl<R: Recorder + ?Sized> Recorder for &mut R {
    fn record(&mut self, entry: Entry<'_>) {
        (**self).record(entry);
    }
}

/// Flies a scenario to its end.
///
/// # Determinism
/// Depends on the scenario and the planners alone.
///
/// # Errors
/// Everything that keeps the mission from starting.
pub fn simulate(
    scenario: &Scenario,
    driver: &Stepped<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Summary, Violations> {
    scenario.validate().into_result()?;
    let mut loop_ = ClosedLoop::new(scenario)?;
    recorder.record(Entry::Started(scenario));
    loop_.look(driver, recorder);
    while loop_.synchroniser.outcome().is_none() {
        loop_.fly_to_next_tick(recorder);
        loop_.look(driver, recorder);
    }
    let summary = loop_.summary();
    recorder.record(Entry::Ended(&summary));
    Ok(summary)
}

struct ClosedLoop<'a> {
    scenario: &'a Scenario,
    synchroniser: Synchroniser,
    field: auv_obstacles::truth::ObstacleField,
    vehicle: SimulatedVehicle,
    tracker: Tracker,
    charted: Vec<Region>,
    predicted: Arc<[Region]>,
    trajectory: Option<Arc<Trajectory>>,
    judgement: Judgement,
    sonar_random: ChaCha8Rng,
    time_s: f64,
    next_scan_s: f64,
    logged: (usize, usize),
    first_ship: u32,
    track: Vec<TimedPoint>,
}

impl<'a> ClosedLoop<'a> {
    fn new(scenario: &'a Scenario) -> Result<Self, Violations> {
        let mission = &scenario.mission;
        let start = mission.position_of(mission.start);
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
                mission.vehicle,
                start,
                scenario.guidance_error_m,
                scenario.seed.split(2),
            ),
            tracker,
            charted: charted
                .into_iter()
                .map(|region| scenario.clearance.inflated(Kind::Charted, region))
                .collect(),
            predicted: [].into(),
            trajectory: None,
            judgement: Judgement::default(),
            sonar_random: scenario.seed.split(1).stream(0),
            time_s: 0.0,
            next_scan_s: 0.0,
            logged: (0, 0),
            first_ship: if ships == 0 {
                u32::MAX
            } else {
                obstacles.saturating_sub(ships)
            },
            track: Vec::new(),
        })
    }

    /// Scans, tracks, and lets the synchroniser decide.
    fn look(&mut self, driver: &Stepped<'_>, recorder: &mut dyn Recorder) {
        if self.time_s >= self.next_scan_s - 1e-9 {
            let velocity = self.vehicle.velocity();
            let heading_rad = if velocity.xy().norm() > 1e-6 {
                libm::atan2(velocity.y, velocity.x)
            } else {
                0.0
            };
            let scan = self.scenario.sonar.scan(
                self.field.now(),
                &self.vehicle.position(),
                heading_rad,
                self.time_s,
                &mut self.sonar_random,
            );
            self.tracker.observe(&scan);
            self.next_scan_s = self.time_s + self.scenario.tick_s;
        }
        self.predict();
        let observation = Observation {
            time_s: self.time_s,
            position: self.vehicle.position(),
            velocity: self.vehicle.velocity(),
            regions: Arc::clone(&self.predicted),
        };
        let orders = driver.tick(&mut self.synchroniser, observation);
        for call in &self.synchroniser.route_calls()[self.logged.0..] {
            recorder.record(Entry::Route(call));
        }
        for call in &self.synchroniser.path_calls()[self.logged.1..] {
            recorder.record(Entry::Leg(call));
        }
        self.logged = (
            self.synchroniser.route_calls().len(),
            self.synchroniser.path_calls().len(),
        );
        if let Some(trajectory) = orders.follow {
            recorder.record(Entry::Follow(self.time_s, &trajectory));
            self.vehicle.take(&trajectory, self.time_s);
            self.trajectory = Some(trajectory);
        }
    }

    /// What the planners may know: charts, tracks, and ships as their transponders report them.
    fn predict(&mut self) {
        let policy = &self.scenario.clearance;
        let mut regions = self.charted.clone();
        let mut tracked = Vec::new();
        self.tracker.tracked_into(self.time_s, &mut tracked);
        regions.extend(
            tracked
                .into_iter()
                .map(|region| policy.inflated(Kind::Contact, region)),
        );
        let horizon_s = self.scenario.tracker.horizon_s;
        for (k, ship) in self.field.ships().iter().enumerate() {
            let id = ObstacleId(self.first_ship.saturating_add(k as u32));
            if let Some(reported) = ship.region_at(id, self.time_s) {
                let ahead = Region {
                    from_s: self.time_s,
                    until_s: self.time_s + horizon_s,
                    ..reported
                };
                regions.push(policy.inflated(Kind::Ship, ahead));
            }
        }
        self.predicted = regions.into();
    }

    /// Lets the sea and the vehicle move on until the next scan or the end of the trajectory.
    fn fly_to_next_tick(&mut self, recorder: &mut dyn Recorder) {
        let mut until_s = self.next_scan_s;
        let due_s = self.synchroniser.due_s();
        if due_s > self.time_s {
            until_s = until_s.min(due_s);
        }
        if until_s <= self.time_s {
            until_s = self.time_s + self.scenario.tick_s;
        }
        let water = self.scenario.true_current.as_deref();
        self.field.step(until_s - self.time_s, &|place, time_s| {
            water.map_or_else(auv_types::Vector3::zeros, |field| {
                field.velocity_at(place, time_s)
            })
        });
        self.track.clear();
        self.track
            .push(TimedPoint::new(self.vehicle.position(), self.time_s));
        let vehicle_water = water.filter(|_| self.scenario.current_moves_vehicle);
        match &self.trajectory {
            Some(trajectory) => {
                self.vehicle.advance(
                    trajectory,
                    self.time_s,
                    until_s,
                    vehicle_water,
                    &mut self.track,
                );
            }
            None => self
                .track
                .push(TimedPoint::new(self.vehicle.position(), until_s)),
        }
        let bed = self
            .scenario
            .true_bed
            .as_deref()
            .or(self.scenario.mission.sea_bed.as_deref());
        self.judgement
            .judge(&self.track, self.field.regions(), self.first_ship, bed);
        recorder.record(Entry::Flown {
            track: &self.track,
            truth: self.field.regions(),
            predicted: &self.predicted,
        });
        self.time_s = until_s;
    }

    fn summary(&self) -> Summary {
        let synchroniser = &self.synchroniser;
        let ended = synchroniser.outcome().unwrap_or(Outcome::Late);
        let judgement = &self.judgement;
        let (outcome, reason) = if judgement.collisions > 0 || judgement.groundings > 0 {
            let what = if judgement.collisions > 0 {
                "touched an obstacle"
            } else {
                "touched the sea bed"
            };
            (MissionOutcome::Collided, what.to_owned())
        } else {
            match ended {
                Outcome::Docked => (
                    MissionOutcome::Docked,
                    "reached the destination in time".to_owned(),
                ),
                Outcome::Aborted(reason) => {
                    let taken = synchroniser.contingency();
                    let taken = taken.map_or_else(String::new, |rung| format!("; {rung}"));
                    (MissionOutcome::Aborted, format!("{reason}{taken}"))
                }
                _ => (
                    MissionOutcome::Late,
                    "reached the destination after the budget".to_owned(),
                ),
            }
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
            judgement: judgement.clone(),
        }
    }
}
