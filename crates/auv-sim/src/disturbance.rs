//! The points of the closed loop where a disturbance can act on a mission under way.

use crate::oracle::SeaInterval;
use auv_mission::driver::{Driver, Orders};
use auv_mission::{Event, Synchroniser};
use auv_obstacles::{Region, Scan};
use auv_planning::Trajectory;
use auv_types::{Point3, Vector3};
use std::sync::Arc;

/// The true state of the vehicle at a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    /// Mission time, seconds.
    pub(crate) time_s: f64,
    /// Time since the disturbance started, seconds.
    pub(crate) since_s: f64,
    pub(crate) position: Point3<f64>,
    pub(crate) velocity: Vector3<f64>,
    /// The end of the current leg.
    pub(crate) target: Point3<f64>,
}

impl Moment {
    /// The unit vector towards the leg's target.
    pub(crate) fn ahead(&self) -> Vector3<f64> {
        let offset = self.target - self.position;
        offset.try_normalize(1e-6).unwrap_or_else(Vector3::x)
    }
}

/// The errors of the vehicle's clock and position fix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SensingError {
    /// Clock minus true time, seconds.
    pub(crate) clock_s: f64,
    /// Additional error of the time stamp of this tick's observation, seconds.
    pub(crate) stamp_s: f64,
    /// Fix minus true position, metres.
    pub(crate) shift: Vector3<f64>,
    /// Whether there is no fix.
    pub(crate) lost: bool,
}

impl SensingError {
    pub(crate) const NONE: Self = Self {
        clock_s: 0.0,
        stamp_s: 0.0,
        shift: Vector3::new(0.0, 0.0, 0.0),
        lost: false,
    };
}

/// What a restart of the software left of what it knew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Restart {
    /// There was none.
    None,
    /// The synchroniser's checkpoint and the tracker.
    #[cfg(feature = "serde")]
    WithTracks,
    /// The synchroniser's checkpoint alone.
    WithoutTracks,
}

/// Who answers the synchroniser, and what disturbs a simulated mission. The default methods disturb nothing.
pub(crate) trait Disturbance {
    /// Feeds an event to the synchroniser, and what follows from it.
    fn tell(&mut self, synchroniser: &mut Synchroniser, event: Event, time_s: f64) -> Orders;

    /// Asks the question that a resumed synchroniser still waits for.
    fn carry_on(&mut self, synchroniser: &mut Synchroniser, time_s: f64) -> Orders;

    /// A tick starts. Sets `now.since_s` once the disturbance has started.
    fn tick(&mut self, _now: &mut Moment) {}

    /// Whether the vehicle's software is down at this time.
    fn is_down(&self, _time_s: f64) -> bool {
        false
    }

    /// Restarts the software after a crash.
    fn restart(&mut self, _synchroniser: &mut Synchroniser) -> Restart {
        Restart::None
    }

    /// The errors of clock and fix at this tick.
    fn sensing_error(&self) -> SensingError {
        SensingError::NONE
    }

    /// True obstacles in addition to those of the scenario.
    fn obstacles(&self) -> &[Region] {
        &[]
    }

    /// The scans that reach the tracker in place of `scan`.
    fn scans(&mut self, _now: &Moment, scan: Scan) -> Vec<Scan> {
        vec![scan]
    }

    /// Events that reach the synchroniser before the tick's observation.
    fn events(&mut self, _now: &Moment) -> Vec<Event> {
        Vec::new()
    }

    /// The trajectory that reaches the vehicle in place of `trajectory`.
    fn follow(
        &mut self,
        trajectory: Arc<Trajectory>,
        _synchroniser: &Synchroniser,
    ) -> Arc<Trajectory> {
        trajectory
    }

    /// A current added to the scenario's, m/s.
    fn water(&self, _time_s: f64) -> Option<Vector3<f64>> {
        None
    }

    /// The speed the vehicle reaches as a share of the planned speed.
    fn pace(&self, _time_s: f64) -> f64 {
        1.0
    }

    /// Whether the truth is to be recorded for the oracle.
    fn wants_truth(&self) -> bool {
        false
    }

    /// Records the truth of an interval.
    fn record_truth(&mut self, _interval: SeaInterval) {}

    /// Records something that must never happen.
    fn fail(&mut self, _failure: String) {}
}

/// A driver alone disturbs nothing.
pub(crate) struct Undisturbed<'a>(pub(crate) &'a mut dyn Driver);

impl Disturbance for Undisturbed<'_> {
    fn tell(&mut self, synchroniser: &mut Synchroniser, event: Event, _time_s: f64) -> Orders {
        match event {
            Event::Tick(observation) => self.0.tick(synchroniser, observation),
            event => self.0.tell(synchroniser, event),
        }
    }

    fn carry_on(&mut self, synchroniser: &mut Synchroniser, _time_s: f64) -> Orders {
        self.0.carry_on(synchroniser)
    }
}
