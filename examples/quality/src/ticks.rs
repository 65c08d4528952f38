//! Ticks: how long the synchroniser takes at each, planning apart.

use crate::machine::machine;
use auv_examples::{Arguments, Clock, Failure};
use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::{Stepped, Threaded, ThreadedSettings};
use auv_mission::{Event, Observation, Synchroniser};
use auv_obstacles::{ObstacleId, Region};
use auv_planning::{PathPlanner, RoutePlanner};
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::Scenario;
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::statistics::{median, quantile};
use auv_types::rand::RngExt;
use auv_types::{Bounds, Point3, Seed, Vector3};
use std::fmt::Write;
use std::sync::Arc;

const MISSION: &str = include_str!("../../missions/harrow_inlet.toml");

/// How far ahead regions are predicted, seconds.
const HORIZON_S: f64 = 600.0;

/// The section: a row for each number of regions and driver.
pub(crate) fn measure(arguments: &Arguments) -> Result<String, Failure> {
    let missions = arguments.number("seeds")?.unwrap_or(10);
    let first = arguments.seed()?.0;
    let mut text = format!(
        "Measured on: {}. Missions of Harrow Inlet for each row: {missions}, a tick a second, with so many predicted regions: \
         half of them at rest, half under way. Wall time of a tick, planners apart, ms.\n\n\
         | regions | driver | ticks | median | 99.9 % | most | over 20 ms |\n|--:|---|--:|--:|--:|--:|--:|\n",
        machine(arguments)?
    );
    for regions in [100, 300] {
        for (name, fly) in [("stepped", stepped as Fly), ("threaded", threaded)] {
            let mut took_ms = Vec::new();
            for seed in first..first + missions {
                let sea = Sea::draw(Seed(seed), regions)?;
                fly(&sea, &mut took_ms)?;
            }
            let over = took_ms.iter().filter(|ms| **ms > 20.0).count();
            let _ = writeln!(
                text,
                "| {regions} | {name} | {} | {:.2} | {:.2} | {:.2} | {over} |",
                took_ms.len(),
                median(&took_ms),
                quantile(&took_ms, 0.999),
                quantile(&took_ms, 1.0),
            );
        }
    }
    Ok(text)
}

/// Flies a mission among regions and adds the time of each tick, milliseconds.
type Fly = fn(&Sea, &mut Vec<f64>) -> Result<(), Failure>;

/// A mission among many obstacles.
struct Sea {
    scenario: Scenario,
    obstacles: Vec<Region>,
}

impl Sea {
    fn draw(seed: Seed, count: u32) -> Result<Self, Failure> {
        let file = MissionFile::from_toml(MISSION);
        let scenario = file.and_then(|file| file.scenario(&MissionData::default(), seed));
        let scenario = scenario.map_err(|error| Failure::Internal(error.to_string()))?;
        let mission = &scenario.mission;
        let bounds = mission.bounds.unwrap_or(Bounds::BELOW_SURFACE);
        let mut random = seed.split(7).stream(0);
        let mut obstacles = Vec::new();
        while obstacles.len() < count as usize {
            let mut between = |low: f64, high: f64| random.random_range(low..high);
            let centre = [0, 1, 2].map(|k| between(bounds.low[k], bounds.high[k]));
            let radius_m = between(3.0, 15.0);
            let speeds = [between(-0.5, 0.5), between(-0.5, 0.5)];
            let moves = f64::from(u8::from(obstacles.len() % 2 == 1));
            let obstacle = Region {
                obstacle: ObstacleId(obstacles.len() as u32),
                velocity_mps: Vector3::new(speeds[0], speeds[1], 0.0) * moves,
                growth_mps: 0.02 * moves,
                ..Region::ball(Point3::from(centre), radius_m)
            };
            let start = mission.position_of(mission.start);
            if (start - obstacle.centre).norm() > 100.0 {
                obstacles.push(obstacle);
            }
        }
        Ok(Self {
            scenario,
            obstacles,
        })
    }

    fn synchroniser(&self) -> Result<Synchroniser, Failure> {
        let scenario = &self.scenario;
        let mission = Arc::clone(&scenario.mission);
        let settings = scenario.settings.clone();
        Synchroniser::new(mission, settings, scenario.seed)
            .map_err(|error| Failure::Internal(error.to_string()))
    }

    /// What a vehicle sees that is where it should be.
    fn seen(&self, synchroniser: &Synchroniser, time_s: f64) -> Observation {
        let mission = synchroniser.mission();
        let rest = (mission.position_of(mission.start), Vector3::zeros());
        let (position, velocity) = synchroniser.trajectory().map_or(rest, |t| t.at(time_s));
        let predicted = |obstacle: &Region| Region {
            centre: obstacle.centre_at(time_s),
            at_s: time_s,
            from_s: time_s,
            until_s: time_s + HORIZON_S,
            ..*obstacle
        };
        Observation {
            time_s,
            position,
            position_sigma_m: 0.0,
            velocity,
            regions: self.obstacles.iter().map(predicted).collect(),
        }
    }
}

fn planners() -> (GaRoute, PsoPath) {
    let routes = GaRoute::new(GaSettings::default());
    (routes, PsoPath::new(PathSearch::default()))
}

fn stepped(sea: &Sea, took_ms: &mut Vec<f64>) -> Result<(), Failure> {
    let (routes, paths) = planners();
    let driver = Stepped::new(&routes, &paths);
    let mut synchroniser = sea.synchroniser()?;
    let mut time_s = 0.0;
    while synchroniser.outcome().is_none() {
        let mut events = vec![Event::Tick(sea.seen(&synchroniser, time_s))];
        let mut tick_ms = 0.0;
        while let Some(event) = events.pop() {
            let clock = Clock::start();
            let commands = synchroniser.step(event);
            tick_ms += clock.elapsed_ms();
            events.extend(commands.iter().filter_map(|command| driver.answer(command)));
        }
        took_ms.push(tick_ms);
        time_s = next_s(&synchroniser, time_s);
    }
    Ok(())
}

fn threaded(sea: &Sea, took_ms: &mut Vec<f64>) -> Result<(), Failure> {
    let (routes, paths) = planners();
    let routes: Arc<dyn RoutePlanner> = Arc::new(routes);
    let paths: Arc<dyn PathPlanner> = Arc::new(paths);
    let mut driver = Threaded::new(routes, paths, ThreadedSettings::default());
    let mut synchroniser = sea.synchroniser()?;
    let mut time_s = 0.0;
    while synchroniser.outcome().is_none() {
        let seen = sea.seen(&synchroniser, time_s);
        let clock = Clock::start();
        driver.tick(&mut synchroniser, seen);
        let mut tick_ms = clock.elapsed_ms();
        // The planners compute apart; what is made of their answers belongs to the tick.
        while driver.is_waiting() {
            std::thread::yield_now();
            let clock = Clock::start();
            driver.poll(&mut synchroniser);
            tick_ms += clock.elapsed_ms();
        }
        took_ms.push(tick_ms);
        driver.wait(&mut synchroniser);
        time_s = next_s(&synchroniser, time_s);
    }
    Ok(())
}

fn next_s(synchroniser: &Synchroniser, time_s: f64) -> f64 {
    let due_s = synchroniser.due_s();
    if due_s > time_s {
        due_s.min(time_s + 1.0)
    } else {
        time_s + 1.0
    }
}
