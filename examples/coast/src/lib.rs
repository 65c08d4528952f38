//! Random coastal missions near steep beds, written as mission files or flown and judged:
//! `cargo run --release --example coast -- --missions 100`.

#![cfg_attr(
    test,
    allow(
        clippy::unwrap_used,
        clippy::float_cmp,
        reason = "a test that fails says where; tests compare exact values on purpose"
    )
)]

mod coastal_mission;
mod dice;
mod flight;
mod landscape;
mod other_bed;
mod sea;
mod tally;
mod toml_text;
mod traits;
mod vehicle;
mod waters;
mod waypoints;

pub use coastal_mission::CoastalMission;
pub use dice::Hardness;
pub use landscape::Landscape;
pub use traits::Traits;

use auv_examples::{
    Arguments, CommandLine, Failure, MissionInput, Opt, note, print, print_json, write_file,
};
use auv_types::Seed;
use flight::Flight;
use other_bed::OtherBed;
use std::path::Path;
use tally::Tally;

const COMMAND: CommandLine = CommandLine {
    name: "coast",
    about: "Draws random coastal missions of the preset `default`: slopes to 45 degrees, walls, shoals, inlets, islands,\n\
            waypoints at the lowest legal depth, tides, movers and pots; about half of the seas are empty and still.\n\
            Flies them and judges them by the truth, or writes them as mission files.",
    operands: &[],
    options: &[
        Opt::value("missions", "N", "100", "number of missions"),
        Opt::value("first", "K", "0", "number of the first mission"),
        Opt::value(
            "flight-seed",
            "S",
            "1",
            "seed of what a mission file leaves open; `mission --seed S` on the written file flies the same",
        ),
        Opt::value(
            "body",
            "NAME",
            "point",
            "body of the simulated vehicle, point or remus100; vehicles are drawn within what it can do",
        ),
        Opt::flag(
            "drawn-bed",
            "the true bed is drawn from the chart's standard deviation (mission files of version 2)",
        ),
        Opt::flag(
            "hard",
            "slopes of 30 to 60 degrees, most waypoints at the limit, wider turns, less pitch, stronger currents, tight boxes",
        ),
        Opt::value(
            "shallower",
            "M",
            "0",
            "the true bed is shallower by this everywhere, metres, and measured; no mission file says so",
        ),
        Opt::flag(
            "banks",
            "the true bed has a bank near the middle of each long leg, and is measured; no mission file says so",
        ),
        Opt::value(
            "write",
            "DIR",
            "",
            "writes the missions into this folder as coast-K.toml and flies none",
        ),
        Opt::value(
            "out",
            "FILE",
            "",
            "where to write one JSON line a mission (default: nowhere)",
        ),
    ],
    notes: "Mission k depends on --seed and k only. Missions that preflight refuses are counted with the reason.\n\
            Examples: coast --missions 1000 --out coast.jsonl\n\
            \x20         coast --missions 100 --first 500 --write missions",
};

/// Runs the command line of the process.
pub fn main() -> std::process::ExitCode {
    COMMAND.run(run)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let count: u64 = arguments.number("missions")?.unwrap_or(100);
    let first: u64 = arguments.number("first")?.unwrap_or(0);
    let seed = arguments.seed()?;
    let hardness = if arguments.flag("hard") {
        Hardness::Hard
    } else {
        Hardness::Usual
    };
    let body = MissionInput::body(arguments)?.unwrap_or_default();
    let draw = |k: u64| CoastalMission {
        drawn_bed: arguments.flag("drawn-bed"),
        ..CoastalMission::draw(seed, k, hardness, body)
    };
    if let Some(folder) = arguments.text("write") {
        let folder = Path::new(folder);
        for k in first..first.saturating_add(count) {
            let text = draw(k).to_toml();
            write_file(&folder.join(format!("coast-{k}.toml")), text.as_bytes())?;
        }
        note(&format!("{count} missions written to {}", folder.display()));
        return Ok(());
    }
    let flight_seed = Seed(arguments.number("flight-seed")?.unwrap_or(1));
    let bed = OtherBed {
        shallower_m: arguments.number("shallower")?.unwrap_or(0.0),
        banks: arguments.flag("banks"),
    };
    let workers = arguments.workers()?;
    let mut flights: Vec<Option<Flight>> = (0..count).map(|_| None).collect();
    workers.for_each(&mut flights, |i, flight| {
        let mission = draw(first.saturating_add(i as u64));
        *flight = Some(Flight::fly(mission, bed, flight_seed));
    });
    let flights: Vec<Flight> = flights.into_iter().flatten().collect();
    if let Some(path) = arguments.text("out") {
        let lines = flights.iter().map(|flight| format!("{}\n", flight.line()));
        write_file(Path::new(path), lines.collect::<String>().as_bytes())?;
    }
    let tally = Tally::of(&flights);
    for line in tally.notes() {
        note(line);
    }
    if arguments.json() {
        print_json(&tally.json())
    } else {
        print(&tally.text())
    }
}
