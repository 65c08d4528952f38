//! What a simulated mission reports while it is flown.

use crate::{Scenario, Summary};
use auv_mission::{PathCall, RouteCall};
use auv_obstacles::{Region, TimedPoint};
use auv_planning::Trajectory;

/// An event of a simulated mission.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Entry<'a> {
    /// The mission starts.
    Started(&'a Scenario),
    /// A route call was answered.
    Route(&'a RouteCall),
    /// The vehicle starts to follow a trajectory, at a mission time in seconds.
    Follow(f64, &'a Trajectory),
    /// A leg is over.
    Leg(&'a PathCall),
    /// The true track of one tick, with the truth over the same time and the prediction at its end.
    Flown {
        /// The true track, its start included.
        track: &'a [TimedPoint],
        /// The true obstacles over the same time.
        truth: &'a [Region],
        /// The predicted regions at its end, clearances included.
        predicted: &'a [Region],
    },
    /// The mission is over.
    Ended(&'a Summary),
}

/// Records what happens in a mission.
pub trait Recorder {
    /// Records one event.
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
