//! The deterministic driver: planners are called in turn, and mission time stands still meanwhile.

use super::planners::{Asked, Planners};
use crate::{Command, Event, Observation, Outcome, Synchroniser};
use auv_planning::{PathPlanner, RoutePlanner, Trajectory};
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Calls the planners as soon as they are asked and feeds their answers back, until no question is open.
/// Panics of planners are caught (see [`crate::driver`]).
pub struct Stepped<'a> {
    planners: Planners<&'a dyn RoutePlanner, &'a dyn PathPlanner>,
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
            self.planners.route.name(),
            self.planners.path.name()
        )
    }
}

impl<'a> Stepped<'a> {
    /// A driver with these planners.
    #[must_use]
    pub fn new(route_planner: &'a dyn RoutePlanner, path_planner: &'a dyn PathPlanner) -> Self {
        Self {
            planners: Planners::new(route_planner, path_planner),
            stopwatch: None,
        }
    }

    /// Measures computing times for the tables with the caller's clock, which gives seconds.
    #[must_use]
    pub fn with_stopwatch(mut self, seconds: &'a dyn Fn() -> f64) -> Self {
        self.stopwatch = Some(seconds);
        self
    }

    /// Feeds an observation and everything that follows from it.
    pub fn tick(&self, synchroniser: &mut Synchroniser, observation: Observation) -> Orders {
        self.tell(synchroniser, Event::Tick(observation))
    }

    /// Feeds any event and everything that follows from it.
    pub fn tell(&self, synchroniser: &mut Synchroniser, event: Event) -> Orders {
        let commands = synchroniser.step(event);
        self.carry_out(synchroniser, commands)
    }

    /// The planners' answer to a command that is a question, for use in another driver. Panics are
    /// caught.
    #[must_use]
    pub fn answer(&self, command: &Command) -> Option<Event> {
        let clock_s = || self.stopwatch.map_or(0.0, |seconds| seconds());
        self.planners
            .answer(command, Asked::Planner, &AtomicBool::new(false), &clock_s)
    }

    /// Answers the question that a resumed synchroniser still waits for.
    pub fn carry_on(&self, synchroniser: &mut Synchroniser) -> Orders {
        let commands = synchroniser.outstanding().into_iter().collect();
        self.carry_out(synchroniser, commands)
    }

    fn carry_out(&self, synchroniser: &mut Synchroniser, mut commands: Vec<Command>) -> Orders {
        let mut orders = Orders::default();
        while !commands.is_empty() {
            let mut next = Vec::new();
            for command in commands {
                match self.answer(&command) {
                    Some(answer) => next.extend(synchroniser.step(answer)),
                    None => orders.take(command),
                }
            }
            commands = next;
        }
        orders
    }
}

impl Orders {
    /// Adds a command to the vehicle.
    pub(super) fn take(&mut self, command: Command) {
        match command {
            Command::Follow(trajectory) => self.follow = Some(trajectory),
            Command::Finished(outcome) => self.finished = Some(outcome),
            Command::PlanRoute(_) | Command::PlanPath(_) => {}
        }
    }
}
