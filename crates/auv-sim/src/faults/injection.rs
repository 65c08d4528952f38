//! Where a fault can act on a mission in flight.

use super::{Fault, Intensity, clock, motion, planners, sea, sonar};
use crate::Scenario;
use auv_mission::{Command, Event, Synchroniser};
use auv_obstacles::{Region, Scan, Tracker};
use auv_planning::Trajectory;
use auv_types::{Point3, Seed, Vector3};
use std::sync::Arc;

/// The state of a mission when a fault acts, in true time and place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    /// Mission time, seconds.
    pub(crate) time_s: f64,
    /// Since the fault began, seconds.
    pub(crate) since_s: f64,
    pub(crate) position: Point3<f64>,
    pub(crate) velocity: Vector3<f64>,
    /// Where the leg leads.
    pub(crate) target: Point3<f64>,
}

impl Moment {
    /// The unit vector towards the leg's target.
    pub(crate) fn ahead(&self) -> Vector3<f64> {
        let way = self.target - self.position;
        way.try_normalize(1e-6).unwrap_or_else(Vector3::x)
    }
}

/// How what the vehicle believes differs from what is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    /// Clock minus true time, seconds.
    pub(crate) clock_s: f64,
    /// What the time stamp of one observation is off by beyond that, seconds.
    pub(crate) stamp_s: f64,
    /// Fix minus true place, metres.
    pub(crate) shift: Vector3<f64>,
    /// There is no fix at all.
    pub(crate) lost: bool,
}

impl Frame {
    pub(crate) const TRUE: Self = Self {
        clock_s: 0.0,
        stamp_s: 0.0,
        shift: Vector3::new(0.0, 0.0, 0.0),
        lost: false,
    };
}

/// A fault in flight. Everything here does nothing unless the fault says otherwise, and nothing is
/// called before the fault begins but [`Injection::prepare`].
pub(crate) trait Injection {
    /// Before the mission starts: equips it so that the fault can happen.
    fn prepare(&mut self, _scenario: &mut Scenario) {}

    /// The fault begins: obstacles nobody knows of may appear.
    fn begin(&mut self, _now: &Moment, _obstacles: &mut Vec<Region>) {}

    /// The sonar's scans on their way to the tracker.
    fn scans(&mut self, _now: &Moment, _scans: &mut Vec<Scan>) {}

    /// What clock and fix are off by.
    fn frame(&mut self, _now: &Moment, _frame: &mut Frame) {}

    /// The way the vehicle makes, as a share of what it should.
    fn pace(&self, _since_s: f64) -> f64 {
        1.0
    }

    /// A current of its own, m/s.
    fn water(&self, _since_s: f64) -> Vector3<f64> {
        Vector3::zeros()
    }

    /// What else the vehicle is told.
    fn events(&mut self, _now: &Moment, _events: &mut Vec<Event>) {}

    /// How long a planner takes over its answer, mission time in seconds.
    fn late_by_s(&mut self, _question: &Command) -> f64 {
        0.0
    }

    /// Whether the software is not running.
    fn is_down(&self, _since_s: f64) -> bool {
        false
    }

    /// The software starts again: whether it did.
    ///
    /// # Errors
    /// What should not have happened then.
    fn restart(
        &mut self,
        _synchroniser: &mut Synchroniser,
        _tracker: &mut Tracker,
    ) -> Result<bool, String> {
        Ok(false)
    }

    /// What becomes of a trajectory on its way to the vehicle.
    fn tamper(&mut self, trajectory: Arc<Trajectory>) -> Arc<Trajectory> {
        trajectory
    }
}

/// The injection of a fault in flight; `None` for one that is met on loading or acts by planners
/// alone.
pub(super) fn of(fault: Fault, intensity: Intensity, seed: Seed) -> Option<Box<dyn Injection>> {
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
        Fault::Restart => Box::new(super::restart::Restart::new(intensity, seed)),
        Fault::Canary => Box::new(super::canary::Canary),
        _ => return None,
    })
}
