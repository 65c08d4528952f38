//! Faults that act on a mission under way.

use super::injection::Injection;
use super::planners::deadline_s;
#[cfg(feature = "serde")]
use super::restart;
use super::witness::Witness;
use super::{Fault, FaultPlan, Intensity, canary, clock, motion, planners, sea, sonar};
use crate::Scenario;
use crate::disturbance::{Disturbance, Moment, Restart, SensingError};
use crate::oracle::SeaInterval;
use auv_mission::driver::{Orders, Stepped};
use auv_mission::{Command, Event, Synchroniser};
use auv_obstacles::{ObstacleId, Region, Scan};
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{PlanError, Trajectory};
use auv_types::rand::RngExt;
use auv_types::{Seed, Vector3};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The faults of a mission under way.
pub(super) struct ActiveFaults<'a> {
    injections: Vec<Box<dyn Injection>>,
    witness: &'a Witness,
    driver: &'a Stepped<'a>,
    /// Earliest start of the faults, mission time in seconds.
    not_before_s: f64,
    /// Set when the faults start; shared with the faulty planners.
    started: Arc<AtomicBool>,
    started_s: Option<f64>,
    obstacles: Vec<Region>,
    error: SensingError,
    /// Late answers, each with the mission time at which it arrives.
    late: Vec<(f64, Event)>,
    /// Number of planner calls that never returned: route planner, path planner.
    hanging: [u32; 2],
    failures: Vec<String>,
    /// The truth since the faults started.
    intervals: Vec<SeaInterval>,
}

impl<'a> ActiveFaults<'a> {
    /// Most failures recorded for one run.
    const MAX_FAILURES: usize = 10;
    /// Number of commands in one tick after which the tick counts as endless.
    const MAX_COMMANDS: u32 = 1_000;

    /// The faults of a plan, not yet started.
    /// `started` is set when they start; the faulty planners of `driver` share it.
    pub(super) fn new(
        plan: &FaultPlan,
        scenario: &Scenario,
        (driver, witness): (&'a Stepped<'a>, &'a Witness),
        started: Arc<AtomicBool>,
    ) -> Self {
        let injections = plan.faults.iter().enumerate();
        let injections = injections.filter_map(|(k, &fault)| {
            injection_of(fault, plan.intensity, plan.seed.split(k as u64))
        });
        // Early enough that legs are left, late enough that the vehicle is under way.
        let share = plan.seed.split(99).stream(0).random_range(0.05..0.5);
        Self {
            injections: injections.collect(),
            witness,
            driver,
            not_before_s: share * scenario.mission.budget_s,
            started,
            started_s: None,
            obstacles: Vec::new(),
            error: SensingError::NONE,
            late: Vec::new(),
            hanging: [0; 2],
            failures: Vec::new(),
            intervals: Vec::new(),
        }
    }

    /// Changes the scenario so that the faults can happen.
    pub(super) fn prepare(&mut self, scenario: &mut Scenario) {
        for injection in &mut self.injections {
            injection.prepare(scenario);
        }
    }

    /// When the faults started, what must never happen and did, and the truth since the start.
    pub(super) fn into_findings(self) -> (Option<f64>, Vec<String>, Vec<SeaInterval>) {
        (self.started_s, self.failures, self.intervals)
    }

    fn since_s(&self, time_s: f64) -> Option<f64> {
        self.started_s.map(|started_s| time_s - started_s)
    }

    /// Starts the faults at the first tick in the middle of a leg, far from its target.
    fn start_if_due(&mut self, now: &Moment) {
        let under_way = now.velocity.norm() > 0.5 && (now.target - now.position).norm() > 300.0;
        if self.started_s.is_some() || now.time_s < self.not_before_s || !under_way {
            return;
        }
        self.started_s = Some(now.time_s);
        self.started.store(true, Ordering::Relaxed);
        for injection in &mut self.injections {
            injection.start(now, &mut self.obstacles);
        }
        for (k, region) in self.obstacles.iter_mut().enumerate() {
            region.obstacle = ObstacleId(u32::MAX - k as u32);
        }
    }

    /// The planners' answer to a command; `None` if there is none at this tick. A planner that twice never returned is
    /// replaced by the baseline planner.
    fn answer(&mut self, command: &Command, time_s: f64) -> Option<Event> {
        let driver = self.driver;
        let asks = matches!(command, Command::PlanRoute(_) | Command::PlanPath(_));
        if self.started_s.is_none() || !asks {
            return driver.answer(command);
        }
        let planner = usize::from(matches!(command, Command::PlanPath(_)));
        if self.hanging[planner] >= 2 {
            return Stepped::new(&GreedyRoute, &StraightPath).answer(command);
        }
        let late_by = self.injections.iter_mut().map(|i| i.late_by_s(command));
        let late_by_s = late_by.fold(0.0, f64::max);
        let deadline_s = deadline_s(command);
        if late_by_s <= 0.0 {
            return driver.answer(command);
        }
        let event = if late_by_s > deadline_s {
            self.hanging[planner] += u32::from(late_by_s.is_infinite());
            overrun(command)
        } else {
            driver.answer(command)
        };
        let due_s = time_s + late_by_s.min(deadline_s);
        self.late.extend(event.map(|event| (due_s, event)));
        None
    }

    /// Carries out commands and the commands that follow from the answers.
    fn carry_out(
        &mut self,
        synchroniser: &mut Synchroniser,
        mut commands: Vec<Command>,
        time_s: f64,
    ) -> Orders {
        let (mut orders, mut count) = (Orders::default(), 0);
        while !commands.is_empty() {
            let mut next = Vec::new();
            for command in commands {
                count += 1;
                if let Some(answer) = self.answer(&command, time_s) {
                    next.extend(synchroniser.step(answer));
                }
                orders.take(command);
            }
            commands = next;
            if count > Self::MAX_COMMANDS {
                self.fail("commands without end in one tick".into());
                break;
            }
        }
        orders
    }
}

impl Disturbance for ActiveFaults<'_> {
    fn tell(&mut self, synchroniser: &mut Synchroniser, event: Event, time_s: f64) -> Orders {
        let commands = synchroniser.step(event);
        self.carry_out(synchroniser, commands, time_s)
    }

    fn carry_on(&mut self, synchroniser: &mut Synchroniser, time_s: f64) -> Orders {
        let commands = synchroniser.outstanding().into_iter().collect();
        self.carry_out(synchroniser, commands, time_s)
    }

    fn tick(&mut self, now: &mut Moment) {
        self.start_if_due(now);
        self.error = SensingError::NONE;
        if let Some(started_s) = self.started_s {
            now.since_s = now.time_s - started_s;
            for injection in &mut self.injections {
                injection.sensing_error(now, &mut self.error);
            }
        }
    }

    fn sensing_error(&self) -> SensingError {
        self.error
    }

    fn obstacles(&self) -> &[Region] {
        &self.obstacles
    }

    fn pace(&self, time_s: f64) -> f64 {
        self.since_s(time_s).map_or(1.0, |since_s| {
            self.injections.iter().map(|i| i.pace(since_s)).product()
        })
    }

    fn water(&self, time_s: f64) -> Option<Vector3<f64>> {
        let since_s = self.since_s(time_s)?;
        let sum: Vector3<f64> = self.injections.iter().map(|i| i.water(since_s)).sum();
        (sum.norm() > 0.0).then_some(sum)
    }

    fn wants_truth(&self) -> bool {
        self.started_s.is_some()
    }

    fn record_truth(&mut self, interval: SeaInterval) {
        self.intervals.push(interval);
    }

    fn scans(&mut self, now: &Moment, scan: Scan) -> Vec<Scan> {
        let mut scans = vec![scan];
        if self.started_s.is_some() {
            for injection in &mut self.injections {
                injection.scans(now, &mut scans);
            }
        }
        scans
    }

    fn events(&mut self, now: &Moment) -> Vec<Event> {
        let mut events = Vec::new();
        if self.started_s.is_some() {
            for injection in &mut self.injections {
                injection.events(now, &mut events);
            }
        }
        let due = |(due_s, _): &mut (f64, Event)| *due_s <= now.time_s + 1e-9;
        events.extend(self.late.extract_if(.., due).map(|(_, event)| event));
        events
    }

    fn is_down(&self, time_s: f64) -> bool {
        self.since_s(time_s)
            .is_some_and(|since_s| self.injections.iter().any(|i| i.is_down(since_s)))
    }

    fn restart(&mut self, synchroniser: &mut Synchroniser) -> Restart {
        let mut restarted = Restart::None;
        if self.started_s.is_some() {
            for injection in &mut self.injections {
                match injection.restart(synchroniser) {
                    Ok(Restart::None) => {}
                    Ok(this) => restarted = this,
                    Err(failure) => self.failures.push(failure),
                }
            }
        }
        if restarted != Restart::None {
            self.late.clear();
        }
        restarted
    }

    /// The witness checks the trajectory after the faults have changed it.
    fn follow(
        &mut self,
        trajectory: Arc<Trajectory>,
        synchroniser: &Synchroniser,
    ) -> Arc<Trajectory> {
        let mut trajectory = trajectory;
        if self.started_s.is_some() {
            for injection in &mut self.injections {
                trajectory = injection.tamper(trajectory);
            }
        }
        let failure = self
            .witness
            .check_follow(synchroniser.mission(), &trajectory);
        if let Some(failure) = failure {
            self.fail(failure);
        }
        trajectory
    }

    fn fail(&mut self, failure: String) {
        if self.failures.len() < Self::MAX_FAILURES {
            self.failures.push(failure);
        }
    }
}

/// The threaded driver's event for a call that overran its hard deadline.
fn overrun(command: &Command) -> Option<Event> {
    fn failed<T>() -> Result<T, PlanError> {
        Err(PlanError::Failed {
            planner: "asked".into(),
            reason: "it overran its hard deadline".into(),
        })
    }
    match command {
        Command::PlanRoute(request) => Some(Event::RoutePlanned {
            request: request.id,
            result: failed(),
            compute_s: deadline_s(command),
        }),
        Command::PlanPath(request) => Some(Event::PathPlanned {
            request: request.id,
            result: failed(),
            compute_s: deadline_s(command),
        }),
        _ => None,
    }
}

/// The injection of a fault in flight; `None` for a fault on loading and for one that acts through the
/// planners only.
fn injection_of(fault: Fault, intensity: Intensity, seed: Seed) -> Option<Box<dyn Injection>> {
    Some(match fault {
        Fault::Enclosed => Box::new(sea::Enclosed { intensity, seed }),
        Fault::Sudden => Box::new(sea::Sudden { intensity }),
        Fault::Current => Box::new(sea::Current::new(intensity, seed)),
        Fault::Ghosts => Box::new(sonar::Ghosts::new(intensity, seed)),
        Fault::Dropout => Box::new(sonar::Dropout { intensity }),
        Fault::StaleScans => Box::new(sonar::StaleScans::new(intensity)),
        Fault::BadEchoes => Box::new(sonar::BadEchoes::new(intensity, seed)),
        Fault::Storm => Box::new(sonar::Storm::new(intensity, seed)),
        Fault::LegTime => Box::new(motion::LegTime { intensity }),
        Fault::Navigation => Box::new(motion::Navigation::new(intensity, seed)),
        Fault::Energy => Box::new(motion::Energy::new(intensity)),
        Fault::Clock => Box::new(clock::Clock::new(intensity)),
        Fault::Overrun => Box::new(planners::Overrun::new(intensity)),
        #[cfg(feature = "serde")]
        Fault::Restart => Box::new(restart::Restart::new(intensity, seed)),
        Fault::Canary => Box::new(canary::Canary),
        _ => return None,
    })
}
