//! Flies a scenario to its end.

use crate::disturbance::{Disturbance, Undisturbed};
use crate::{Recorder, Scenario, Simulation, Summary};
use auv_mission::driver::Driver;
use auv_types::Violations;

/// Flies a scenario to its end. [`Simulation`] flies it step by step.
///
/// # Determinism
/// The result depends on the scenario and the answers of the driver only: with [`auv_mission::driver::Stepped`], on the
/// planners.
///
/// # Errors
/// Every reason why the scenario is invalid.
pub fn simulate(
    scenario: &Scenario,
    mut driver: impl Driver,
    recorder: &mut dyn Recorder,
) -> Result<Summary, Violations> {
    fly(scenario, &mut Undisturbed(&mut driver), recorder)
}

/// Flies a scenario to its end under a disturbance.
pub(crate) fn fly(
    scenario: &Scenario,
    disturbance: &mut dyn Disturbance,
    recorder: &mut dyn Recorder,
) -> Result<Summary, Violations> {
    let mut simulation = Simulation::new(scenario)?;
    loop {
        if let Some(summary) = simulation.step_disturbed(disturbance, recorder)? {
            return Ok(summary);
        }
    }
}
