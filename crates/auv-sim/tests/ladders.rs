//! Battery and emergencies of mission files.
#![cfg(feature = "mission-file")]
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_mission::{AbortReason, Contingency, EmergencyCause};
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_sim::mission_file::{DataReport, LaunchCheck, MissionData, MissionFile, WhyLeftOut};
use auv_sim::{MissionOutcome, simulate};
use auv_types::{Point3, Seed};

fn text(keys: &str) -> String {
    format!(
        "version = 2\nname = \"ladders\"\npreset = \"default\"\nbudget_s = 6000\nreserve_s = 0\nstart = \"a\"\ndestination = \"b\"\n\
         waypoints = [{{ name = \"a\", at = [0, 0, 10] }}, {{ name = \"c\", at = [600, 600, 10], task = \"look\" }}, {{ name = \"b\", at = [1200, 0, 10] }}]\n\
         connect.nearest = 2\ncurrent.still = true\nsonar.clutter_per_scan = 0\n\
         tasks.look = {{ priority = 5, risk = 1, time_s = 300 }}\n{keys}\n"
    )
}

fn file(keys: &str) -> MissionFile {
    MissionFile::from_toml(&text(keys)).unwrap()
}

fn refused(keys: &str) -> String {
    let file = MissionFile::from_toml(&text(keys)).map_err(|error| error.to_string());
    let scenario = file.and_then(|file| {
        let scenario = file.scenario(&MissionData::default(), Seed(1));
        scenario.map_err(|error| error.to_string())
    });
    scenario.unwrap_err()
}

fn checked(keys: &str) -> LaunchCheck {
    checked_file(&file(keys))
}

fn checked_file(file: &MissionFile) -> LaunchCheck {
    let routes = GaRoute::new(GaSettings::default());
    let driver = Stepped::new(&routes, &StraightPath);
    let report = &mut DataReport::default();
    let checked = file.launch_check(&MissionData::default(), Seed(1), &driver, report);
    checked.unwrap()
}

/// 10 W for everything, 20 W of it at 1.5 m/s for the propeller: 30 W.
const HOTEL: &str = "hotel_w = 10\npropulsion = [[1.0, 10.0], [2.0, 30.0]]";

#[test]
fn a_battery_is_a_budget_beside_time() {
    let large = checked(&format!("[battery]\nusable_wh = 100\n{HOTEL}"));
    assert!(large.go && large.left_out.is_empty());
    let arrives_s = large.route.last().unwrap().arrive_s;
    let left = large.energy_left_percent.unwrap();
    assert!(
        (left - 100.0 * (1.0 - 30.0 * arrives_s / 360_000.0)).abs() < 1e-6,
        "{left}"
    );
    // 15 Wh without the reserve: 30 minutes. The way by c takes longer, the straight one 800 s.
    let small = checked(&format!("[battery]\nusable_wh = 11\n{HOTEL}"));
    assert!(small.go, "{:?}", small.problems);
    assert_eq!(small.left_out.len(), 1);
    assert_eq!(small.left_out[0].reason, WhyLeftOut::Energy);
    assert!(
        small.left_out[0].text.contains("the battery lasts"),
        "{}",
        small.left_out[0].text
    );
    let empty = checked(&format!("[battery]\nusable_wh = 5\n{HOTEL}"));
    assert!(
        !empty.go && empty.problems[0].contains("battery"),
        "{:?}",
        empty.problems
    );
    assert!(checked("").energy_left_percent.is_none());
}

#[test]
fn more_time_than_the_battery_lasts_loses_no_task() {
    let keys = format!("[battery]\nusable_wh = 30\n{HOTEL}");
    let file = |budget_s: &str| {
        let text = text(&keys).replace("budget_s = 6000\nreserve_s = 0", budget_s);
        MissionFile::from_toml(&text).unwrap()
    };
    // 25.5 Wh without the battery's reserve: 3,060 s.
    for file in [file("budget_s = 6000"), file("budget_s = 600000")] {
        let scenario = file.scenario(&MissionData::default(), Seed(1)).unwrap();
        let mission = &scenario.mission;
        let kept = mission.reserve_s / mission.available_s(mission.budget_s, 0.0);
        assert!(
            (0.01..0.3).contains(&kept),
            "{kept} of {} s",
            mission.budget_s
        );
        assert!(checked_file(&file).left_out.is_empty());
    }
}

#[test]
fn emergencies_are_ladders_by_cause_and_place() {
    let keys = "[[emergency]]\nwhen = \"leak\"\nwhere = [[0, 0], [500, 0], [500, 500]]\ndo = [{ loiter = { for_s = 60 } }]\n\
                [[emergency]]\nwhen = \"leak\"\ndo = [\"surface\"]\n[[emergency]]\nwhen = \"no_way_home\"\ndo = [\"return_along_track\"]";
    let scenario = file(keys)
        .scenario(&MissionData::default(), Seed(1))
        .unwrap();
    let mission = &scenario.mission;
    assert_eq!(mission.emergencies[2].when, EmergencyCause::NoWayHome);
    let near = Point3::new(400.0, 200.0, 10.0);
    let loiter = Contingency::Loiter { for_s: 60.0 };
    assert_eq!(mission.ladder(AbortReason::Leak, &near), [loiter]);
    let far = Point3::new(700.0, 200.0, 10.0);
    assert_eq!(
        mission.ladder(AbortReason::Leak, &far),
        [Contingency::Surface]
    );
    let back = [Contingency::ReturnAlongTrack];
    assert_eq!(mission.ladder(AbortReason::Unreachable, &far), back);
    // The mission itself does not change.
    let driver = Stepped::new(&GreedyRoute, &StraightPath);
    let summary = simulate(&scenario, &driver, &mut ()).unwrap();
    assert_eq!(summary.outcome, MissionOutcome::Docked);
}

#[test]
fn what_is_wrong_is_said_by_name_with_the_remedy() {
    for (keys, parts) in [
        (
            "[battery]\nusable_wh = 0\nhotel_w = 1\npropulsion = [[1, 1]]",
            &["battery.usable_wh"][..],
        ),
        (
            "[battery]\nusable_wh = 9\nhotel_w = 1\npropulsion = []",
            &["battery.propulsion", "give one pair"],
        ),
        (
            "[battery]\nusable_wh = 9\nhotel_w = 1\npropulsion = [[2, 1], [1, 1]]",
            &["battery.propulsion[1]", "1 m/s after", "ascending speeds"],
        ),
        (
            "[battery]\nusable_wh = 9\nhotel_w = 1\npropulsion = [[1, 9], [2, -1]]",
            &["battery.propulsion[1] is [2, -1]", "a power of 0 W or more"],
        ),
        (
            "[battery]\nusable_wh = 9\nhotel_w = 1\npropulsion = [[0.5, 1], [1, 1]]",
            &["cruising speed of 1.5 m/s"],
        ),
        (
            "[battery]\nusable_wh = 9\nhotel_w = 1\nreserve_percent = 100\npropulsion = [[1, 1]]",
            &["reserve_percent"],
        ),
        (
            "[[emergency]]\nwhen = \"fire\"\ndo = []",
            &["unknown word `fire`", "`leak`"],
        ),
        (
            "[[emergency]]\nwhen = \"leak\"\nwhere = [[0, 0], [1, 1]]\ndo = [\"surface\"]",
            &["emergency[0].where", "give 3"],
        ),
        (
            "synchroniser.without_sonar = \"go_home\"\n[[emergency]]\nwhen = \"leak\"\ndo = [\"surface\"]",
            &["without_sonar", "keep one"],
        ),
    ] {
        let text = refused(keys);
        for part in parts {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert_eq!(text.lines().count(), 1, "{text}");
    }
}
