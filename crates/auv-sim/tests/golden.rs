//! Goldens of whole missions: the Table 2 set-up, a small mission file, runs with faults.
#![cfg(feature = "mission-file")]
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::faults::{Fault, FaultPlan, Intensity, fly_with_faults};
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::{Campaign, Log, Scenario, Summary, simulate};
use auv_types::Seed;
use serde_json::{Value, json};

/// A finite number as it is, another as text.
fn number(x: f64) -> Value {
    if x.is_finite() {
        json!(x)
    } else {
        json!(x.to_string())
    }
}

fn told(summary: &Summary, log: &Log) -> Value {
    let judgement = &summary.judgement;
    json!({
        "outcome": summary.outcome,
        "log_sha256": log.sha256(),
        "visited": summary.visited.iter().map(|node| node.0).collect::<Vec<_>>(),
        "tasks": summary.tasks,
        "mission_weight": summary.mission_weight,
        "time_s": summary.time_s,
        "remaining_s": summary.remaining_s,
        "route_calls": summary.route_calls.len(),
        "legs": summary.path_calls.len(),
        "replanned_paths": summary.path_calls.iter().map(|c| u64::from(c.replanned_paths)).sum::<u64>(),
        "collisions": judgement.collisions,
        "groundings": judgement.groundings,
        "min_clearance_m": number(judgement.min_clearance_m),
        "min_clearance_at_s": judgement.min_clearance_at_s,
        "min_altitude_m": number(judgement.min_altitude_m),
        "min_ship_distance_m": number(judgement.min_ship_distance_m),
    })
}

fn flown(scenario: &Scenario) -> Value {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    let mut log = Log::hash_only();
    let summary = simulate(scenario, &Stepped::new(&routes, &paths), &mut log).unwrap();
    told(&summary, &log)
}

fn check(name: &str, found: &Value) {
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), name, found).unwrap();
}

#[test]
fn six_missions_of_the_table_2_set_up() {
    let campaign = Campaign::table2(Seed(0)).unwrap();
    let fly = |k| flown(&campaign.scenario(k).unwrap());
    let missions = std::thread::scope(|scope| {
        let halves = [0, 3].map(|first| scope.spawn(move || [0, 1, 2].map(|k| fly(first + k))));
        halves.map(|half| half.join().unwrap())
    });
    check("table2_missions", &json!(missions.concat()));
}

/// Bed, tide, every class, a ship, shared legs: small, with everything.
const BAY: &str = r#"
    version = 1
    name = "bay"
    preset = "default"
    budget_s = 5000.0
    start = "boat"
    destination = "dock"
    waypoints = [
        { name = "boat", at = [0, 0, 10] },
        { name = "mouth", at = [500, 200, 20], task = "profile" },
        { name = "reef", at = [900, -300, 15], task = "profile" },
        { name = "head", at = [1300, 300, 20] },
        { name = "dock", at = [1500, 0, 10] },
    ]
    edges = [{ from = "mouth", to = "head", task = "line" }]
    tasks.profile = { priority = 4, risk = 2, time_s = 120 }
    tasks.line = { priority = 8, risk = 1.5, time_s = 60 }
    connect = { nearest = 3, cell_m = 20 }
    altitude = { least_m = 5, sigmas = 2 }
    random_obstacles = 2

    [box]
    north_m = [-300, 1900]
    east_m = [-900, 900]
    depth_m = [2, 60]

    [sea_bed.analytic]
    base_depth_m = 50
    features = [
        { name = "shoal", shape.disc = { centre = [600, -100], radius_m = 60 }, depth_m = 4, skirt_m = 150 },
    ]

    [current]
    moves_vehicle = true
    truth = { gain = [0.8, 1.2], delay_s = [-600, 600] }
    [current.analytic]
    mean_mps = [0.05, 0]
    tide = [{ major_mps = [0.2, 0.1], minor_mps = [0, 0.02], period_s = 44714.164, strongest_s = 1800 }]

    [[obstacles]]
    name = "farm"
    class = "static"
    at = [1100, 0, 0]
    radius_m = 40
    top_m = -2
    bottom_m = 60

    [[obstacles]]
    name = "trawl"
    class = "moving"
    at = [700, 400, 20]
    radius_m = 15
    velocity_mps = [0.1, -0.4, 0]

    [[obstacles]]
    name = "net"
    class = "drifting"
    at = [1000, 250, 15]
    radius_m = 12

    [[obstacles]]
    name = "buoys"
    class = "uncertain"
    at = [300, -200, 10]
    radius_m = 20
"#;

fn bay(seed: u64) -> Scenario {
    let file = MissionFile::from_toml(BAY).unwrap();
    file.scenario(&MissionData::default(), Seed(seed)).unwrap()
}

#[test]
fn two_missions_of_a_mission_file() {
    check("bay_missions", &json!([1, 2].map(|seed| flown(&bay(seed)))));
}

fn with_faults(scenario: &Scenario, faults: [Fault; 2], degree: u8) -> Value {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    let plan = FaultPlan {
        faults: faults.to_vec(),
        intensity: Intensity::new(degree).unwrap(),
        seed: Seed(3),
    };
    let mut log = Log::hash_only();
    let trial = fly_with_faults(scenario, &routes, &paths, &plan, &mut log).unwrap();
    json!({
        "class": format!("{:?}", trial.response),
        "failures": trial.failures.len(),
        "begun_s": trial.started_s,
        "unavoidable_by_s": trial.unavoidable_by_s,
        "mission": told(trial.summary.as_ref().unwrap(), &log),
    })
}

#[test]
fn runs_with_faults() {
    let table2 = Campaign::table2(Seed(5)).unwrap();
    let found = [
        with_faults(&bay(1), [Fault::Sudden, Fault::Storm], 2),
        with_faults(
            &table2.scenario(0).unwrap(),
            [Fault::Current, Fault::Restart],
            2,
        ),
        with_faults(
            &table2.scenario(1).unwrap(),
            [Fault::Rubbish, Fault::Overrun],
            3,
        ),
    ];
    check("faults", &json!(found));
}
