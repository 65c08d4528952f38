//! What every driver does: it feeds events to a synchroniser, and gives orders to the vehicle.

use crate::{Command, Event, Observation, Outcome, Synchroniser};
use auv_planning::Trajectory;
use std::sync::Arc;

/// Calls the planners that a synchroniser asks for.
pub trait Driver {
    /// Feeds an event, and the answers that are there.
    fn tell(&mut self, synchroniser: &mut Synchroniser, event: Event) -> Orders;

    /// Asks the question that a resumed synchroniser still waits for.
    fn carry_on(&mut self, synchroniser: &mut Synchroniser) -> Orders;

    /// Feeds an observation: the last event of a tick.
    fn tick(&mut self, synchroniser: &mut Synchroniser, observation: Observation) -> Orders {
        self.tell(synchroniser, Event::Tick(observation))
    }
}

impl<D: Driver + ?Sized> Driver for &mut D {
    fn tell(&mut self, synchroniser: &mut Synchroniser, event: Event) -> Orders {
        (**self).tell(synchroniser, event)
    }

    fn carry_on(&mut self, synchroniser: &mut Synchroniser) -> Orders {
        (**self).carry_on(synchroniser)
    }

    fn tick(&mut self, synchroniser: &mut Synchroniser, observation: Observation) -> Orders {
        (**self).tick(synchroniser, observation)
    }
}

/// What the vehicle is to do after a tick.
#[derive(Clone, Debug, Default)]
pub struct Orders {
    /// A new trajectory to follow, if it changed.
    pub follow: Option<Arc<Trajectory>>,
    /// How the mission ended, if it did.
    pub finished: Option<Outcome>,
}

impl Orders {
    /// Adds a command to the vehicle. Questions are no orders: nothing changes.
    pub fn take(&mut self, command: Command) {
        match command {
            Command::Follow(trajectory) => self.follow = Some(trajectory),
            Command::Finished(outcome) => self.finished = Some(outcome),
            Command::PlanRoute(_) | Command::PlanPath(_) => {}
        }
    }

    /// Adds later orders.
    pub fn then(&mut self, later: Self) {
        self.follow = later.follow.or(self.follow.take());
        self.finished = later.finished.or(self.finished);
    }
}
