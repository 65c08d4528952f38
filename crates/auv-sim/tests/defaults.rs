//! `Default` and the mission file's `preset = "default"` mean the same; so do `paper()` and `paper`.
#![cfg(feature = "mission-file")]
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_mission::driver::Stepped;
use auv_mission::{Mission, SyncSettings};
use auv_obstacles::truth::{Birth, FieldSettings, MissionObstacles};
use auv_obstacles::{ClearancePolicy, Sonar, TrackerSettings};
use auv_planning::Vehicle;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::{MissionOutcome, Preset, PresetCurrent, PresetValues, Scenario, simulate};
use auv_types::rand::RngExt;
use auv_types::{Bounds, Point3, Seed};
use serde::Serialize;
use serde_json::{Value, json};
use std::sync::Arc;

/// The differences between two values, key by key.
fn differences(place: &str, a: &Value, b: &Value, found: &mut Vec<String>) {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
            for key in keys {
                let [a, b] = [a, b].map(|object| object.get(key).unwrap_or(&Value::Null));
                differences(&format!("{place}.{key}"), a, b, found);
            }
        }
        _ if a != b => found.push(format!("{place}: {a} and {b}")),
        _ => {}
    }
}

/// Every field of a mission's settings, whether from `Default` or `paper()`, a preset or a scenario.
struct Settings<'a> {
    vehicle: &'a Vehicle,
    sonar: &'a Sonar,
    tracker: &'a TrackerSettings,
    clearance: &'a ClearancePolicy,
    synchroniser: &'a SyncSettings,
}

impl Settings<'_> {
    fn json(&self) -> Value {
        fn of(value: &impl Serialize) -> Value {
            serde_json::to_value(value).unwrap()
        }
        json!({
            "vehicle": of(self.vehicle),
            "sonar": of(self.sonar),
            "tracker": of(self.tracker),
            "clearance": of(self.clearance),
            "synchroniser": of(self.synchroniser),
        })
    }
}

fn of_preset(values: &PresetValues) -> Value {
    let settings = Settings {
        vehicle: &values.vehicle,
        sonar: &values.sonar,
        tracker: &values.tracker,
        clearance: &values.clearance,
        synchroniser: &values.synchroniser,
    };
    settings.json()
}

fn of_scenario(scenario: &Scenario) -> Value {
    let settings = Settings {
        vehicle: &scenario.mission.vehicle,
        sonar: &scenario.sonar,
        tracker: &scenario.tracker,
        clearance: &scenario.clearance,
        synchroniser: &scenario.settings,
    };
    settings.json()
}

fn assert_equal(name: &str, a: &Value, b: &Value) {
    let mut found = Vec::new();
    differences(name, a, b, &mut found);
    assert!(found.is_empty(), "{}", found.join("\n"));
}

fn json_of(value: &impl Serialize) -> Value {
    serde_json::to_value(value).unwrap()
}

#[test]
fn every_default_equals_the_default_preset() {
    let values = Preset::Default.values();
    let defaults = Settings {
        vehicle: &Vehicle::default(),
        sonar: &Sonar::default(),
        tracker: &TrackerSettings::default(),
        clearance: &ClearancePolicy::default(),
        synchroniser: &SyncSettings::default(),
    };
    assert_equal("default", &of_preset(&values), &defaults.json());
    let motion = json_of(&FieldSettings::default());
    assert_equal(
        "obstacle_motion",
        &json_of(&values.obstacle_motion),
        &motion,
    );
    assert_equal(
        "birth",
        &json_of(&values.birth),
        &json_of(&Birth::default()),
    );
    let anywhere = Point3::origin();
    let layer = Bounds::new(anywhere, anywhere);
    let obstacles = MissionObstacles::new(0, layer, Vec::new(), anywhere, anywhere);
    assert_eq!(
        (obstacles.keep_out_m, obstacles.sonar_range_m),
        (values.keep_out_m, values.sonar.range_m)
    );
    assert_eq!(
        (obstacles.birth, obstacles.field),
        (values.birth, values.obstacle_motion)
    );
}

#[test]
fn every_paper_equals_the_paper_preset() {
    let values = Preset::Paper.values();
    let paper = Settings {
        vehicle: &Vehicle::paper(),
        sonar: &Sonar::paper(),
        tracker: &TrackerSettings::paper(),
        clearance: &ClearancePolicy::paper(),
        synchroniser: &SyncSettings::paper(),
    };
    assert_equal("paper", &of_preset(&values), &paper.json());
    let motion = json_of(&FieldSettings::paper());
    assert_equal(
        "obstacle_motion",
        &json_of(&values.obstacle_motion),
        &motion,
    );
    assert_eq!(values.birth, Birth::paper());
}

#[test]
fn a_scenario_in_code_equals_one_of_a_mission_file() {
    let text = |preset: &str| {
        format!(
            "version = 1\nname = \"two\"\npreset = \"{preset}\"\nstart = \"a\"\ndestination = \"b\"\n\
             waypoints = [{{ name = \"a\", at = [0, 0, 20] }}, {{ name = \"b\", at = [900, 0, 20] }}]\n\
             edges = [{{ from = \"a\", to = \"b\" }}]\ncurrent.still = true\n"
        )
    };
    for preset in Preset::ALL {
        let file = MissionFile::from_toml(&text(preset.as_str())).unwrap();
        let filed = file.scenario(&MissionData::default(), Seed(1)).unwrap();
        let mission = Arc::clone(&filed.mission);
        let coded = Scenario::with_preset(preset, mission, Vec::new(), Seed(1)).unwrap();
        assert_equal(preset.as_str(), &of_scenario(&filed), &of_scenario(&coded));
        assert_eq!(
            (filed.tick_s, filed.guidance_error_m, filed.seed),
            (coded.tick_s, coded.guidance_error_m, coded.seed)
        );
    }
}

/// A world of 3 km by 3 km written in code: 14 waypoints with tasks, 12 obstacles, the default tide.
/// Everything that has a default has it.
fn world(seed: u64) -> Scenario {
    let (values, vehicle) = (Preset::Default.values(), Vehicle::default());
    let mut random = Seed(seed).split(0).stream(0);
    let mut places = vec![Point3::new(150.0, 150.0, 20.0)];
    while places.len() < 13 {
        let mut draw = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        let place = Point3::new(draw(200.0, 2_800.0), draw(200.0, 2_800.0), draw(10.0, 40.0));
        if places.iter().all(|other| (place - other).norm() > 350.0) {
            places.push(place);
        }
    }
    places.push(Point3::new(2_850.0, 2_850.0, 20.0));
    let mut edges = Vec::new();
    for from in 0..14_u32 {
        for to in (0..14_u32).filter(|&to| to != from) {
            let length_m = (places[to as usize] - places[from as usize]).norm();
            let task = Task {
                priority: f64::from(1 + (3 * from + 5 * to) % 7),
                risk: 1.0 + f64::from((from + to) % 4),
                completion_time_s: 60.0,
            };
            if length_m < 1_600.0 {
                edges.push(Edge::directed(from, to, task));
            }
        }
    }
    let waypoints: Vec<Waypoint> = places.iter().map(|place| Waypoint::at(*place)).collect();
    let network = Network::new(&waypoints, &edges, vehicle.speed_mps).unwrap();
    let box_ = Bounds::new(
        Point3::new(0.0, 0.0, 3.0),
        Point3::new(3_000.0, 3_000.0, 100.0),
    );
    let budget_s = 7_200.0;
    let PresetCurrent::Tidal(tide) = values.current else {
        unreachable!("the default preset has a tide");
    };
    let mission = Mission {
        bounds: Some(box_),
        current: Some(Arc::new(tide)),
        reserve_s: values.reserve_share * budget_s,
        ..Mission::new(Arc::new(network), NodeId(0), NodeId(13), budget_s, vehicle)
    };
    let layer = Bounds::new(box_.low, Point3::new(3_000.0, 3_000.0, 40.0));
    let (start, dock) = (places[0], places[13]);
    let obstacles = MissionObstacles::new(12, layer, places, start, dock);
    Scenario::new(mission, obstacles.generate(Seed(seed).split(1)), Seed(seed)).unwrap()
}

#[test]
fn worlds_of_defaults_are_flown_in_time_and_clear_of_obstacles() {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    for seed in 0..6 {
        let driver = Stepped::new(&routes, &paths);
        let summary = simulate(&world(seed), &driver, &mut ()).unwrap();
        let found = (summary.outcome, summary.judgement.collisions);
        assert_eq!(
            found,
            (MissionOutcome::Docked, 0),
            "{seed}: {}, {:?} m from the dock",
            summary.reason,
            summary.dock_error_m
        );
        assert!(summary.tasks > 2, "{seed}: {} tasks", summary.tasks);
    }
}
