//! Missions of a vehicle that does not know its place exactly: it docks by the truth.

#![allow(clippy::expect_used, reason = "a test may panic")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::{Body, EndReason, MissionOutcome, Summary, simulate};
use auv_types::Seed;

const MISSION: &str = r#"
version = 2
name = "dead reckoning"
preset = "default"
budget_s = 9000.0
start = "boat"
destination = "dock"
waypoints = [
    { name = "boat", at = [0, 0, 10] },
    { name = "A", at = [2500, 400, 20], task = "cast" },
    { name = "B", at = [1800, 1800, 25], task = "cast" },
    { name = "dock", at = [200, 600, 15] },
]
tasks.cast = { priority = 3, risk = 1, time_s = 60 }
connect.nearest = 3
box = { north_m = [-500, 4000], east_m = [-500, 4000], depth_m = [2, 60] }

[sea_bed.analytic]
base_depth_m = 45.0
sigma = { least_m = 0.5, relative = 0.01 }
features = []

[[obstacles]]
name = "wreck"
class = "static"
at = [1300, 250, 15]
radius_m = 40
"#;

fn flown(more: &str, body: Body, seed: u64) -> Summary {
    let file = MissionFile::from_toml(&format!("{MISSION}\n{more}")).expect("sound");
    let scenario = file.with_body(body);
    let scenario = scenario.scenario(&MissionData::default(), Seed(seed));
    let scenario = scenario.expect("a sound mission");
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    simulate(&scenario, &Stepped::new(&routes, &paths), &mut ()).expect("flown")
}

#[test]
fn with_drift_it_takes_a_fix_and_docks_by_the_truth() {
    for body in Body::ALL {
        for seed in 0..3 {
            let summary = flown(
                "[navigation]\ndrift_percent = 1\ncompass_deg = 0.3",
                body,
                seed,
            );
            assert_eq!(summary.outcome, MissionOutcome::Docked, "{summary}");
            let error_m = summary.dock_error_m.expect("docked");
            assert!(error_m <= 15.0, "{body:?}, seed {seed}: {error_m} m");
            assert!(summary.judgement.limits_broken.is_empty(), "{summary}");
            assert_eq!(summary.tasks, 2, "{summary}");
        }
    }
}

#[test]
fn the_error_stays_below_its_limit() {
    let free = flown("[navigation]\ndrift_percent = 1", Body::Point, 1);
    let limited = flown(
        "[navigation]\ndrift_percent = 1\nmost_error_m = 12",
        Body::Point,
        1,
    );
    assert_eq!(limited.outcome, MissionOutcome::Docked, "{limited}");
    assert!(limited.time_s > free.time_s + 200.0, "fixes take time");
}

/// A fix every 20 minutes: of a vehicle that errs, and of one that does not.
#[test]
fn it_surfaces_as_often_as_told() {
    for drift in [0.0, 1.0] {
        let more = format!("[navigation]\ndrift_percent = {drift}\n[surface]\nevery_s = 1200");
        let told = flown(&more, Body::Remus100, 2);
        assert_eq!(told.outcome, MissionOutcome::Docked, "{told}");
        let without = flown("", Body::Remus100, 2);
        assert!(told.time_s > without.time_s + 300.0, "{told}");
    }
}

#[test]
fn a_dock_that_cannot_be_found_is_refused_before_launch() {
    let text = format!("{MISSION}\n[navigation]\ndrift_percent = 10");
    let file = MissionFile::from_toml(&text).expect("sound");
    let refused = file.scenario(&MissionData::default(), Seed(0));
    let refused = refused.expect_err("refused").to_string();
    assert!(refused.contains("docking.tolerance_m"), "{refused}");
}

/// A vehicle that is not told to fix its place, by a tolerance it keeps to all the same, is judged by the truth.
#[test]
fn what_is_not_at_the_dock_has_not_docked() {
    let exact = flown("", Body::Point, 0);
    assert_eq!(exact.reason, EndReason::InTime);
    assert!(exact.dock_error_m.expect("docked") < 5.0);
}
