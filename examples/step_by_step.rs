//! A simulation stepped by its caller, with a vehicle of its own: `cargo run --release --example step_by_step`.
//!
//! Key points:
//! - `Simulation::step` flies to the next scan or tick, and everything can be seen between two steps;
//! - vehicle, sonar, tracker and driver are traits: here the vehicle is a body that answers slowly;
//! - the judge compares whatever track it flies with the truth.

use auv::obstacles::TimedPoint;
use auv::prelude::*;
use auv::sim::{Campaign, Guidance, SimulatedVehicle, Simulation};
use auv_examples::{Arguments, CommandLine, Failure, Opt, print};
use std::fmt::Write as _;

const COMMAND: CommandLine = CommandLine {
    name: "step_by_step",
    about: "Flies one mission of the paper's Table 2 set-up with a vehicle written in this example, step by step.",
    operands: &[],
    options: &[Opt::value(
        "lag-s",
        "S",
        "2",
        "how long the vehicle takes to answer, s",
    )],
    notes: "Example: step_by_step --lag-s 4",
};

/// Its velocity follows the velocity asked for with a lag, and so does its error of place.
#[derive(Debug)]
struct SlowVehicle {
    position: Point3<f64>,
    velocity: Vector3<f64>,
    lag_s: f64,
}

impl SimulatedVehicle for SlowVehicle {
    fn position(&self) -> Point3<f64> {
        self.position
    }

    fn velocity(&self) -> Vector3<f64> {
        self.velocity
    }

    fn advance(&mut self, guidance: &Guidance<'_>, track: &mut Vec<TimedPoint>) {
        let steps = ((guidance.until_s - guidance.from_s) / 0.25)
            .ceil()
            .max(1.0);
        let step_s = (guidance.until_s - guidance.from_s) / steps;
        for k in 1..=steps as usize {
            let time_s = guidance.from_s + step_s * k as f64;
            let drift = guidance.water.map_or_else(Vector3::zeros, |water| {
                water.velocity_at(&self.position, time_s)
            });
            let (wanted, asked) = guidance.trajectory.at(time_s);
            let mut through = asked + (wanted - self.position) / (2.0 * self.lag_s) - drift;
            let most_mps = guidance.mission.vehicle.max_speed_mps * guidance.pace;
            through *= most_mps / through.norm().max(most_mps);
            self.velocity += (drift + through - self.velocity) * (step_s / self.lag_s).min(1.0);
            self.position += self.velocity * step_s;
            track.push(TimedPoint::new(self.position, time_s));
        }
    }
}

fn main() -> std::process::ExitCode {
    COMMAND.run(run)
}

fn internal(error: impl std::fmt::Display) -> Failure {
    Failure::Internal(error.to_string())
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let lag_s = arguments.number("lag-s")?.unwrap_or(2.0);
    if !(lag_s > 0.0 && lag_s < 60.0) {
        return Err(Failure::option(
            "lag-s",
            "give more than 0 and less than 60 s",
        ));
    }
    let campaign = Campaign::table2(arguments.seed()?).map_err(internal)?;
    let scenario = campaign.scenario(0).map_err(internal)?;
    let start = scenario.mission.position_of(scenario.mission.start);
    let vehicle = SlowVehicle {
        position: start,
        velocity: Vector3::zeros(),
        lag_s,
    };
    let (routes, paths) = (
        GaRoute::new(GaSettings::default()),
        PsoPath::new(PathSearch::default()),
    );
    let mut driver = Stepped::new(&routes, &paths);
    let mut simulation = Simulation::new(&scenario)
        .map_err(internal)?
        .with_vehicle(vehicle);
    let (mut text, mut shown_s) = (String::new(), 0.0);
    let summary = loop {
        if let Some(summary) = simulation.step(&mut driver, &mut ()).map_err(internal)? {
            break summary;
        }
        if simulation.time_s() >= shown_s {
            let (at, visited) = (
                simulation.position(),
                simulation.synchroniser().visited().len(),
            );
            let _ = writeln!(
                text,
                "{:6.0} s: {:6.0} m north, {:6.0} m east, {:4.0} m deep; {visited} waypoints, {} regions predicted",
                simulation.time_s(),
                at.x,
                at.y,
                at.z,
                simulation.predicted().len()
            );
            shown_s += 600.0;
        }
    };
    let _ = writeln!(text, "{summary}");
    let _ = writeln!(
        text,
        "95 % of the time within {:.1} m of the timed place",
        summary.following.quantile_m(0.95)
    );
    print(&text)
}
