//! Tasks with windows, order and duty, flown.
#![cfg(feature = "mission-file")]
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{DataReport, LaunchCheck, MissionData, MissionFile, WhyLeftOut};
use auv_sim::{MissionOutcome, Summary, simulate};
use auv_types::Seed;

/// Five stations in a row 600 m apart; the vehicle makes 1.5 m/s.
fn mission(tasks: &str, more: &str) -> String {
    format!(
        "version = 2\nname = \"stations\"\npreset = \"default\"\nreserve_s = 0\n\
         start = \"boat\"\ndestination = \"dock\"\ncurrent.still = true\nsonar.clutter_per_scan = 0\n\
         waypoints = [\n\
         {{ name = \"boat\", at = [0, 0, 20] }},\n\
         {{ name = \"a\", at = [600, 0, 20], tasks = [\"first\", \"second\"] }},\n\
         {{ name = \"b\", at = [600, 600, 20], tasks = [\"third\"] }},\n\
         {{ name = \"c\", at = [1200, 600, 20], task = \"fourth\" }},\n\
         {{ name = \"dock\", at = [1200, 0, 20] }},\n]\n\
         connect.nearest = 4\n{more}\n[tasks]\n{tasks}\n"
    )
}

const TASKS: [(&str, &str); 4] = [
    ("first", "priority = 4, risk = 1, time_s = 60"),
    ("second", "priority = 4, risk = 1, time_s = 60"),
    ("third", "priority = 4, risk = 1, time_s = 60"),
    ("fourth", "priority = 4, risk = 1, time_s = 60"),
];

/// The tasks, each with what is added to it.
fn tasks(added: &[(&str, &str)]) -> String {
    let line = |(name, keys): &(&str, &str)| {
        let more = added.iter().find(|(to, _)| to == name);
        let more = more.map_or(String::new(), |(_, more)| format!(", {more}"));
        format!("{name} = {{ {keys}{more} }}\n")
    };
    TASKS.iter().map(line).collect()
}

fn planners<T>(run: impl FnOnce(&Stepped<'_>) -> T) -> T {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    run(&Stepped::new(&routes, &paths))
}

fn checked(text: &str) -> LaunchCheck {
    let file = MissionFile::from_toml(text).unwrap();
    let (data, mut report) = (MissionData::default(), DataReport::default());
    planners(|driver| file.launch_check(&data, Seed(1), driver, &mut report)).unwrap()
}

/// The tasks done with the times at which they began, and how it ended.
fn flown(text: &str) -> (Vec<(String, f64)>, Summary) {
    let file = MissionFile::from_toml(text).unwrap();
    let scenario = file.scenario(&MissionData::default(), Seed(1)).unwrap();
    let summary = planners(|driver| simulate(&scenario, driver, &mut ())).unwrap();
    assert_eq!(
        summary.outcome,
        MissionOutcome::Docked,
        "{}",
        summary.reason
    );
    let works = file.works(&scenario.mission);
    let named = summary.timed_done.iter().map(|done| {
        let work = works.iter().find(|work| work.timed == Some(done.task));
        (work.unwrap().name.clone(), done.start_s)
    });
    (named.collect(), summary)
}

fn names(done: &[(String, f64)]) -> Vec<&str> {
    done.iter().map(|(name, _)| name.as_str()).collect()
}

#[test]
fn all_tasks_of_a_list_count_each_once() {
    let text = mission(&tasks(&[]), "budget_s = 4000");
    let (done, summary) = flown(&text);
    let mut sorted = names(&done);
    sorted.sort_unstable();
    assert_eq!(sorted, ["first", "fourth", "second", "third"]);
    assert_eq!((summary.tasks, summary.mission_weight), (4, 16.0));
    let check = checked(&text);
    assert!(check.go && check.left_out.is_empty(), "{check:?}");
    let planned_s = check.route.last().unwrap().leave_s;
    assert!(
        (planned_s / summary.time_s - 1.0).abs() < 0.1,
        "{planned_s}"
    );
}

#[test]
fn order_is_kept_where_the_short_way_is_another() {
    // The short way meets "first" before "fourth".
    let text = mission(
        &tasks(&[("first", "after = [\"fourth\"]")]),
        "budget_s = 6000",
    );
    let (done, _) = flown(&text);
    let at = |name| done.iter().position(|(done, _)| done == name).unwrap();
    assert!(at("fourth") < at("first"), "{done:?}");
}

#[test]
fn a_window_is_waited_for_and_the_work_begins_in_it() {
    let text = mission(
        &tasks(&[("third", "windows = [[0, 100], [1500, 1600]]")]),
        "budget_s = 4000",
    );
    let (done, _) = flown(&text);
    let third = done.iter().find(|(name, _)| name == "third").unwrap();
    assert!((1_500.0..=1_600.0).contains(&third.1), "{done:?}");
    // The same in UTC.
    let utc = "windows = [[\"2026-06-01T00:25:00Z\", \"2026-06-01T00:26:40Z\"]]";
    let launch = "budget_s = 4000\nlaunch = \"2026-06-01T00:00:00Z\"";
    let (done, _) = flown(&mission(&tasks(&[("third", utc)]), launch));
    let third = done.iter().find(|(name, _)| name == "third").unwrap();
    assert!((1_500.0..=1_600.0).contains(&third.1), "{done:?}");
    // It closes before the vehicle can be there.
    let text = mission(
        &tasks(&[("third", "windows = [[0, 100]]")]),
        "budget_s = 4000",
    );
    let (done, _) = flown(&text);
    assert!(
        !names(&done).contains(&"third") && done.len() == 3,
        "{done:?}"
    );
    let check = checked(&text);
    let third = check
        .tasks
        .iter()
        .find(|task| task.name == "third")
        .unwrap();
    assert!(check.go && !third.possible && check.left_out[0].reason == WhyLeftOut::Window);
}

#[test]
fn a_mandatory_task_goes_before_any_weight() {
    // Time for one side only: 800 s of travel to the dock over a, 1200 s over b and c.
    let poor = tasks(&[("third", "mandatory = true")])
        .replace("third = { priority = 4", "third = { priority = 0.1");
    let text = mission(&poor, "budget_s = 1500");
    let (done, _) = flown(&text);
    assert!(names(&done).contains(&"third"), "{done:?}");
    let free = mission(&poor.replace(", mandatory = true", ""), "budget_s = 1150");
    assert!(!names(&flown(&free).0).contains(&"third"));
}

#[test]
fn mandatory_tasks_that_cannot_all_go_are_refused_by_name() {
    let both = tasks(&[
        ("first", "mandatory = true, windows = [[0, 600]]"),
        (
            "fourth",
            "mandatory = true, windows = [[0, 1000]], after = [\"third\"]",
        ),
        ("third", "windows = [[900, 1000]]"),
    ]);
    let check = checked(&mission(&both, "budget_s = 4000"));
    assert!(!check.go, "{check:?}");
    assert!(
        check.problems[0].starts_with("tasks.fourth (mandatory, at c): "),
        "{:?}",
        check.problems
    );
    assert_eq!(check.latest_launch_s, None);
    let far = mission(
        &tasks(&[
            ("first", "mandatory = true"),
            ("fourth", "mandatory = true"),
        ]),
        "budget_s = 1130",
    );
    let check = checked(&far);
    assert!(
        !check.go && check.problems[0].contains("mandatory"),
        "{check:?}"
    );
    let easy = mission(
        &tasks(&[
            ("first", "mandatory = true"),
            ("fourth", "mandatory = true"),
        ]),
        "budget_s = 3000",
    );
    let check = checked(&easy);
    // A launch later than this leaves no time for both.
    let latest_s = check.latest_launch_s.unwrap();
    assert!(
        check.go && (1_000.0..2_100.0).contains(&latest_s),
        "{latest_s}"
    );
}

#[test]
fn wrong_keys_are_refused_with_their_place_and_remedy() {
    let refused = |tasks: &str, place: &str, parts: &[&str]| {
        let text = mission(tasks, "budget_s = 4000").replace("tasks = [\"third\"]", place);
        let file = MissionFile::from_toml(&text);
        let built = file.and_then(|file| file.scenario(&MissionData::default(), Seed(1)));
        let said = built.unwrap_err().to_string();
        for part in parts {
            assert!(said.contains(part), "{said}");
        }
    };
    let third = "tasks = [\"third\"]";
    refused(
        &tasks(&[("first", "windows = [[50, 10]]")]),
        third,
        &["tasks.first.windows[0]", "ascending"],
    );
    refused(
        &tasks(&[("first", "after = [\"nothing\"]")]),
        third,
        &["tasks.first.after", "nothing", "correct the name"],
    );
    refused(
        &tasks(&[
            ("first", "after = [\"third\"]"),
            ("third", "after = [\"first\"]"),
        ]),
        third,
        &["circle", "remove one `after`"],
    );
    refused(
        &tasks(&[]),
        "tasks = [\"third\"], task = \"first\"",
        &["both task and tasks", "keep one"],
    );
    refused(
        &tasks(&[]),
        "tasks = [\"third\", \"third\"]",
        &["twice", "once"],
    );
    refused(
        &tasks(&[]),
        "tasks = [\"fifth\"]",
        &["fifth", "correct the name"],
    );
    refused(
        &tasks(&[("first", "mandatory = 1")]),
        third,
        &["`mandatory` is 1", "true or false"],
    );
    let old = mission(&tasks(&[]), "budget_s = 4000").replace("version = 2", "version = 1");
    let said = MissionFile::from_toml(&old).unwrap_err().to_string();
    assert!(
        said.contains("waypoints.*.tasks") && said.contains("set version = 2"),
        "{said}"
    );
}

#[test]
fn what_comes_after_work_that_is_left_out_is_left_out_by_name() {
    // The start is never arrived at: its work is left out, and so is what comes after it.
    let added = [
        ("second", "after = [\"zero\"]"),
        ("fourth", "after = [\"second\"]"),
    ];
    let text = mission(&tasks(&added), "").replace(
        "\"boat\", at = [0, 0, 20]",
        "\"boat\", at = [0, 0, 20], task = \"zero\"",
    ) + "zero = { priority = 1, risk = 1, time_s = 0 }\n";
    let check = checked(&text);
    for (name, before) in [("second", "zero"), ("fourth", "second")] {
        let told = format!("its work is left out: it comes after {before}, which is left out");
        let warned = check
            .warnings
            .iter()
            .any(|w| w.starts_with(name) && w.contains(&told));
        assert!(warned, "{:?}", check.warnings);
        let left = check
            .left_out
            .iter()
            .find(|left| left.task == name)
            .unwrap();
        assert_eq!(left.reason, WhyLeftOut::Order);
    }
    let (done, _) = flown(&text);
    let names: Vec<&str> = done.iter().map(|(name, _)| &name[..]).collect();
    assert!(
        names.len() == 2 && !names.contains(&"second") && !names.contains(&"fourth"),
        "{names:?}"
    );
}
