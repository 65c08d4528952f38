//! Faults of the planners: panics, late answers, invalid plans, no progress.

use super::injection::Injection;
use super::{Fault, Intensity};
use crate::Scenario;
use auv_graph::{NodeId, Route};
use auv_mission::Command;
use auv_obstacles::TimedPoint;
use auv_planning::baseline::GreedyRoute;
use auv_planning::{
    Budget, PathPlanner, PathProblem, PlanError, Planned, RoutePlanner, RouteProblem, Run, Stats,
    Trajectory,
};
use auv_types::rand::RngExt;
use auv_types::{Seed, Vector3};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Fault 18: answers arrive late. The driver gives up a call that overruns the hard deadline.
pub(super) struct Overrun {
    intensity: Intensity,
    asked: u32,
}

impl Overrun {
    pub(super) fn new(intensity: Intensity) -> Self {
        Self {
            intensity,
            asked: 0,
        }
    }
}

impl Injection for Overrun {
    /// Sets the planning time that slow planners need: paths depart from where the vehicle will be.
    fn prepare(&mut self, scenario: &mut Scenario) {
        scenario.settings.planning.planning_s = scenario.tick_s;
    }

    fn late_by_s(&mut self, command: &Command) -> f64 {
        let deadline_s = deadline_s(command);
        self.asked += 1;
        match (self.intensity.degree(), self.asked) {
            (1, _) => 5.0,
            (2, 1) => 2.0 * deadline_s,
            (3, 1..=5) => 10.0 * deadline_s,
            (4, _) => f64::INFINITY,
            _ => 0.0,
        }
    }
}

/// The hard deadline of a planner call, seconds, as in the threaded driver.
pub(super) fn deadline_s(command: &Command) -> f64 {
    if matches!(command, Command::PlanRoute(_)) {
        30.0
    } else {
        10.0
    }
}

/// The fault of a planner and when it acts.
pub(super) struct Trigger {
    pub(super) fault: Fault,
    pub(super) intensity: Intensity,
    pub(super) seed: Seed,
    pub(super) started: Arc<AtomicBool>,
}

/// A planner with a fault.
pub(super) struct Faulty<P> {
    inner: P,
    trigger: Arc<Trigger>,
    calls: AtomicU64,
}

impl<P> Faulty<P> {
    pub(super) fn new(inner: P, trigger: Arc<Trigger>) -> Self {
        Self {
            inner,
            trigger,
            calls: AtomicU64::new(0),
        }
    }

    /// The number of this call since the start of the fault, if the fault acts on it.
    fn acts(&self) -> Option<u64> {
        let Trigger {
            fault,
            intensity,
            seed,
            started,
        } = &*self.trigger;
        if !started.load(Ordering::Relaxed) {
            return None;
        }
        let call = self.calls.fetch_add(1, Ordering::Relaxed);
        let drawn = seed.split(call).stream(1).random::<f64>();
        let acts = match (fault, intensity.degree()) {
            (Fault::Panic, 1) => call < 1,
            (Fault::Panic, 2) => call < 2,
            (Fault::Panic, 3) => call.is_multiple_of(3),
            (Fault::Rubbish, 1) => drawn < 0.1,
            (Fault::Rubbish, 2) => drawn < 0.33,
            (Fault::Livelock, 1 | 2) => call.is_multiple_of(2),
            (Fault::Rubbish | Fault::Livelock, 3) => call < 20,
            _ => true,
        };
        acts.then_some(call)
    }

    /// The fault and the call's number, if the fault acts on this call. Raises the panic of fault 17.
    fn strike(&self) -> Option<(Fault, u64)> {
        let call = self.acts()?;
        if self.trigger.fault == Fault::Panic {
            // Unwinds like a panic, but without a message on stderr.
            std::panic::resume_unwind(Box::new("an injected panic"));
        }
        Some((self.trigger.fault, call))
    }

    fn draw(&self, call: u64, kinds: u32) -> u32 {
        let mut random = self.trigger.seed.split(call).stream(2);
        random.random_range(0..kinds)
    }

    /// A run with the same budget and another seed.
    fn another<'a>(&self, run: &Run<'_>) -> Run<'a> {
        let budget = run
            .evaluations_left()
            .map_or(Budget::to_the_cap(), Budget::evaluations);
        Run::new(run.seed().split(77), budget)
    }
}

fn refused<T>(mut planned: Planned<T>) -> Planned<T> {
    planned.violation = 1.0;
    planned
}

impl<P: RoutePlanner> RoutePlanner for Faulty<P> {
    fn name(&self) -> &str {
        "faulty"
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        let struck = self.strike();
        let planned = match struck {
            Some((Fault::Livelock, _)) if self.trigger.intensity.degree() == 1 => {
                return GreedyRoute.plan_route(run, problem);
            }
            _ => self.inner.plan_route(run, problem)?,
        };
        match struck {
            Some((Fault::Livelock, _)) => Ok(refused(planned)),
            Some((Fault::Rubbish, call)) => wrong_route(planned, problem, self.draw(call, 8)),
            _ => Ok(planned),
        }
    }
}

impl<P: PathPlanner> PathPlanner for Faulty<P> {
    fn name(&self) -> &str {
        "faulty"
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        let struck = self.strike();
        let planned = match struck {
            Some((Fault::Livelock, _)) if self.trigger.intensity.degree() == 1 => {
                return self.inner.plan_path(&mut self.another(run), problem);
            }
            _ => self.inner.plan_path(run, problem)?,
        };
        match struck {
            Some((Fault::Livelock, _)) => Ok(refused(planned)),
            Some((Fault::Rubbish, call)) => wrong_path(planned, problem, self.draw(call, 9)),
            _ => Ok(planned),
        }
    }
}

fn no_plan<T>() -> Result<Planned<T>, PlanError> {
    Err(PlanError::Failed {
        planner: "faulty".into(),
        reason: "an injected fault".into(),
    })
}

/// A route that is invalid in one of eight ways and claimed to be feasible.
fn wrong_route(
    planned: Planned<Route>,
    problem: &RouteProblem<'_>,
    kind: u32,
) -> Result<Planned<Route>, PlanError> {
    let mut nodes = planned.best.nodes().to_vec();
    let mut cost = planned.cost;
    match kind {
        0 => nodes.clear(),
        1 => drop(nodes.remove(0)),
        2 => drop(nodes.pop()),
        3 => nodes.insert(0, problem.start),
        4 => nodes.insert(1, NodeId(1_000_000)),
        // All nodes, without regard to edges and time.
        5 => {
            nodes = (0..problem.network.num_nodes() as u32)
                .map(NodeId)
                .collect()
        }
        6 => cost = f64::NAN,
        _ => return no_plan(),
    }
    Ok(Planned::new(Route::new(nodes), cost, 0.0, planned.stats))
}

/// A path that is invalid in one of nine ways and claimed to be feasible.
fn wrong_path(
    planned: Planned<Trajectory>,
    problem: &PathProblem<'_>,
    kind: u32,
) -> Result<Planned<Trajectory>, PlanError> {
    let (mut cost, mut violation) = (planned.cost, 0.0);
    let start = planned.best.start();
    let moved = |change: &dyn Fn(&TimedPoint) -> TimedPoint| {
        Trajectory::new(planned.best.points().iter().map(change).collect())
    };
    let half = |t_s: f64| start.time_s + 0.5 * (t_s - start.time_s);
    let path = match kind {
        0 => moved(&|p| TimedPoint::new(p.position + Vector3::new(50.0, 0.0, 0.0), p.time_s)),
        1 => Ok(planned.best.until(half(planned.best.end().time_s))),
        2 => {
            // The straight line, through obstacles.
            let end_s =
                start.time_s + (problem.target - problem.start).norm() / problem.vehicle.speed_mps;
            Trajectory::new(vec![start, TimedPoint::new(problem.target, end_s)])
        }
        3 => moved(&|p| TimedPoint::new(p.position, half(p.time_s))),
        4 => moved(&|p| TimedPoint::new(p.position, p.time_s + 100.0)),
        5 => Ok(Trajectory::hover(start, 10.0)),
        6 => {
            cost = f64::NAN;
            Ok(planned.best)
        }
        7 => {
            violation = f64::NAN;
            Ok(planned.best)
        }
        _ => return no_plan(),
    };
    match path {
        Ok(path) => Ok(Planned::new(path, cost, violation, Stats::default())),
        Err(_) => no_plan(),
    }
}
