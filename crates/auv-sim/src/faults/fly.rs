//! Flying a mission with faults.

use super::injection::{self, Frame, Injection, Moment};
use super::planners::{Faulty, Trigger, deadline_s};
use super::witness::{Watched, Witness};
use super::{Class, Fault, Intensity, Trial, input};
use crate::oracle::{Piece, Sea};
use crate::simulate::fly;
use crate::{Recorder, Scenario};
use auv_mission::driver::Stepped;
use auv_mission::{Command, Event, Synchroniser};
use auv_obstacles::{ObstacleId, Region, Scan, Tracker};
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{PathPlanner, PlanError, RoutePlanner, Trajectory};
use auv_types::rand::RngExt;
use auv_types::{Seed, Vector3, Violations};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Which faults happen to a mission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultPlan {
    /// The faults. Those in flight begin together; one met on loading stands alone.
    pub faults: Vec<Fault>,
    /// How severe each is.
    pub intensity: Intensity,
    /// Seed of everything random about them.
    pub seed: Seed,
}

impl FaultPlan {
    /// The most severe outcome that is in order: the worse of what the faults allow.
    #[must_use]
    pub fn expected(&self) -> Class {
        let classes = self
            .faults
            .iter()
            .map(|fault| fault.expected(self.intensity));
        classes.max().unwrap_or(Class::Unchanged)
    }
}

/// Flies a scenario with faults and judges the run. Nothing is passed on but the judgement: a panic
/// is a failure of the run.
///
/// # Determinism
/// Depends on the arguments alone. Without faults the flight is that of [`crate::simulate`].
///
/// # Errors
/// Everything that keeps the mission from starting without faults.
pub fn fly_with_faults(
    scenario: &Scenario,
    route_planner: &dyn RoutePlanner,
    path_planner: &dyn PathPlanner,
    plan: &FaultPlan,
    recorder: &mut dyn Recorder,
) -> Result<Trial, Violations> {
    scenario.validate().into_result()?;
    let run = AssertUnwindSafe(|| match plan.faults.iter().find(|f| !f.is_in_flight()) {
        Some(&fault) => Ok(input::run(fault, plan.intensity, scenario, plan.seed)),
        None => in_flight(scenario, route_planner, path_planner, plan, recorder),
    });
    catch_unwind(run).unwrap_or_else(|_| {
        let failure = "a panic came through the library".to_owned();
        Ok(Trial::loaded(Class::FellBack, vec![failure]))
    })
}

fn in_flight(
    scenario: &Scenario,
    route_planner: &dyn RoutePlanner,
    path_planner: &dyn PathPlanner,
    plan: &FaultPlan,
    recorder: &mut dyn Recorder,
) -> Result<Trial, Violations> {
    let mut scenario = scenario.clone();
    let witness = Witness::default();
    let mut faults = Faults::planned(plan, &scenario, &witness);
    for injection in &mut faults.injections {
        injection.prepare(&mut scenario);
    }
    let mut routes: Box<dyn RoutePlanner + '_> = Box::new(route_planner);
    let mut paths: Box<dyn PathPlanner + '_> = Box::new(path_planner);
    for (k, &fault) in plan.faults.iter().enumerate() {
        if matches!(fault, Fault::Panic | Fault::Rubbish | Fault::Livelock) {
            let trigger = Arc::new(Trigger {
                fault,
                intensity: plan.intensity,
                seed: plan.seed.split(k as u64),
                begun: Arc::clone(&faults.begun),
            });
            routes = Box::new(Faulty::new(routes, Arc::clone(&trigger)));
            paths = Box::new(Faulty::new(paths, trigger));
        }
    }
    let watched = Watched {
        inner: paths,
        witness: &witness,
    };
    let driver = Stepped::new(&routes, &watched);
    let summary = fly(&scenario, &driver, &mut faults, recorder)?;
    let mut trial = Trial::flown(summary, faults.begun_s, plan.expected(), faults.failures);
    trial.ask_oracle(&Sea {
        pieces: faults.pieces,
        bounds: scenario.mission.bounds,
    });
    Ok(trial)
}

/// The faults of a flight under way.
pub(crate) struct Faults<'a> {
    injections: Vec<Box<dyn Injection>>,
    witness: Option<&'a Witness>,
    not_before_s: f64,
    begun: Arc<AtomicBool>,
    begun_s: Option<f64>,
    obstacles: Vec<Region>,
    frame: Frame,
    /// Answers that are not there yet, with when they will be.
    late: Vec<(f64, Event)>,
    /// Planners that never answered: of routes, of paths.
    hanging: [u32; 2],
    failures: Vec<String>,
    /// The truth since the faults began.
    pieces: Vec<Piece>,
}

impl fmt::Debug for Faults<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Faults")
            .field("begun_s", &self.begun_s)
            .field("failures", &self.failures)
            .finish_non_exhaustive()
    }
}

impl<'a> Faults<'a> {
    /// No faults at all.
    pub(crate) fn none() -> Self {
        Self {
            injections: Vec::new(),
            witness: None,
            not_before_s: f64::INFINITY,
            begun: Arc::default(),
            begun_s: None,
            obstacles: Vec::new(),
            frame: Frame::TRUE,
            late: Vec::new(),
            hanging: [0; 2],
            failures: Vec::new(),
            pieces: Vec::new(),
        }
    }

    fn planned(plan: &FaultPlan, scenario: &Scenario, witness: &'a Witness) -> Self {
        let injection = |(k, &fault): (usize, &Fault)| {
            injection::of(fault, plan.intensity, plan.seed.split(k as u64))
        };
        // Early enough to have legs left to fly, late enough to be under way.
        let share = plan.seed.split(99).stream(0).random_range(0.05..0.5);
        Self {
            injections: plan
                .faults
                .iter()
                .enumerate()
                .filter_map(injection)
                .collect(),
            witness: Some(witness),
            not_before_s: share * scenario.mission.budget_s,
            ..Self::none()
        }
    }

    /// Begins the faults at the first look in the middle of a leg, with way to go.
    pub(crate) fn look(&mut self, now: &mut Moment) {
        let under_way = now.velocity.norm() > 0.5 && (now.target - now.position).norm() > 300.0;
        if self.begun_s.is_none() && now.time_s >= self.not_before_s && under_way {
            self.begun_s = Some(now.time_s);
            self.begun.store(true, Ordering::Relaxed);
            for injection in &mut self.injections {
                injection.begin(now, &mut self.obstacles);
            }
            for (k, region) in self.obstacles.iter_mut().enumerate() {
                region.obstacle = ObstacleId(u32::MAX - k as u32);
            }
        }
        self.frame = Frame::TRUE;
        if let Some(begun_s) = self.begun_s {
            now.since_s = now.time_s - begun_s;
            for injection in &mut self.injections {
                injection.frame(now, &mut self.frame);
            }
        }
    }

    /// How what the vehicle believes differs from what is.
    pub(crate) fn frame(&self) -> Frame {
        self.frame
    }

    /// True obstacles beyond those of the scenario.
    pub(crate) fn obstacles(&self) -> &[Region] {
        &self.obstacles
    }

    fn since_s(&self, time_s: f64) -> Option<f64> {
        self.begun_s.map(|begun_s| time_s - begun_s)
    }

    /// The way the vehicle makes, as a share of what it should.
    pub(crate) fn pace(&self, time_s: f64) -> f64 {
        self.since_s(time_s).map_or(1.0, |since_s| {
            self.injections.iter().map(|i| i.pace(since_s)).product()
        })
    }

    /// A current of its own, m/s; `None`: none.
    pub(crate) fn water(&self, time_s: f64) -> Option<Vector3<f64>> {
        let since_s = self.since_s(time_s)?;
        let sum: Vector3<f64> = self.injections.iter().map(|i| i.water(since_s)).sum();
        (sum.norm() > 0.0).then_some(sum)
    }

    /// Takes down the truth of a piece of time.
    pub(crate) fn keep(&mut self, piece: impl FnOnce() -> Piece) {
        if self.begun_s.is_some() {
            self.pieces.push(piece());
        }
    }

    /// What reaches the tracker of a scan.
    pub(crate) fn scans(&mut self, now: &Moment, scan: Scan) -> Vec<Scan> {
        let mut scans = vec![scan];
        if self.begun_s.is_some() {
            for injection in &mut self.injections {
                injection.scans(now, &mut scans);
            }
        }
        scans
    }

    /// What the vehicle is told besides, late answers of planners included.
    pub(crate) fn events(&mut self, now: &Moment) -> Vec<Event> {
        let mut events = Vec::new();
        if self.begun_s.is_some() {
            for injection in &mut self.injections {
                injection.events(now, &mut events);
            }
        }
        let due = |(due_s, _): &mut (f64, Event)| *due_s <= now.time_s + 1e-9;
        events.extend(self.late.extract_if(.., due).map(|(_, event)| event));
        events
    }

    /// Whether the software is not running.
    pub(crate) fn is_down(&self, time_s: f64) -> bool {
        self.since_s(time_s)
            .is_some_and(|since_s| self.injections.iter().any(|i| i.is_down(since_s)))
    }

    /// Starts the software again, if it crashed; whether it did.
    pub(crate) fn restart(
        &mut self,
        synchroniser: &mut Synchroniser,
        tracker: &mut Tracker,
    ) -> bool {
        let mut restarted = false;
        if self.begun_s.is_some() {
            for injection in &mut self.injections {
                match injection.restart(synchroniser, tracker) {
                    Ok(this) => restarted |= this,
                    Err(failure) => self.failures.push(failure),
                }
            }
        }
        if restarted {
            self.late.clear();
        }
        restarted
    }

    /// The answer to a question, unless it comes later.
    pub(crate) fn answer(
        &mut self,
        driver: &Stepped<'_>,
        question: &Command,
        time_s: f64,
    ) -> Option<Event> {
        if self.begun_s.is_none() || matches!(question, Command::Follow(_) | Command::Finished(_)) {
            return driver.answer(question);
        }
        let kind = usize::from(matches!(question, Command::PlanPath(_)));
        if self.hanging[kind] >= 2 {
            return Stepped::new(&GreedyRoute, &StraightPath).answer(question);
        }
        let late_by = self.injections.iter_mut().map(|i| i.late_by_s(question));
        let late_by_s = late_by.fold(0.0, f64::max);
        let deadline_s = deadline_s(question);
        if late_by_s <= 0.0 {
            return driver.answer(question);
        }
        let event = if late_by_s > deadline_s {
            self.hanging[kind] += u32::from(late_by_s.is_infinite());
            given_up(question)
        } else {
            driver.answer(question)
        };
        let due_s = time_s + late_by_s.min(deadline_s);
        self.late.extend(event.map(|event| (due_s, event)));
        None
    }

    /// A trajectory on its way to the vehicle, and a look at it.
    pub(crate) fn follow(
        &mut self,
        way: Arc<Trajectory>,
        synchroniser: &Synchroniser,
    ) -> Arc<Trajectory> {
        let mut way = way;
        if self.begun_s.is_some() {
            for injection in &mut self.injections {
                way = injection.tamper(way);
            }
        }
        if let Some(witness) = self.witness {
            let failure = witness.check_follow(synchroniser.mission(), &way);
            self.fail(failure);
        }
        way
    }

    /// Takes down what should not have happened.
    pub(crate) fn fail(&mut self, failure: Option<String>) {
        if self.failures.len() < 10 {
            self.failures.extend(failure);
        }
    }
}

/// What the threaded driver says of a call that overran its hard deadline.
fn given_up(question: &Command) -> Option<Event> {
    fn failed<T>() -> Result<T, PlanError> {
        Err(PlanError::Failed {
            planner: "asked".into(),
            reason: "it overran its hard deadline".into(),
        })
    }
    match question {
        Command::PlanRoute(request) => Some(Event::RoutePlanned {
            request: request.id,
            result: failed(),
            compute_s: deadline_s(question),
        }),
        Command::PlanPath(request) => Some(Event::PathPlanned {
            request: request.id,
            result: failed(),
            compute_s: deadline_s(question),
        }),
        _ => None,
    }
}
