//! Fixed-seed answers of the commands, compared with the files in `tests/golden`.
//!
//! The commands' own code runs inside this test, so that an example built earlier is never asked.
#![allow(
    clippy::unwrap_used,
    reason = "a test that fails should say where it does"
)]

#[allow(dead_code, reason = "a test starts no command line")]
#[path = "../path.rs"]
mod path;
#[allow(dead_code, reason = "a test starts no command line")]
#[path = "../route.rs"]
mod route;

use auv_examples::{Arguments, CommandLine, MissionInput};
use auv_ga_route::{GaRoute, GaSettings};
use auv_graph::{Terrain, format};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::{Campaign, Log, Scenario, Summary, simulate};
use auv_types::Seed;
use serde_json::{Value, json};
use std::ffi::OsString;

/// What `mission` and `campaign` answer, without measured times and without the log's texts.
fn flown(scenario: &Scenario) -> Value {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    let mut log = Log::hash_only();
    let summary = simulate(scenario, &Stepped::new(&routes, &paths), &mut log).unwrap();
    answer(&summary, &log.sha256())
}

fn answer(summary: &Summary, log_sha256: &str) -> Value {
    let routes = summary.route_calls.iter().map(|call| {
        json!({
            "at_s": call.at_s, "tasks": call.tasks, "weight": call.route_weight,
            "route_s": call.route_s, "evaluations": call.evaluations, "adopted": call.adopted,
        })
    });
    let legs = summary.path_calls.iter().map(|leg| {
        json!({
            "at_s": leg.at_s, "leg_s": leg.leg_s, "expected_s": leg.expected_s,
            "paths": leg.replanned_paths + 1, "replan": leg.replan,
        })
    });
    let visited = summary.visited.iter().map(|node| node.0);
    json!({
        "outcome": summary.outcome,
        "visited": visited.collect::<Vec<_>>(),
        "mission_weight": summary.mission_weight,
        "tasks": summary.tasks,
        "time_s": summary.time_s,
        "remaining_s": summary.remaining_s,
        "route_calls": routes.collect::<Vec<_>>(),
        "path_calls": legs.collect::<Vec<_>>(),
        "min_true_clearance_m": summary.judgement.min_clearance_m,
        "min_altitude_m": summary.judgement.min_altitude_m,
        "log_sha256": log_sha256,
    })
}

/// A mission with a file of its own, and one test thread each.
fn harrow_inlet(seed: u64) -> Result<(), String> {
    const MISSION: CommandLine = CommandLine {
        name: "mission",
        about: "",
        operands: &[],
        options: &[
            auv_examples::Opt::value("mission", "FILE", "", ""),
            MissionInput::BATHYMETRY,
            MissionInput::CURRENTS,
            MissionInput::AIS,
        ],
        notes: "",
    };
    let input = MissionInput::read(&Arguments::parse(&MISSION, []).unwrap()).unwrap();
    let found = flown(&input.scenario(Seed(seed)).unwrap());
    check(&format!("harrow_inlet_{seed}"), &found)
}

fn table2(first: u64) -> Result<(), String> {
    let campaign = Campaign::table2(Seed(0)).unwrap();
    for k in first..first + 3 {
        let found = flown(&campaign.scenario(k).unwrap());
        check(&format!("table2_{k}"), &found)?;
    }
    Ok(())
}

fn check(name: &str, found: &Value) -> Result<(), String> {
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), name, found)
}

#[test]
fn harrow_inlet_0() -> Result<(), String> {
    harrow_inlet(0)
}

#[test]
fn harrow_inlet_1() -> Result<(), String> {
    harrow_inlet(1)
}

#[test]
fn harrow_inlet_2() -> Result<(), String> {
    harrow_inlet(2)
}

#[test]
fn harrow_inlet_3() -> Result<(), String> {
    harrow_inlet(3)
}

#[test]
fn table2_missions_0_to_2() -> Result<(), String> {
    table2(0)
}

#[test]
fn table2_missions_3_to_5() -> Result<(), String> {
    table2(3)
}

/// A file of this test's own that is gone when the test ends.
struct Scratch(std::path::PathBuf);

impl Scratch {
    fn new(name: &str, text: &[u8]) -> Self {
        let file = std::env::temp_dir().join(format!("auv-golden-{}-{name}", std::process::id()));
        std::fs::write(&file, text).unwrap();
        Self(file)
    }

    /// What follows a command's name: this file, then options.
    fn arguments(&self, command: &CommandLine, options: &str) -> Arguments {
        let options = options.split_whitespace().map(OsString::from);
        let words = [OsString::from(&self.0)].into_iter().chain(options);
        Arguments::parse(command, words).unwrap()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// The JSON of a command without its measured time and without the name of the scratch file.
fn without_time(mut answer: Value) -> Value {
    let answer_object = answer.as_object_mut().unwrap();
    for key in ["elapsed_ms", "instance"] {
        answer_object.remove(key);
    }
    answer
}

#[test]
fn routes_of_every_preset() -> Result<(), String> {
    let instance = Terrain::benchmark(30, 200).draw(Seed(5)).unwrap();
    let file = Scratch::new("route.json", format::to_json(&instance).unwrap().as_bytes());
    for (name, options) in [
        ("route_ga_default", "--evaluations 3000"),
        ("route_ga_paper", "--preset paper --evaluations 3000"),
        ("route_ica_default", "--planner ica --evaluations 3000"),
        (
            "route_ica_paper",
            "--planner ica --preset paper --evaluations 3000",
        ),
        ("route_exact", "--planner exact --evaluations 20000"),
        ("route_greedy", "--planner greedy --evaluations 1000"),
    ] {
        let planned = route::plan(&file.arguments(&route::COMMAND, options)).unwrap();
        let answer = serde_json::to_value(planned.answer()).unwrap();
        check(name, &without_time(answer))?;
    }
    Ok(())
}

/// A leg of 2 km: a wall of three balls with gaps, a ball that crosses, one that grows.
const SCENE: &str = r#"{"id": "five", "speed": 3.0, "start": [0, 0, 40], "target": [2000, 0, 40],
    "bounds": {"lo": [-200, -600, 0], "hi": [2200, 600, 100]},
    "obstacles": [{"centre": [700, 0, 40], "radius": 120}, {"centre": [700, 260, 40], "radius": 110},
        {"centre": [700, -280, 40], "radius": 130},
        {"centre": [1300, 300, 40], "radius": 90, "velocity": [0, -0.6, 0]},
        {"centre": [1700, -60, 40], "radius": 40, "growth": 0.05}]}"#;

#[test]
fn paths_of_every_preset() -> Result<(), String> {
    let file = Scratch::new("path.json", SCENE.as_bytes());
    for (name, options) in [
        ("path_default", "--evaluations 2000"),
        ("path_standard", "--preset standard --evaluations 2000"),
        ("path_paper", "--preset paper --evaluations 2000"),
    ] {
        let planned = path::plan(&file.arguments(&path::COMMAND, options)).unwrap();
        let mut answer = serde_json::to_value(planned.answer()).unwrap();
        let points = answer["path"].as_array().unwrap().clone();
        // About thirty points say where the path is; its length, to the bit, covers the others.
        let stride = points.len().div_ceil(30);
        answer["path"] = points.iter().step_by(stride).cloned().collect();
        answer["points"] = points.len().into();
        check(name, &without_time(answer))?;
    }
    Ok(())
}
