//! Missions at the limits of what a file may state: the surface, many ticks.
#![cfg(feature = "mission-file")]
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::{MissionOutcome, Recorder, Scenario, Summary, simulate};
use auv_types::Seed;

/// The scenario of a survey vehicle's mission from `a` to `b` in still water.
fn scenario(ends: [[f64; 3]; 2], more: &str) -> Result<Scenario, String> {
    let [a, b] = ends.map(|at| format!("{at:?}"));
    let text = format!(
        "version = 1\nname = \"limits\"\npreset = \"default\"\nstart = \"a\"\ndestination = \"b\"\n\
         waypoints = [{{ name = \"a\", at = {a} }}, {{ name = \"b\", at = {b} }}]\n\
         connect.nearest = 1\ncurrent.still = true\n{more}\n"
    );
    let file = MissionFile::from_toml(&text).map_err(|error| error.to_string())?;
    let scenario = file.scenario(&MissionData::default(), Seed(1));
    scenario.map_err(|error| error.to_string())
}

fn flown(scenario: &Scenario, recorder: &mut dyn Recorder) -> Summary {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    simulate(scenario, &Stepped::new(&routes, &paths), recorder).unwrap()
}

/// The least depth of all trajectories ordered.
struct Shallowest(f64);

impl Recorder for Shallowest {
    fn record(&mut self, entry: auv_sim::Entry<'_>) {
        if let auv_sim::Entry::Follow(_, way) = entry {
            let depths_m = way.points().iter().map(|p| p.position.z);
            self.0 = depths_m.fold(self.0, f64::min);
        }
    }
}

#[test]
fn without_a_box_nothing_lies_above_the_surface() {
    let in_the_air = scenario([[0.0, 0.0, -5.0], [900.0, 0.0, 5.0]], "budget_s = 3000");
    let text = in_the_air.unwrap_err();
    assert!(text.contains("5.0 m above the surface"), "{text}");
    let boxed = "budget_s = 3000\nbox = { north_m = [-50, 2000], east_m = [-500, 500], depth_m = [-9, 50] }";
    let text = scenario([[0.0, 0.0, 2.0], [900.0, 0.0, 2.0]], boxed).unwrap_err();
    assert!(
        text.contains("box.depth_m") && text.contains("above the surface"),
        "{text}"
    );

    // The short way over these leads through the air.
    for (depth_m, radius_m) in [(12.0, 20.0), (25.0, 30.0)] {
        let ball = format!(
            "budget_s = 4000\nobstacles = [{{ class = \"static\", name = \"ball\", at = [500, 0, {depth_m}], radius_m = {radius_m} }}]"
        );
        let scenario = scenario([[0.0, 0.0, 2.0], [1_000.0, 0.0, 2.0]], &ball).unwrap();
        let mut shallowest = Shallowest(f64::INFINITY);
        let summary = flown(&scenario, &mut shallowest);
        assert_eq!(summary.outcome, MissionOutcome::Docked);
        assert!(shallowest.0 >= -1e-6, "{} m", shallowest.0);
    }
}

#[test]
fn a_mission_of_more_than_a_hundred_thousand_ticks_is_flown_to_its_end() {
    let short_ticks = "budget_s = 10000\ntick_s = 0.05\nsonar.clutter_per_scan = 0";
    let scenario = scenario([[0.0, 0.0, 20.0], [7_800.0, 0.0, 20.0]], short_ticks).unwrap();
    let summary = flown(&scenario, &mut ());
    assert_eq!(summary.outcome, MissionOutcome::Docked);
    assert!(
        summary.time_s / scenario.tick_s > 1e5,
        "{} s",
        summary.time_s
    );
}

#[test]
fn long_ticks_let_no_false_echo_pass_for_a_contact() {
    let work = "tasks.t = { priority = 1, risk = 1, time_s = 600 }\n\
                vehicle = { speed_mps = 0.35, min_speed_mps = 0.15, max_speed_mps = 0.45 }\n";
    for tick_s in [10, 20, 60, 600] {
        let text = format!(
            "version = 1\nname = \"glider\"\npreset = \"default\"\nbudget_s = 250000\ntick_s = {tick_s}\n\
             start = \"a\"\ndestination = \"b\"\nconnect.nearest = 2\ncurrent.still = true\n{work}\
             waypoints = [ {{ name = \"a\", at = [0, 0, 20] }}, {{ name = \"s0\", at = [8000, 0, 50], task = \"t\" }},\n\
             {{ name = \"s1\", at = [16000, 0, 50], task = \"t\" }}, {{ name = \"s2\", at = [16000, 8000, 50], task = \"t\" }},\n\
             {{ name = \"b\", at = [8000, 8000, 20] }} ]\n"
        );
        let file = MissionFile::from_toml(&text).unwrap();
        let scenario = file.scenario(&MissionData::default(), Seed(1)).unwrap();
        let summary = flown(&scenario, &mut ());
        let result = (summary.outcome, summary.tasks);
        assert_eq!(result, (MissionOutcome::Docked, 3), "tick_s = {tick_s}");
    }
}

#[test]
fn a_pool_needs_neither_a_cell_size_nor_a_tracker_of_its_own() {
    let text = "version = 1\nname = \"pool\"\npreset = \"default\"\nbudget_s = 600\ntick_s = 0.5\n\
        guidance_error_m = 0.05\nstart = \"a\"\ndestination = \"b\"\nconnect.nearest = 2\ncurrent.still = true\n\
        waypoints = [ { name = \"a\", at = [1, 1, 1] }, { name = \"gate\", at = [10, 6, 2.3], task = \"gate\" }, { name = \"b\", at = [19, 8, 1] } ]\n\
        tasks.gate = { priority = 5, risk = 1, time_s = 5 }\naltitude = { least_m = 0.3, sigmas = 0 }\nsea_bed.flat_m = 3\n\
        box = { north_m = [0, 20], east_m = [0, 10], depth_m = [0.2, 2.7] }\n\
        vehicle = { speed_mps = 0.4, min_speed_mps = 0, max_speed_mps = 0.8, turn_radius_m = 0, max_pitch_rad = 1.5707 }\n\
        sonar = { range_m = 8, clutter_per_scan = 0 }\n";
    let file = MissionFile::from_toml(text).unwrap();
    let scenario = file.scenario(&MissionData::default(), Seed(1)).unwrap();
    let summary = flown(&scenario, &mut ());
    assert_eq!(
        (summary.outcome, summary.tasks),
        (MissionOutcome::Docked, 1)
    );
}
