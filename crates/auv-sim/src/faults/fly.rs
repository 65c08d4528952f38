//! Flying a mission with faults.

use super::active_faults::ActiveFaults;
use super::planners::{Faulty, Trigger};
use super::witness::{Watched, Witness};
use super::{Fault, FaultPlan, FaultResponse, Trial, input};
use crate::oracle::Sea;
use crate::simulate::fly;
use crate::{Recorder, Scenario};
use auv_mission::driver::Stepped;
use auv_planning::{PathPlanner, RoutePlanner};
use auv_types::Violations;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Flies a scenario with faults and judges the run. A panic counts as a failure of the run and is not
/// passed on.
///
/// # Determinism
/// The result depends on the arguments only. Without faults the flight equals that of
/// [`crate::simulate`] bit for bit.
///
/// # Errors
/// Every reason why the scenario without faults is invalid.
pub fn fly_with_faults(
    scenario: &Scenario,
    route_planner: &dyn RoutePlanner,
    path_planner: &dyn PathPlanner,
    plan: &FaultPlan,
    recorder: &mut dyn Recorder,
) -> Result<Trial, Violations> {
    scenario.validate().into_result()?;
    let run = AssertUnwindSafe(|| match plan.faults.iter().find(|f| !f.is_in_flight()) {
        Some(&fault) => Ok(input::run(fault, plan.intensity, scenario, plan.seed)),
        None => in_flight(scenario, route_planner, path_planner, plan, recorder),
    });
    catch_unwind(run).unwrap_or_else(|_| {
        let failure = "a panic came through the library".to_owned();
        Ok(Trial::loaded(FaultResponse::FellBack, vec![failure]))
    })
}

fn in_flight(
    scenario: &Scenario,
    route_planner: &dyn RoutePlanner,
    path_planner: &dyn PathPlanner,
    plan: &FaultPlan,
    recorder: &mut dyn Recorder,
) -> Result<Trial, Violations> {
    let mut scenario = scenario.clone();
    let witness = Witness::default();
    let started: Arc<AtomicBool> = Arc::default();
    let mut routes: Box<dyn RoutePlanner + '_> = Box::new(route_planner);
    let mut paths: Box<dyn PathPlanner + '_> = Box::new(path_planner);
    for (k, &fault) in plan.faults.iter().enumerate() {
        if matches!(fault, Fault::Panic | Fault::Rubbish | Fault::Livelock) {
            let trigger = Arc::new(Trigger {
                fault,
                intensity: plan.intensity,
                seed: plan.seed.split(k as u64),
                started: Arc::clone(&started),
            });
            routes = Box::new(Faulty::new(routes, Arc::clone(&trigger)));
            paths = Box::new(Faulty::new(paths, trigger));
        }
    }
    let watched = Watched {
        inner: paths,
        witness: &witness,
    };
    let driver = Stepped::new(&routes, &watched);
    let mut faults = ActiveFaults::new(plan, &scenario, (&driver, &witness), started);
    faults.prepare(&mut scenario);
    let summary = fly(&scenario, &mut faults, recorder)?;
    let (started_s, failures, intervals) = faults.into_findings();
    let mut trial = Trial::flown(summary, started_s, plan.expected(), failures);
    trial.ask_oracle(&Sea {
        intervals,
        bounds: scenario.mission.bounds,
    });
    Ok(trial)
}
