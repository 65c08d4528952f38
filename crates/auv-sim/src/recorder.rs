//! What a simulated mission tells while it is flown.

use crate::{Scenario, Summary};
use auv_mission::{PathCall, RouteCall};
use auv_obstacles::{Region, TimedPoint};
use auv_planning::Trajectory;

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
