//! Flies a scenario to its end.

use crate::closed_loop::ClosedLoop;
use crate::disturbance::Disturbance;
use crate::{Entry, Recorder, Scenario, Summary};
use auv_mission::Contingency;
use auv_mission::driver::Stepped;
use auv_types::Violations;

/// Flies a scenario to its end.
///
/// # Determinism
/// The result depends on the scenario and the planners only.
///
/// # Errors
/// Every reason why the scenario is invalid.
pub fn simulate(
    scenario: &Scenario,
    driver: &Stepped<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Summary, Violations> {
    fly(scenario, driver, &mut (), recorder)
}

/// A mission that lasts longer than this many budgets, and this many ticks more, counts as endless.
const MOST_BUDGETS: f64 = 10.0;
const SPARE_TICKS: f64 = 100_000.0;

/// Flies a scenario to its end under a disturbance.
pub(crate) fn fly(
    scenario: &Scenario,
    driver: &Stepped<'_>,
    disturbance: &mut dyn Disturbance,
    recorder: &mut dyn Recorder,
) -> Result<Summary, Violations> {
    scenario.validate().into_result()?;
    let mut closed_loop = ClosedLoop::new(scenario)?;
    recorder.record(Entry::Started(scenario));
    closed_loop.tick(driver, disturbance, recorder);
    let most_ticks = most_ticks(scenario);
    for ticks in 1_u64.. {
        if closed_loop.is_over() {
            break;
        }
        if ticks > most_ticks {
            disturbance.fail("the mission does not end".into());
            break;
        }
        closed_loop.fly_to_next_tick(disturbance, recorder);
        closed_loop.tick(driver, disturbance, recorder);
    }
    let summary = closed_loop.summary();
    recorder.record(Entry::Ended(&summary));
    Ok(summary)
}

/// Number of ticks after which a mission counts as endless. It grows with the budget, so that a long
/// mission with short ticks is flown to its end.
fn most_ticks(scenario: &Scenario) -> u64 {
    let longest_s = MOST_BUDGETS * scenario.mission.budget_s + Contingency::LONGEST_S;
    (longest_s / scenario.tick_s + SPARE_TICKS) as u64
}
