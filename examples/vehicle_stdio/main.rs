//! The synchroniser as a process of its own: `cargo run --release --example vehicle_stdio -- --mission FILE.toml`.
//!
//! A vehicle's software in any language writes one JSON object a line to its standard input and reads one JSON object a line
//! from its standard output ([`messages`]). `drive.py` beside this file does so in Python.

mod messages;

use auv_examples::{Arguments, CommandLine, Failure, MissionInput, Opt, note, print};
use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::{Orders, Stepped};
use auv_mission::{Checkpoint, Event, Navigation, Observation, Synchroniser, set_point};
use auv_obstacles::{ObstaclePredictor, Region, Rejected, Scan, Tracker};
use auv_planning::Trajectory;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::Scenario;
use messages::{Incoming, Moment, Outgoing};
use std::io::BufRead;
use std::sync::Arc;

const COMMAND: CommandLine = CommandLine {
    name: "vehicle_stdio",
    about: "Flies a vehicle that is driven by another process: one JSON object a line in (observations with the sonar's\n\
            echoes), one out (set-point, trajectory, decisions, outcome). docs/vehicle.md has the schema.",
    operands: &[],
    options: &[
        MissionInput::MISSION,
        MissionInput::BATHYMETRY,
        MissionInput::CURRENTS,
        MissionInput::AIS,
        Opt::value(
            "lookahead-s",
            "S",
            "2",
            "how far ahead a set-point looks, s",
        ),
    ],
    notes: "The mission's chart, current and settings are used; its simulated truth is not. --json changes nothing.\n\
            Example: python3 examples/vehicle_stdio/drive.py target/release/examples/vehicle_stdio",
};

fn main() -> std::process::ExitCode {
    COMMAND.run(run)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let lookahead_s = arguments.number("lookahead-s")?.unwrap_or(2.0);
    let input = MissionInput::read(arguments)?;
    let scenario = input.scenario(arguments.seed()?)?;
    let workers = arguments.workers()?;
    let routes = GaRoute::new(GaSettings::default()).with_workers(workers.clone());
    let paths = PsoPath::new(PathSearch::default()).with_workers(workers);
    let driver = Stepped::new(&routes, &paths);
    input.require_go(arguments.seed()?, &driver)?;
    let refused = |error: &dyn std::fmt::Display| Failure::file(&input.path, error);
    let mut autonomy = Autonomy::new(&scenario, lookahead_s).map_err(|error| refused(&error))?;
    let mission = &scenario.mission;
    let mut warnings = scenario.warnings.clone();
    let ships = scenario.field.ships().len();
    if ships > 0 {
        warnings.push(format!(
            "the mission's {ships} ships are simulated and not predicted here: report them as `ships`"
        ));
    }
    tell(&Outgoing::Ready {
        name: &scenario.name,
        budget_s: mission.budget_s,
        position: mission.position_of(mission.start),
        waypoints: mission
            .network
            .waypoints()
            .iter()
            .map(|w| w.name.clone())
            .collect(),
        warnings: &warnings,
    })?;
    for line in std::io::stdin().lock().lines() {
        let line = line.map_err(|error| Failure::file("stdin", error))?;
        if line.trim().is_empty() {
            continue;
        }
        match serde_json::from_str(&line) {
            Ok(message) => autonomy.take(&driver, message)?,
            Err(error) => refuse(&error)?,
        }
        if let Some(outcome) = autonomy.synchroniser.outcome() {
            note(&format!("vehicle_stdio: the mission is over: {outcome}"));
            break;
        }
    }
    Ok(())
}

/// The synchroniser with its tracker.
struct Autonomy<'a> {
    scenario: &'a Scenario,
    synchroniser: Synchroniser,
    tracker: Tracker,
    /// What holds of the mission's fences for a time or at some depths.
    fences: Vec<Region>,
    /// What the tracker had refused when that was told last.
    refused: Rejected,
    /// Rows of the two tables that were told.
    told: (usize, usize),
    lookahead_s: f64,
}

impl<'a> Autonomy<'a> {
    fn new(scenario: &'a Scenario, lookahead_s: f64) -> Result<Self, auv_types::Violations> {
        let mut tracker = Tracker::new(scenario.tracker.clone())?;
        tracker.charted(scenario.field.charted());
        let mission = Arc::clone(&scenario.mission);
        Ok(Self {
            scenario,
            synchroniser: Synchroniser::new(mission, scenario.settings.clone(), scenario.seed)?,
            tracker,
            fences: scenario.fences.regions(scenario.mission.bounds.as_ref()),
            refused: Rejected::default(),
            told: (0, 0),
            lookahead_s,
        })
    }

    fn take(&mut self, driver: &Stepped<'_>, message: Incoming) -> Result<(), Failure> {
        match message {
            Incoming::Observation(moment) => self.observe(driver, *moment),
            Incoming::Save => match self.synchroniser.save().to_text() {
                Ok(checkpoint) => tell(&Outgoing::Saved { checkpoint }),
                Err(error) => refuse(&error),
            },
            Incoming::Resume { checkpoint } => match self.resumed(&checkpoint) {
                Ok(synchroniser) => {
                    self.synchroniser = synchroniser;
                    driver.carry_on(&mut self.synchroniser);
                    let calls = self.synchroniser.route_calls().len();
                    self.told = (calls, self.synchroniser.path_calls().len());
                    tell(&Outgoing::Resumed {
                        due_s: self.synchroniser.due_s(),
                        trajectory: self.synchroniser.trajectory().map(points),
                    })
                }
                Err(error) => refuse(&error),
            },
        }
    }

    fn resumed(&self, checkpoint: &str) -> Result<Synchroniser, auv_mission::ResumeError> {
        let mission = Arc::clone(&self.scenario.mission);
        Synchroniser::resume(mission, Checkpoint::from_text(checkpoint)?)
    }

    fn observe(&mut self, driver: &Stepped<'_>, moment: Moment) -> Result<(), Failure> {
        let time_s = moment.time_s;
        let error_m = Navigation::SIGMAS * moment.position_sigma_m.max(0.0);
        if let Some(by) = &moment.corrected_by {
            self.tracker.moved(by);
        }
        self.tracker.unsure_of_place(error_m);
        self.tracker.reported(moment.ships.clone());
        if let Some(scan) = moment.scan {
            self.tracker.observe(&Scan {
                time_s,
                from: moment.position,
                heading_rad: scan.heading_rad,
                background: scan.background,
                detections: scan.echoes,
            });
        }
        let altitude = moment
            .altitude_m
            .map(|altitude_m| Event::AltitudeMeasured { altitude_m });
        let battery = moment
            .battery_j
            .map(|left_j| Event::BatteryMeasured { left_j });
        let (policy, forecast) = (&self.scenario.clearance, self.scenario.ship_forecast());
        let now = (time_s, error_m);
        let mut regions = policy.predicted(&self.tracker, &moment.ships, &forecast, now);
        let margin_m = policy.tracking_error_m + error_m;
        regions.extend(self.fences.iter().map(|fence| fence.inflated(margin_m)));
        regions.extend(moment.regions);
        let now = Observation {
            position_sigma_m: moment.position_sigma_m,
            time_s,
            position: moment.position,
            velocity: moment.velocity,
            regions: regions.into(),
        };
        let tick = Event::Tick(now.clone());
        let mut orders = Orders::default();
        let stuck = moment.cannot_follow.then_some(Event::CannotFollow);
        let leak = moment.leak.then_some(Event::Leak);
        let told = altitude.into_iter().chain(battery).chain([tick]);
        for event in told.chain(stuck).chain(leak) {
            let told = driver.tell(&mut self.synchroniser, event);
            orders.follow = told.follow.or(orders.follow);
        }
        self.tell_orders(&now, &orders)
    }

    fn tell_orders(&mut self, now: &Observation, orders: &Orders) -> Result<(), Failure> {
        let synchroniser = &self.synchroniser;
        let (routes, legs) = (synchroniser.route_calls(), synchroniser.path_calls());
        let follow = synchroniser.trajectory();
        let rejected = self.tracker.rejected();
        let refused = rejected.since(&self.refused);
        tell(&Outgoing::Orders {
            time_s: now.time_s,
            set_point: follow
                .map(|path| set_point(path, synchroniser.mission(), now, self.lookahead_s)),
            trajectory: orders.follow.as_deref().map(points),
            route_calls: &routes[self.told.0.min(routes.len())..],
            legs: &legs[self.told.1.min(legs.len())..],
            refused: (refused != Rejected::default()).then_some(refused),
            due_s: synchroniser.due_s(),
            outcome: synchroniser.outcome().map(|outcome| outcome.to_string()),
        })?;
        self.told = (routes.len(), legs.len());
        self.refused = rejected;
        Ok(())
    }
}

fn points(trajectory: &Trajectory) -> Vec<[f64; 4]> {
    let row = |p: &auv_obstacles::TimedPoint| [p.position.x, p.position.y, p.position.z, p.time_s];
    trajectory.points().iter().map(row).collect()
}

fn refuse(error: &dyn std::fmt::Display) -> Result<(), Failure> {
    let reason = error.to_string();
    tell(&Outgoing::Refused { reason })
}

fn tell(message: &Outgoing<'_>) -> Result<(), Failure> {
    let text = serde_json::to_string(message).map_err(|e| Failure::Internal(e.to_string()))?;
    print(&format!("{text}\n"))
}
