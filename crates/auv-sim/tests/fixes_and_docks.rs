//! Where fixes are taken, and docking that is tried again.
#![cfg(feature = "mission-file")]
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_planning::baseline::StraightPath;
use auv_sim::mission_file::{DataReport, MissionData, MissionFile};
use auv_sim::{Entry, MissionOutcome, Recorder, Summary, simulate};
use auv_types::{Point3, Seed};

/// The mission with more keys; its task takes half a minute if they do not say otherwise.
fn text(keys: &str) -> String {
    let look = if keys.contains("tasks.look") {
        ""
    } else {
        "tasks.look = { priority = 5, risk = 1, time_s = 30 }"
    };
    format!(
        "version = 2\nname = \"fixes\"\npreset = \"default\"\nbudget_s = 9000\nstart = \"boat\"\ndestination = \"dock\"\n\
         waypoints = [{{ name = \"boat\", at = [0, 0, 10] }}, {{ name = \"a\", at = [1200, 300, 15], task = \"look\" }}, \
         {{ name = \"b\", at = [2400, 0, 15], task = \"look\" }}, {{ name = \"dock\", at = [3000, 900, 12] }}]\n\
         edges = [{{ from = \"boat\", to = \"a\" }}, {{ from = \"a\", to = \"b\" }}, {{ from = \"b\", to = \"dock\" }}]\n\
         current.still = true\nsonar.clutter_per_scan = 0\n{look}\n{keys}\n"
    )
}

/// Where the vehicle was at the surface.
#[derive(Default)]
struct Surfaced(Vec<Point3<f64>>);

impl Recorder for Surfaced {
    fn record(&mut self, entry: Entry<'_>) {
        if let Entry::Flown { track, .. } = entry {
            let up = track.iter().filter(|at| at.position.z < 0.1);
            self.0.extend(up.map(|at| at.position));
        }
    }
}

fn flown(keys: &str, seed: u64) -> (Summary, Vec<Point3<f64>>) {
    let file = MissionFile::from_toml(&text(keys)).unwrap();
    let scenario = file.scenario(&MissionData::default(), Seed(seed)).unwrap();
    let routes = GaRoute::new(GaSettings::default());
    let mut surfaced = Surfaced::default();
    let driver = Stepped::new(&routes, &StraightPath);
    let summary = simulate(&scenario, &driver, &mut surfaced).unwrap();
    (summary, surfaced.0)
}

/// The arrival of the check before launch, seconds, and its warnings.
fn checked(keys: &str) -> (f64, Vec<String>) {
    let file = MissionFile::from_toml(&text(keys)).unwrap();
    let routes = GaRoute::new(GaSettings::default());
    let driver = Stepped::new(&routes, &StraightPath);
    let report = &mut DataReport::default();
    let check = file.launch_check(&MissionData::default(), Seed(1), &driver, report);
    let check = check.unwrap();
    (check.route.last().unwrap().arrive_s, check.warnings)
}

#[test]
fn fixes_are_taken_near_the_waypoints_told_and_counted_before_launch() {
    let here = "surface = { every_s = 2000, where = [\"a\"] }";
    let (summary, surfaced) = flown(here, 1);
    assert_eq!(summary.outcome, MissionOutcome::Docked);
    let a = Point3::new(1200.0, 300.0, 15.0);
    let near = |p: &Point3<f64>| (p - a).xy().norm() < 200.0;
    assert!(
        !surfaced.is_empty() && surfaced.iter().all(near),
        "{surfaced:?}"
    );
    for keys in [
        here,
        "surface.every_s = 900",
        // Work that is longer than the time from one fix to the next.
        "surface.every_s = 900\ntasks.look = { priority = 5, risk = 1, time_s = 1200 }",
        "surface = { every_s = 1500, where = [\"a\", \"b\"] }\ntasks.look = { priority = 5, risk = 1, time_s = 1700 }",
        "surface.every_s = 1500\ntasks.look = { priority = 5, risk = 1, time_s = 300, windows = [[2500, 9000]] }",
        "navigation = { drift_percent = 1, most_error_m = 12 }",
    ] {
        let (summary, _) = flown(keys, 1);
        let (arrive_s, warnings) = checked(keys);
        let off = arrive_s / summary.time_s - 1.0;
        assert!(off.abs() < 0.1, "{keys}: {arrive_s} {}", summary.time_s);
        assert_eq!(warnings, [""; 0], "{keys}");
    }
    let (_, warnings) = checked("surface = { every_s = 900, where = [\"b\"] }");
    assert!(
        warnings[0].contains("from boat to b, more than every_s; add"),
        "{warnings:?}"
    );
}

#[test]
fn a_missed_dock_is_tried_again() {
    let seeds = 0..10;
    let docked = |tries: u32| {
        let keys =
            format!("guidance_error_m = 4\ndocking = {{ tolerance_m = 1.2, tries = {tries} }}");
        let flights = seeds.clone().map(|seed| flown(&keys, seed));
        let docked = |(summary, surfaced): &(Summary, Vec<_>)| {
            assert!(tries > 1 || surfaced.is_empty());
            summary.outcome == MissionOutcome::Docked
        };
        flights.filter(docked).count()
    };
    let (once, often) = (docked(1), docked(5));
    assert!(once < 10 && often > once, "{once} {often}");
}

#[test]
fn wrong_keys_are_refused_with_place_and_remedy() {
    for (keys, parts) in [
        (
            "surface = { every_s = 900, where = [\"x\"] }",
            ["surface.where[0]", "correct the name"],
        ),
        (
            "surface = { every_s = 900, where = [] }",
            ["surface.where", "leave it out"],
        ),
        ("docking.tries = 0", ["docking.tries", "give 1 to 10"]),
    ] {
        let file = MissionFile::from_toml(&text(keys)).unwrap();
        let error = file
            .scenario(&MissionData::default(), Seed(1))
            .unwrap_err()
            .to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}

#[test]
fn other_errors_keep_their_line_beside_times_in_utc() {
    let launch = "launch = \"2026-06-01T08:00:00Z\"\ncurrent.analytic.tide = [{ major_mps = [0.1, 0], period_s = 44714, \
                  strongest = \"2026-06-01T09:00:00Z\" }]\n";
    let text = text(launch).replace("current.still = true\n", "");
    let scenario = MissionFile::from_toml(&text).unwrap();
    assert!(scenario.scenario(&MissionData::default(), Seed(1)).is_ok());
    let wrong = text + "surface.every = 5\n";
    let error = MissionFile::from_toml(&wrong).unwrap_err().to_string();
    assert!(
        error.contains("line 14, column 9: unknown key `every`"),
        "{error}"
    );
    let old = wrong
        .replace("version = 2", "version = 1")
        .replace("surface.every = 5\n", "");
    let error = MissionFile::from_toml(
        &old.replace("launch = \"2026-06-01T08:00:00Z\"\n", "")
            .replace("\"2026-06-01T09:00:00Z\"", "3600"),
    );
    assert!(error.unwrap_err().to_string().contains("strongest"));
}
