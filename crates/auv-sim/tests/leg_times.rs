//! The time estimated for a route against the time flown in still, empty water.
#![cfg(feature = "mission-file")]
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::{MissionOutcome, Scenario, Summary, simulate};
use auv_types::rand::RngExt;
use auv_types::{Seed, libm};

fn scenario(text: &str) -> Result<Scenario, String> {
    let file = MissionFile::from_toml(text).map_err(|error| error.to_string())?;
    let scenario = file.scenario(&MissionData::default(), Seed(1));
    scenario.map_err(|error| error.to_string())
}

fn flown(scenario: &Scenario) -> Summary {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    simulate(scenario, &Stepped::new(&routes, &paths), &mut ()).unwrap()
}

/// The survey vehicle, one that turns and pitches more, one that hovers, one that turns widely.
const VEHICLES: [&str; 4] = [
    "",
    "vehicle.max_pitch_rad = 0.436\nvehicle.turn_radius_m = 8\n",
    "vehicle.min_speed_mps = 0\n",
    "vehicle.turn_radius_m = 35\nvehicle.max_pitch_rad = 0.7\n",
];

/// A mission in still, empty water: a handful of waypoints, with and without work, at any depth.
fn random_mission(seed: u64) -> String {
    let mut random = Seed(seed).stream(0);
    let count = random.random_range(2..8);
    let size_m: f64 = random.random_range(200.0..2_000.0);
    let deep_m: f64 = random.random_range(10.0..150.0);
    let mut waypoints = String::new();
    let mut tasks = VEHICLES[seed as usize % VEHICLES.len()].to_owned();
    for i in 0..count {
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let (north_m, east_m) = (draw(0.0, size_m), draw(0.0, size_m));
        let depth_m = draw(5.0, 5.0 + deep_m);
        let work = if draw(0.0, 1.0) < 0.6 && i > 0 && i + 1 < count {
            let time_s = draw(0.0, 300.0);
            tasks += &format!("tasks.t{i} = {{ priority = 5, risk = 1, time_s = {time_s} }}\n");
            format!(", task = \"t{i}\"")
        } else {
            String::new()
        };
        waypoints +=
            &format!("{{ name = \"w{i}\", at = [{north_m}, {east_m}, {depth_m}]{work} }},\n");
    }
    let last = count - 1;
    format!(
        "version = 1\nname = \"random\"\npreset = \"default\"\nbudget_s = 40000\n\
         start = \"w0\"\ndestination = \"w{last}\"\nwaypoints = [\n{waypoints}]\n{tasks}\
         connect.nearest = 3\ncurrent.still = true\nsonar.clutter_per_scan = 0\n"
    )
}

#[test]
fn the_time_of_a_route_is_within_a_tenth_of_what_is_flown() {
    let mut errors = Vec::new();
    for seed in 0..80 {
        let Ok(scenario) = scenario(&random_mission(seed)) else {
            // No way leads to the destination.
            continue;
        };
        let summary = flown(&scenario);
        assert_eq!(summary.outcome, MissionOutcome::Docked, "seed {seed}");
        if summary.visited != summary.route_calls[0].route {
            // A better route was found on the way.
            continue;
        }
        let estimated_s = summary.route_calls[0].route_s;
        let error = estimated_s / summary.time_s - 1.0;
        errors.push(error.abs());
    }
    errors.sort_by(f64::total_cmp);
    let worst = errors[errors.len() - 1];
    assert!(errors.len() >= 50 && worst < 0.1, "{worst}");
}

/// A mission of the kind that an operator writes by hand.
fn mission(budget_s: f64, waypoints: &str, more: &str) -> String {
    format!(
        "version = 1\nname = \"steep\"\npreset = \"default\"\nbudget_s = {budget_s}\nreserve_s = 0\n\
         start = \"a\"\ndestination = \"b\"\nwaypoints = [\n{waypoints}]\ncurrent.still = true\n{more}\n"
    )
}

#[test]
fn a_budget_too_short_for_a_steep_leg_is_refused() {
    // Straight down takes at least 190 m / sin 15 degrees at 1.5 m/s: 489 s.
    for (across_m, deep_m) in [(0.0, 200.0), (300.0, 500.0), (500.0, 1_000.0)] {
        let ends = format!(
            "{{ name = \"a\", at = [0, 0, 10] }}, {{ name = \"b\", at = [{across_m}, 0, {deep_m}] }}"
        );
        let least_s = (deep_m - 10.0) / (libm::sin(15.0_f64.to_radians()) * 1.5);
        let short = scenario(&mission(0.99 * least_s, &ends, "connect.nearest = 1"));
        let text = short.unwrap_err();
        assert!(
            text.contains("budget_s") && text.contains("less than the quickest way"),
            "{text}"
        );
        let enough = scenario(&mission(2.0 * least_s, &ends, "connect.nearest = 1")).unwrap();
        let summary = flown(&enough);
        assert_eq!(summary.outcome, MissionOutcome::Docked, "{deep_m} m");
        let error = summary.route_calls[0].route_s / summary.time_s - 1.0;
        assert!(error.abs() < 0.1, "{deep_m} m: {error}");
    }
}

#[test]
fn short_work_takes_a_vehicle_that_cannot_hover_whole_circles() {
    let stations: Vec<String> = (0..8)
        .map(|i| {
            format!(
                "{{ name = \"s{i}\", at = [{}, 0, 20], task = \"t{i}\" }}",
                250 + 45 * i
            )
        })
        .collect();
    let tasks: Vec<String> = (0..8)
        .map(|i| format!("tasks.t{i} = {{ priority = 5, risk = 1, time_s = 4 }}"))
        .collect();
    let waypoints = format!(
        "{{ name = \"a\", at = [0, 0, 20] }}, {}, {{ name = \"b\", at = [900, 0, 20] }}",
        stations.join(", ")
    );
    let more = format!(
        "connect.nearest = 4\nsonar.clutter_per_scan = 0\n{}",
        tasks.join("\n")
    );
    let summary = flown(&scenario(&mission(3_000.0, &waypoints, &more)).unwrap());
    assert_eq!(
        (summary.outcome, summary.tasks),
        (MissionOutcome::Docked, 8)
    );
    let error = summary.route_calls[0].route_s / summary.time_s - 1.0;
    assert!(error.abs() < 0.1, "{error}");
}

#[test]
#[expect(clippy::print_stderr, reason = "says why it was skipped")]
fn the_given_cases_are_refused_or_estimated_within_a_tenth() {
    let Ok(dir) = std::env::var("AUV_CASES_DIR") else {
        eprintln!("skipped: AUV_CASES_DIR is not set");
        return;
    };
    let read = |name: &str| {
        let text = std::fs::read_to_string(format!("{dir}/10-steep-legs/{name}.toml")).unwrap();
        scenario(&text)
    };
    for name in ["steep_dock", "short_tasks"] {
        let text = read(name).unwrap_err();
        assert!(text.contains("budget_s"), "{name}: {text}");
    }
    // The dive of 600 s takes 489 s on the tightest circles.
    for (name, tasks) in [("st_3000", 10), ("steep_dive_7200", 1), ("vertical600", 0)] {
        let summary = flown(&read(name).unwrap());
        assert_eq!(
            (summary.outcome, summary.tasks),
            (MissionOutcome::Docked, tasks),
            "{name}"
        );
        let call = &summary.route_calls[0];
        let error = call.route_s / summary.time_s - 1.0;
        assert!(!call.valid || error.abs() < 0.1, "{name}: {error}");
    }
}
