//! Waypoints: how long a vehicle waits for a plan when it reaches one, with the threaded driver.

use crate::machine::machine;
use auv_examples::{Arguments, Clock, Failure};
use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::{Threaded, ThreadedSettings};
use auv_mission::{Observation, Synchroniser};
use auv_obstacles::{ObstaclePredictor, Tracker};
use auv_planning::{PathPlanner, RoutePlanner};
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::statistics::{median, quantile};
use auv_sim::{Campaign, Scenario};
use auv_types::Violations;
use std::fmt::Write;
use std::sync::Arc;

/// Missions of each set of planners: about 13 waypoints each.
const MISSIONS: u64 = 20;

/// The section: a row for the default planners, and one for the paper's.
pub(crate) fn measure(arguments: &Arguments) -> Result<String, Failure> {
    let campaign = Campaign::table2(arguments.seed()?);
    let campaign = campaign.map_err(|error| Failure::Internal(error.to_string()))?;
    let mut text = format!(
        "Measured on: {}. {MISSIONS} missions of `campaign` each, flown with the threaded driver at its \
         default settings; a tick of mission time lasts as long as it takes to answer what was asked in it, \
         as on a vehicle. Wall time from the tick that reaches a waypoint to the trajectory that leads on, ms.\n\n\
         | planners | waypoints | prepared | median | 99 % | longest |\n|---|--:|--:|--:|--:|--:|\n",
        machine(arguments)?
    );
    let default = (
        Arc::new(GaRoute::new(GaSettings::default())),
        Arc::new(PsoPath::new(PathSearch::default())),
    );
    let paper = (
        Arc::new(GaRoute::new(GaSettings::paper())),
        Arc::new(PsoPath::new(PathSearch::paper())),
    );
    for (name, (routes, paths)) in [("default", default), ("the paper's", paper)] {
        let mut waits_ms = Vec::new();
        for k in 0..MISSIONS {
            let scenario = campaign.scenario(k);
            let scenario = scenario.map_err(|error| Failure::Internal(error.to_string()))?;
            fly(&scenario, routes.clone(), paths.clone(), &mut waits_ms)
                .map_err(|error| Failure::Internal(error.to_string()))?;
        }
        let prepared = waits_ms.iter().filter(|&&wait_ms| wait_ms < 1.0).count();
        let _ = writeln!(
            text,
            "| {name} | {} | {:.1} % | {:.2} | {:.2} | {:.2} |",
            waits_ms.len(),
            100.0 * prepared as f64 / waits_ms.len() as f64,
            median(&waits_ms),
            quantile(&waits_ms, 0.99),
            quantile(&waits_ms, 1.0),
        );
    }
    Ok(text)
}

/// Flies a scenario with a vehicle that is where it should be; adds the wait at each waypoint.
fn fly(
    scenario: &Scenario,
    routes: Arc<dyn RoutePlanner>,
    paths: Arc<dyn PathPlanner>,
    waits_ms: &mut Vec<f64>,
) -> Result<(), Violations> {
    let mission = &scenario.mission;
    let mut field = scenario.field.clone();
    let mut tracker = Tracker::new(scenario.tracker.clone())?;
    tracker.charted(field.charted());
    let mut random = scenario.seed.split(1).stream(0);
    let settings = scenario.settings.clone();
    let mut synchroniser = Synchroniser::new(Arc::clone(mission), settings, scenario.seed)?;
    let mut driver = Threaded::new(routes, paths, ThreadedSettings::default());
    let at_start = (
        mission.position_of(mission.start),
        auv_types::Vector3::zeros(),
    );
    let (mut time_s, mut next_scan_s) = (0.0, 0.0);
    while synchroniser.outcome().is_none() {
        let (position, velocity) = synchroniser.trajectory().map_or(at_start, |t| t.at(time_s));
        if time_s >= next_scan_s {
            let scan = scenario
                .sonar
                .scan(field.now(), &position, 0.0, time_s, &mut random);
            tracker.observe(&scan);
            next_scan_s = time_s + scenario.tick_s;
        }
        let regions = [field.charted(), tracker.contacts(time_s)].concat();
        let seen = Observation {
            position_sigma_m: 0.0,
            time_s,
            position,
            velocity,
            regions: regions.into(),
        };
        let reached = synchroniser.visited().len();
        let wait_ms = answered(&mut driver, &mut synchroniser, seen);
        if synchroniser.visited().len() > reached && synchroniser.outcome().is_none() {
            waits_ms.push(wait_ms);
        }
        driver.wait(&mut synchroniser);
        let due_s = synchroniser.due_s();
        let until_s = if due_s > time_s {
            due_s.min(next_scan_s)
        } else {
            next_scan_s
        };
        let water = scenario.true_current.as_deref();
        field.step(until_s - time_s, &|place, at_s| {
            water.map_or_else(auv_types::Vector3::zeros, |w| w.velocity_at(place, at_s))
        });
        time_s = until_s;
    }
    Ok(())
}

/// Ticks and waits for all answers; the wall time of it, milliseconds.
fn answered(driver: &mut Threaded, synchroniser: &mut Synchroniser, seen: Observation) -> f64 {
    let clock = Clock::start();
    driver.tick(synchroniser, seen);
    while driver.is_waiting() {
        driver.poll(synchroniser);
        std::thread::yield_now();
    }
    clock.elapsed_ms()
}
