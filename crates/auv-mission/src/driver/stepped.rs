//! The deterministic driver: planners are called in turn, and mission time stands still meanwhile.

use super::orders::{Driver, Orders};
use super::planners::{Asked, Planners};
use crate::{Command, Event, Observation, Synchroniser};
use auv_planning::{PathPlanner, RoutePlanner};
use std::fmt;
use std::sync::atomic::AtomicBool;

/// Number of commands in one tick after which the tick counts as endless: what is open then is left so.
const MOST_COMMANDS: usize = 1_000;

/// Calls the planners as soon as they are asked and feeds their answers back, until no question is open.
/// Panics of planners are caught (see [`crate::driver`]).
pub struct Stepped<'a> {
    planners: Planners<&'a dyn RoutePlanner, &'a dyn PathPlanner>,
    stopwatch: Option<&'a dyn Fn() -> f64>,
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
        let mut carried_out = 0;
        while !commands.is_empty() && carried_out <= MOST_COMMANDS {
            carried_out += commands.len();
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

impl Driver for &Stepped<'_> {
    fn tell(&mut self, synchroniser: &mut Synchroniser, event: Event) -> Orders {
        Stepped::tell(self, synchroniser, event)
    }

    fn carry_on(&mut self, synchroniser: &mut Synchroniser) -> Orders {
        Stepped::carry_on(self, synchroniser)
    }
}

impl Driver for Stepped<'_> {
    fn tell(&mut self, synchroniser: &mut Synchroniser, event: Event) -> Orders {
        Stepped::tell(self, synchroniser, event)
    }

    fn carry_on(&mut self, synchroniser: &mut Synchroniser) -> Orders {
        Stepped::carry_on(self, synchroniser)
    }
}
