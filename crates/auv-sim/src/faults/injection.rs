//! Where a fault can act on a mission under way.

use crate::Scenario;
use crate::disturbance::{Moment, Restart, SensingError};
use auv_mission::{Command, Event, Synchroniser};
use auv_obstacles::{Region, Scan};
use auv_planning::Trajectory;
use auv_types::Vector3;
use std::sync::Arc;

/// A fault in flight. The default methods do nothing. Before the fault starts only
/// [`Injection::prepare`] is called.
pub(crate) trait Injection {
    /// Before the mission starts: changes the scenario so that the fault can happen.
    fn prepare(&mut self, _scenario: &mut Scenario) {}

    /// The fault starts. It may add true obstacles that are not charted.
    fn start(&mut self, _now: &Moment, _obstacles: &mut Vec<Region>) {}

    /// Changes the scans that reach the tracker.
    fn scans(&mut self, _now: &Moment, _scans: &mut Vec<Scan>) {}

    /// Adds to the errors of clock and fix.
    fn sensing_error(&mut self, _now: &Moment, _error: &mut SensingError) {}

    /// The speed the vehicle reaches as a share of the planned speed.
    fn pace(&self, _since_s: f64) -> f64 {
        1.0
    }

    /// A current added to the scenario's, m/s.
    fn water(&self, _since_s: f64) -> Vector3<f64> {
        Vector3::zeros()
    }

    /// Adds events for the synchroniser.
    fn events(&mut self, _now: &Moment, _events: &mut Vec<Event>) {}

    /// How long the planner takes to answer a command, mission time in seconds.
    fn late_by_s(&mut self, _command: &Command) -> f64 {
        0.0
    }

    /// Whether the vehicle's software is down.
    fn is_down(&self, _since_s: f64) -> bool {
        false
    }

    /// Restarts the software after a crash.
    ///
    /// # Errors
    /// What went wrong on the restart.
    fn restart(&mut self, _synchroniser: &mut Synchroniser) -> Result<Restart, String> {
        Ok(Restart::None)
    }

    /// The trajectory that reaches the vehicle in place of `trajectory`.
    fn tamper(&mut self, trajectory: Arc<Trajectory>) -> Arc<Trajectory> {
        trajectory
    }
}
