//! The deterministic driver: planners are called in turn, in no mission time.

use crate::{Command, Event, Observation, Outcome, Synchroniser};
use auv_planning::{PathPlanner, RoutePlanner, Run, Trajectory};
use std::fmt;
use std::sync::Arc;

/// Calls the planners as soon as they are asked for and hands their answers back, until only the
/// vehicle has something to do.
#[derive(Clone, Copy)]
pub struct Stepped<'a> {
    route_planner: &'a dyn RoutePlanner,
    path_planner: &'a dyn PathPlanner,
    stopwatch: Option<&'a dyn Fn() -> f64>,
}

/// What the vehicle is to do after a tick.
#[derive(Clone, Debug, Default)]
pub struct Orders {
    /// A new trajectory to follow, if it changed.
    pub follow: Option<Arc<Trajectory>>,
    /// How the mission ended, if it did.
    pub finished: Option<Outcome>,
}

impl fmt::Debug for Stepped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Stepped({}, {})",
            self.route_planner.name(),
            self.path_planner.name()
        )
    }
}

impl<'a> Stepped<'a> {
    /// A driver with these planners.
    #[must_use]
    pub fn new(route_planner: &'a dyn RoutePlanner, path_planner: &'a dyn PathPlanner) -> Self {
        Self {
            route_planner,
            path_planner,
            stopwatch: None,
        }
    }

    /// Measures computing times for the tables with the caller's clock, which gives seconds.
    #[must_use]
    pub fn with_stopwatch(mut self, seconds: &'a dyn Fn() -> f64) -> Self {
        self.stopwatch = Some(seconds);
        self
    }

    fn timed<R>(&self, call: impl FnOnce() -> R) -> (R, f64) {
        let read = || self.stopwatch.map_or(0.0, |seconds| seconds());
        let begin_s = read();
        let result = call();
        (result, read() - begin_s)
    }

    /// Feeds an observation and everything that follows from it.
    pub fn tick(&self, synchroniser: &mut Synchroniser, observation: Observation) -> Orders {
        let mut orders = Orders::default();
        let mut commands = synchroniser.step(Event::Tick(observation));
        while !commands.is_empty() {
            let mut answers = Vec::new();
            for command in commands {
                match command {
                    Command::Follow(trajectory) => orders.follow = Some(trajectory),
                    Command::Finished(outcome) => orders.finished = Some(outcome),
                    Command::PlanRoute(request) => {
                        let mut run = Run::new(request.seed, request.budget);
                        let (result, compute_s) = self
                            .timed(|| self.route_planner.plan_route(&mut run, &request.problem()));
                        answers.push(Event::RoutePlanned {
                            request: request.id,
                            result,
                            compute_s,
                        });
                    }
                    Command::PlanPath(request) => {
                        let mut run = Run::new(request.seed, request.budget);
                        let (result, compute_s) = self
                            .timed(|| self.path_planner.plan_path(&mut run, &request.problem()));
                        answers.push(Event::PathPlanned {
                            request: request.id,
                            result,
                            compute_s,
                        });
                    }
                }
            }
            commands = answers
                .into_iter()
                .flat_map(|answer| synchroniser.step(answer))
                .collect();
        }
        orders
    }
}
