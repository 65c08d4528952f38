//! Missions near walls, slopes, pits and pillars: none ends in the bed or in what is charted.
#![cfg(feature = "mission-file")]
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]
#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_ocean::{AnalyticBed, MeasuredBed, SeaBed, Shoal};
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::{MissionOutcome, Scenario, Summary, simulate};
use auv_types::{Seed, libm};
use std::sync::Arc;

fn scenario(text: &str, seed: u64) -> Result<Scenario, String> {
    let file = MissionFile::from_toml(text).map_err(|error| error.to_string())?;
    let scenario = file.scenario(&MissionData::default(), Seed(seed));
    scenario.map_err(|error| error.to_string())
}

fn flown(scenario: &Scenario) -> Summary {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    simulate(scenario, &Stepped::new(&routes, &paths), &mut ()).unwrap()
}

/// Docked, and every limit kept.
fn is_well(summary: &Summary) -> bool {
    let judgement = &summary.judgement;
    summary.outcome == MissionOutcome::Docked
        && (judgement.groundings, judgement.collisions) == (0, 0)
        && judgement.limits_broken.is_empty()
}

/// A look at a waypoint under a wall that rises from 120 m over `skirt_m`, and back.
fn under_a_wall(bearing_rad: f64, skirt_m: f64, over_m: f64) -> String {
    let (ahead, aside) = (libm::cos(bearing_rad), libm::sin(bearing_rad));
    let place = |along_m: f64, across_m: f64| {
        let (north_m, east_m) = (
            along_m * ahead - across_m * aside,
            along_m * aside + across_m * ahead,
        );
        format!("{north_m:?}, {east_m:?}")
    };
    // The skirt runs smoothly from 120 m at its foot to 10 m above water at 1,000 m.
    let foot_m = 1_000.0 - skirt_m;
    let depth_m = |along_m: f64| {
        let share = (along_m - foot_m) / skirt_m;
        120.0 - 130.0 * share * share * (3.0 - 2.0 * share)
    };
    let mut along_m = foot_m;
    while depth_m(along_m + 1.0) > 30.0 + over_m {
        along_m += 1.0;
    }
    format!(
        "version = 1\nname = \"wall\"\npreset = \"default\"\nbudget_s = 7200\nstart = \"boat\"\ndestination = \"dock\"\n\
         waypoints = [{{ name = \"boat\", at = [{}, 10] }}, {{ name = \"W\", at = [{}, 30] }}, {{ name = \"dock\", at = [{}, 10] }}]\n\
         edges = [{{ from = \"boat\", to = \"W\", task = \"look\" }}, {{ from = \"W\", to = \"dock\" }}]\n\
         tasks.look = {{ priority = 5, risk = 1, time_s = 0 }}\nconnect.nearest = 1\ncurrent.still = true\nsonar.clutter_per_scan = 0\n\
         altitude = {{ least_m = 5, sigmas = 0 }}\n\
         [box]\nnorth_m = [-1600, 1600]\neast_m = [-1600, 1600]\ndepth_m = [3, 150]\n\
         [sea_bed.analytic]\nbase_depth_m = 120\n\
         features = [{{ name = \"wall\", shape.beyond = {{ through = [{}], towards = [{}] }}, depth_m = -10, skirt_m = {skirt_m} }}]\n",
        place(100.0, 0.0),
        place(along_m, 40.0),
        place(300.0, 600.0),
        place(1_000.0, 0.0),
        place(1_100.0, 0.0),
    )
}

#[test]
fn a_waypoint_under_a_wall_is_left_again_without_touching_it() {
    for (bearing_deg, skirt_m, over_m) in [
        (0.0, 150.0, 6.0),
        (70.0, 240.0, 8.0),
        (200.0, 320.0, 5.5),
        (311.0, 180.0, 15.0),
    ] {
        let bearing_rad = f64::to_radians(bearing_deg);
        let scenario = scenario(&under_a_wall(bearing_rad, skirt_m, over_m), 1).unwrap();
        let summary = flown(&scenario);
        let place = format!("{bearing_deg} deg, {skirt_m} m: {summary:#?}");
        assert!(is_well(&summary), "{place}");
        assert!(summary.judgement.min_altitude_m >= 5.0, "{place}");
    }
}

/// Stations with stays of 90 s along a trough whose sides rise by up to one in two, at the least altitude.
const TROUGH: &str = "version = 1\nname = \"trough\"\npreset = \"default\"\nbudget_s = 9000\nreserve_s = 600\n\
    start = \"launch\"\ndestination = \"recovery\"\naltitude = { least_m = 4, sigmas = 1 }\nconnect.nearest = 3\n\
    current.still = true\nsonar.clutter_per_scan = 0\ntasks.inspect = { priority = 10, risk = 1, time_s = 90 }\n\
    waypoints = [ { name = \"launch\", at = [-700, -200, 5] }, { name = \"recovery\", at = [700, -200, 5] },\n\
      { name = \"C1\", at = [-400, 130, 14], task = \"inspect\" }, { name = \"C2\", at = [-150, 60, 38], task = \"inspect\" },\n\
      { name = \"C3\", at = [100, 0, 44], task = \"inspect\" }, { name = \"C4\", at = [420, -90, 29], task = \"inspect\" } ]\n\
    [box]\nnorth_m = [-900, 900]\neast_m = [-600, 600]\ndepth_m = [2, 80]\n\
    [sea_bed.analytic]\nbase_depth_m = 16\nsigma = { least_m = 0.5, relative = 0.01 }\n\
    features = [{ name = \"trough\", shape.line = { points = [[-900, 0], [900, 0]], half_width_m = 30 }, depth_m = 52, skirt_m = 120 }]\n";

#[test]
fn stays_on_the_sides_of_a_trough_keep_the_altitude_asked_or_are_left_out_by_name() {
    let scenario = scenario(TROUGH, 1).unwrap();
    let summary = flown(&scenario);
    assert!(is_well(&summary), "{summary:#?}");
    assert!(summary.judgement.min_altitude_m >= 4.0, "{summary:#?}");
    // What is not worked is named before launch.
    let warnings = scenario.warnings.join("\n");
    assert_eq!(
        summary.tasks
            + scenario
                .warnings
                .iter()
                .filter(|text| text.contains("(C"))
                .count(),
        4,
        "{warnings} {summary:#?}"
    );
}

#[test]
fn a_station_without_room_in_the_box_is_named_before_launch_and_the_rest_flown_in_time() {
    let text = "version = 1\nname = \"corner\"\npreset = \"default\"\nbudget_s = 9000\nstart = \"ship\"\ndestination = \"home\"\n\
        connect.nearest = 3\ncurrent.still = true\nsonar.clutter_per_scan = 0\nsea_bed.flat_m = 70\naltitude = { least_m = 5, sigmas = 0 }\n\
        tasks.cast = { priority = 20, risk = 1, time_s = 0 }\ntasks.fix = { priority = 15, risk = 1, time_s = 60 }\n\
        box = { north_m = [-800, 800], east_m = [-500, 500], depth_m = [1, 60] }\n\
        vehicle = { speed_mps = 1.5, max_pitch_rad = 0.436 }\n\
        waypoints = [ { name = \"ship\", at = [-600, -300, 4] }, { name = \"home\", at = [-600, -200, 4] },\n\
          { name = \"corner\", at = [797, 497, 2], task = \"fix\" }, { name = \"edge\", at = [300, 470, 2], task = \"fix\" },\n\
          { name = \"top\", at = [500, 0, 4] }, { name = \"low\", at = [560, 60, 50] }, { name = \"free\", at = [0, 100, 2], task = \"fix\" } ]\n\
        edges = [{ from = \"top\", to = \"low\", task = \"cast\" }]\n";
    let scenario = scenario(text, 1).unwrap();
    let warnings = scenario.warnings.join("\n");
    assert!(warnings.contains("(corner)"), "{warnings}");
    for name in ["(edge)", "(free)"] {
        assert!(!warnings.contains(name), "{warnings}");
    }
    let summary = flown(&scenario);
    assert!(is_well(&summary) && summary.tasks >= 2, "{summary:#?}");
    let planned_s = summary.route_calls[0].route_s;
    assert!(
        summary.time_s < 1.1 * planned_s,
        "{planned_s} s planned: {summary:#?}"
    );
}

/// A small vehicle in a pool with a charted pillar and a ball that it does not know.
const POOL: &str = "version = 1\nname = \"pool\"\npreset = \"default\"\nbudget_s = 500\ntick_s = 0.4\nguidance_error_m = 0.04\n\
    start = \"a\"\ndestination = \"b\"\nconnect.nearest = 3\ncurrent.still = true\naltitude = { least_m = 0.3, sigmas = 0 }\nsea_bed.flat_m = 3.5\n\
    waypoints = [ { name = \"a\", at = [1.2, 8, 1.2] }, { name = \"gate\", at = [8, 4, 1.6], task = \"gate\" },\n\
      { name = \"bins\", at = [15, 7, 2.4], task = \"bins\" }, { name = \"b\", at = [20, 1.5, 1] } ]\n\
    tasks = { gate = { priority = 5, risk = 1, time_s = 5 }, bins = { priority = 8, risk = 1, time_s = 15 } }\n\
    box = { north_m = [0, 22], east_m = [0, 10], depth_m = [0.2, 3.1] }\n\
    obstacles = [ { class = \"static\", at = [11.5, 5, 0], radius_m = 0.6, top_m = -1, bottom_m = 4 },\n\
      { class = \"uncertain\", at = [5, 6.5, 1.3], radius_m = 0.3 } ]\n\
    vehicle = { speed_mps = 0.4, min_speed_mps = 0, max_speed_mps = 0.8, turn_radius_m = 0, max_pitch_rad = 1.5707 }\n\
    sonar = { range_m = 7, position_sigma_m = 0.05, radius_sigma_m = 0.05, sure_range_m = 5, clutter_per_scan = 0 }\n\
    clearance = { contact_m = 0.4, charted_m = 0.3, tracking_error_m = 0.1 }\n\
    synchroniser = { off_track_m = 0.5, hysteresis_m = 0.2 }\nobstacle_motion.min_radius_m = 0.1\n";

#[test]
fn in_a_pool_nothing_charted_is_hit() {
    for seed in 0..20 {
        let summary = flown(&scenario(POOL, seed).unwrap());
        assert_eq!(summary.judgement.collisions, 0, "seed {seed}: {summary:#?}");
        assert_eq!(summary.judgement.groundings, 0, "seed {seed}: {summary:#?}");
    }
}

#[test]
fn the_given_cases_end_neither_in_the_bed_nor_in_what_is_charted() {
    let Ok(dir) = std::env::var("AUV_CASES_DIR") else {
        eprintln!("skipped: AUV_CASES_DIR is not set");
        return;
    };
    let read = |name: &str| std::fs::read_to_string(format!("{dir}/{name}.toml")).unwrap();
    let wall = scenario(&read("operator/wall_grounding"), 1).unwrap();
    let (summary, mission) = (flown(&wall), &wall.mission);
    assert!(is_well(&summary), "{summary:#?}");
    assert!(summary.judgement.min_altitude_m >= mission.min_altitude_m);
    for seed in 0..5 {
        let summary = flown(&scenario(&read("25-pool/pool"), seed).unwrap());
        assert_eq!(summary.judgement.collisions, 0, "seed {seed}: {summary:#?}");
    }
    for name in ["waypoints_in_the_air", "over_the_ball"] {
        let read = scenario(&read(&format!("09-above-the-surface/{name}")), 1);
        let refused = read.is_err();
        assert_eq!(refused, name == "waypoints_in_the_air", "{name}");
        if let Ok(scenario) = read {
            assert!(is_well(&flown(&scenario)), "{name}");
        }
    }
}

/// Looks at the lowest legal depth over a bed charted at 60 m.
const PLAIN: &str = "version = 2\nname = \"plain\"\npreset = \"default\"\nbudget_s = 7200\nstart = \"boat\"\ndestination = \"dock\"\n\
    waypoints = [ { name = \"boat\", at = [0, 0, 10] }, { name = \"A\", at = [500, 0, 46] }, { name = \"B\", at = [900, 500, 46] },\n\
      { name = \"dock\", at = [100, 700, 10] } ]\n\
    edges = [{ from = \"boat\", to = \"A\", task = \"look\" }, { from = \"A\", to = \"B\", task = \"look\" }, { from = \"B\", to = \"dock\" }]\n\
    tasks.look = { priority = 5, risk = 1, time_s = 60 }\nconnect.nearest = 1\ncurrent.still = true\nsonar.clutter_per_scan = 0\n\
    altitude = { least_m = 5, sigmas = 2 }\nsea_bed.analytic.base_depth_m = 60\naltimeter = {}\n\
    box = { north_m = [-400, 1400], east_m = [-400, 1200], depth_m = [2, 80] }\n";

/// The plain with another true bed.
fn over(bed: impl SeaBed + 'static, seed: u64) -> Summary {
    let mut scenario = scenario(PLAIN, seed).unwrap();
    scenario.true_bed = Some(Arc::new(bed));
    flown(&scenario)
}

#[test]
fn a_bed_shallower_than_charted_everywhere_is_climbed_clear_of_and_said() {
    for (seed, shallower_m) in [(0, 5.0), (1, 8.0), (2, 11.0)] {
        let summary = over(AnalyticBed::new(60.0 - shallower_m), seed);
        assert!(is_well(&summary), "{shallower_m} m: {summary:#?}");
        assert_eq!(summary.tasks, 2, "{summary:#?}");
        let raised = summary.raised.iter().map(|(_, by_m)| *by_m);
        let most_m = raised.fold(0.0, f64::max);
        // Plans allow for 6 m of error and for the vehicle's guidance.
        assert_eq!(most_m > 0.0, shallower_m > 5.0, "{:?}", summary.raised);
        assert!(most_m < 8.0, "{:?}", summary.raised);
    }
}

#[test]
fn a_bank_that_is_not_in_the_chart_is_flown_over() {
    let mut climbed = 0;
    // Slopes of at most 1.5 in `run`: a bed that rises slowly is noticed in time to keep the altitude.
    for (seed, raised_m, run) in [
        (0, 10.0, 8.0),
        (1, 14.0, 16.0),
        (2, 18.0, 16.0),
        (3, 18.0, 8.0),
    ] {
        let bank = Shoal {
            north_m: 700.0,
            east_m: 250.0,
            raised_m,
            reach_m: run * raised_m,
        };
        let bed = MeasuredBed::new(AnalyticBed::new(60.0), vec![bank]);
        let summary = over(bed, seed);
        let judgement = &summary.judgement;
        let docked = summary.outcome == MissionOutcome::Docked && judgement.groundings == 0;
        assert!(docked, "{raised_m} m: {summary:#?}");
        assert!(
            run < 10.0 || is_well(&summary),
            "{raised_m} m: {summary:#?}"
        );
        climbed += summary.climbs;
    }
    assert!(climbed > 0);
}
