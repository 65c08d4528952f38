//! What is told before the launch is what is flown: docks, fixes beside work, surveys that lie where they must not.
#![cfg(feature = "mission-file")]
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::Mission;
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{DataReport, LaunchCheck, MissionData, MissionFile, MissionFileError};
use auv_sim::{Body, MissionOutcome, Summary, simulate};
use auv_types::Seed;

fn planners<T>(run: impl FnOnce(&Stepped<'_>) -> T) -> T {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    run(&Stepped::new(&routes, &paths))
}

fn check(file: &MissionFile) -> Result<LaunchCheck, MissionFileError> {
    let mut report = DataReport::default();
    planners(|driver| file.launch_check(&MissionData::default(), Seed(1), driver, &mut report))
}

/// The check, the flight, and how many tasks it did.
fn flown(text: &str, body: Body) -> (LaunchCheck, Summary, usize) {
    let file = MissionFile::from_toml(text).unwrap().with_body(body);
    let scenario = file.scenario(&MissionData::default(), Seed(1)).unwrap();
    let summary = planners(|driver| simulate(&scenario, driver, &mut ())).unwrap();
    let done = file.works_done(&scenario.mission, &summary);
    let count = done.iter().filter(|done| **done).count();
    (check(&file).unwrap(), summary, count)
}

fn mission(more: &str) -> String {
    format!(
        "version = 2\nname = \"told\"\npreset = \"default\"\nbudget_s = 14400\nstart = \"boat\"\n\
         current.still = true\nsonar.clutter_per_scan = 0\nsea_bed.flat_m = 60\n\
         box = {{ north_m = [-500, 2000], east_m = [-500, 1500], depth_m = [2, 59] }}\n{more}"
    )
}

#[test]
fn a_longer_budget_is_that_of_a_file_which_says_so() {
    let ends = "waypoints = [{ name = \"boat\", at = [0, 0, 20] }, { name = \"dock\", at = [900, 0, 20] }]\n\
                destination = \"dock\"\nconnect.nearest = 1\n";
    let battery = "battery = { usable_wh = 60, hotel_w = 20, propulsion = [[1.5, 20]] }\n";
    let given = "reserve_s = 900\n";
    for more in ["", given, battery] {
        let text = mission(&format!("{ends}{more}"));
        let of = |text: &str| {
            let file = MissionFile::from_toml(text).unwrap();
            let scenario = file.scenario(&MissionData::default(), Seed(1)).unwrap();
            (file, scenario)
        };
        let (file, scenario) = of(&text);
        for by_s in [-3_600.0, 1_800.0] {
            let said = format!("budget_s = {}", 14_400.0 + by_s);
            let (_, edited) = of(&text.replace("budget_s = 14400", &said));
            let varied = file.with_budget_longer(scenario.clone(), by_s).mission;
            let of = |mission: &Mission| [mission.budget_s, mission.reserve_s];
            let both = of(&varied).into_iter().zip(of(&edited.mission));
            let differs_s = both.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(differs_s < 1e-9, "{more}: {differs_s} s");
        }
    }
}

#[test]
fn a_route_ends_at_the_first_of_several_docks_that_it_reaches() {
    // The best way to all work would lead past a dock.
    let text = mission(
        r#"
        docks = ["dock", "dock two"]
        waypoints = [
            { name = "boat", at = [219, 367, 12] },
            { name = "dock", at = [671, 1056, 8] },
            { name = "dock two", at = [518, 889, 9] },
            { name = "W0", at = [1086, 172, 16], tasks = ["profile0"] },
            { name = "W1", at = [563, 343, 10], task = "altitude1" },
            { name = "W2", at = [1408, 624, 14], task = "circle2" },
            { name = "W3", at = [1667, 673, 14], tasks = ["yoyo3"] },
        ]
        edges = [{ from = "W1", to = "W2", tasks = ["line"], altitude_m = 18 }]
        connect.nearest = 3
        docking = { heading_deg = 4, lead_in_m = 120 }
        [tasks]
        profile0 = { priority = 8, risk = 1, pattern = { kind = "profile", from_m = 7, to_m = 27 }, time_s = 66, windows = [[1737, 5827]] }
        altitude1 = { priority = 5, risk = 2, time_s = 205, altitude_m = 16 }
        circle2 = { priority = 6, risk = 2, pattern = { kind = "circle", radius_m = 68, turns = 1 }, windows = [[2361, 6266]] }
        yoyo3 = { priority = 6, risk = 2, pattern = { kind = "yoyo", top_m = 5, bottom_m = 30, length_m = 303, heading_deg = 32 }, mandatory = true }
        line = { priority = 5, risk = 2, time_s = 0 }
        "#,
    );
    let (check, summary, done) = flown(&text, Body::Point);
    let docks = |place: &str| ["dock", "dock two"].contains(&place);
    let passed = check.route.iter().filter(|stop| docks(&stop.place)).count();
    assert_eq!(passed, 1, "{:?}", check.route);
    assert_eq!((summary.outcome, done), (MissionOutcome::Docked, 5));
}

#[test]
fn a_fix_from_time_to_time_neither_repeats_work_nor_keeps_it_from_its_end() {
    let circle =
        "{ priority = 3, risk = 1, pattern = { kind = \"circle\", radius_m = 70, turns = 2 } }";
    // A circle of 700 s that a fix would interrupt, and a stay that is longer than two fixes are apart.
    for (every_s, task) in [
        (1300, circle),
        (800, "{ priority = 3, risk = 1, time_s = 900 }"),
    ] {
        let text = mission(&format!(
            "destination = \"dock\"\nconnect.nearest = 2\nsurface.every_s = {every_s}\n\
             tasks.work = {task}\nwaypoints = [\n{{ name = \"boat\", at = [0, 0, 10] }},\n\
             {{ name = \"a\", at = [600, 300, 20], tasks = [\"work\"] }},\n\
             {{ name = \"dock\", at = [1200, 0, 15] }},\n]\n"
        ));
        for body in Body::ALL {
            let (check, summary, done) = flown(&text, body);
            assert_eq!(
                (summary.outcome, done),
                (MissionOutcome::Docked, 1),
                "{body:?} {task}: {}",
                summary.reason
            );
            // Fixes in the middle of a stay are not told in full.
            if task != circle {
                continue;
            }
            let told_s = check.route.last().unwrap().arrive_s;
            let off = told_s / summary.time_s - 1.0;
            assert!(
                off.abs() < 0.1,
                "{body:?} {task}: {told_s} of {} s",
                summary.time_s
            );
            assert!(check.route.iter().any(|stop| stop.fixes_s > 0.0));
        }
    }
}

#[test]
fn a_pattern_longer_than_the_time_between_two_fixes_is_left_out_with_its_remedy() {
    let text = mission(
        "destination = \"dock\"\nconnect.nearest = 2\nsurface.every_s = 900\nwaypoints = [\n\
         { name = \"boat\", at = [0, 0, 10] },\n{ name = \"a\", at = [600, 300, 20], task = \"ring\" },\n\
         { name = \"dock\", at = [1200, 0, 15] },\n]\n[tasks.ring]\npriority = 3\nrisk = 1\n\
         pattern = { kind = \"circle\", radius_m = 70, turns = 3 }\n",
    );
    let check = check(&MissionFile::from_toml(&text).unwrap()).unwrap();
    let reason = check.tasks[0].reason.as_deref().unwrap_or_default();
    assert!(check.go && !check.tasks[0].possible, "{check:?}");
    assert!(
        reason.contains("every_s") && reason.contains("shorter"),
        "{reason}"
    );
}

#[test]
fn a_survey_where_it_must_not_be_is_told_once() {
    let survey = |polygon: &str, depth: &str| {
        mission(&format!(
            "destination = \"dock\"\nwaypoints = [\n{{ name = \"boat\", at = [0, 0, 10] }},\n\
             {{ name = \"dock\", at = [1200, 0, 15] }},\n]\nedges = [{{ from = \"boat\", to = \"dock\" }}]\n\
             [[surveys]]\nname = \"grid\"\npolygon = {polygon}\nspacing_m = 50\n{depth}\npriority = 5\nrisk = 1\n"
        ))
    };
    let inside = "[[200, 200], [600, 200], [600, 500], [200, 500]]";
    let cases = [
        (inside, "depth_m = 58", "give a smaller depth_m"),
        (inside, "altitude_m = 1", "give a greater altitude_m"),
        (
            "[[200, 1300], [600, 1300], [600, 1800], [200, 1800]]",
            "depth_m = 20",
            "outside the box",
        ),
    ];
    for (polygon, depth, part) in cases {
        let file = MissionFile::from_toml(&survey(polygon, depth)).unwrap();
        let problems = check(&file).unwrap().problems;
        assert_eq!(problems.len(), 1, "{problems:?}");
        let told = problems[0].starts_with("surveys[0] (grid): ") && problems[0].contains(part);
        assert!(told, "{problems:?}");
    }
}
