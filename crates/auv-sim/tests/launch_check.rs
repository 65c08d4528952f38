//! What is said before the launch against what is flown.
#![cfg(feature = "mission-file")]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that fails should say where"
)]

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{DataReport, LaunchCheck, MissionData, MissionFile, WhyLeftOut};
use auv_sim::{MissionOutcome, Summary, simulate};
use auv_types::Seed;
use auv_types::rand::RngExt;

fn with_planners<T>(run: impl FnOnce(&Stepped<'_>) -> T) -> T {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    run(&Stepped::new(&routes, &paths))
}

fn checked(text: &str) -> LaunchCheck {
    let file = MissionFile::from_toml(text).unwrap();
    let (data, mut report) = (MissionData::default(), DataReport::default());
    with_planners(|driver| file.launch_check(&data, Seed(1), driver, &mut report)).unwrap()
}

fn flown(text: &str) -> Summary {
    let file = MissionFile::from_toml(text).unwrap();
    let scenario = file.scenario(&MissionData::default(), Seed(1)).unwrap();
    with_planners(|driver| simulate(&scenario, driver, &mut ())).unwrap()
}

/// A mission in still, empty water with work at waypoints and on edges, and mostly too much of it.
fn random_mission(seed: u64) -> String {
    let mut random = Seed(seed).stream(7);
    let count = random.random_range(3..9);
    let mut draw = |low: f64, high: f64| random.random_range(low..high);
    let size_m = draw(400.0, 2_500.0);
    let (mut waypoints, mut tasks) = (String::new(), String::new());
    for i in 0..count {
        let at = [draw(0.0, size_m), draw(0.0, size_m), draw(5.0, 60.0)];
        let is_inner = i > 0 && i + 1 < count;
        let work = (is_inner && draw(0.0, 1.0) < 0.7).then(|| {
            let (priority, time_s) = (draw(1.0, 9.0), draw(0.0, 400.0));
            tasks +=
                &format!("tasks.t{i} = {{ priority = {priority}, risk = 1, time_s = {time_s} }}\n");
            format!(", task = \"t{i}\"")
        });
        let work = work.unwrap_or_default();
        waypoints += &format!("{{ name = \"w{i}\", at = {at:?}{work} }},\n");
    }
    let last = count - 1;
    let budget_s = draw(1.2, 5.0) * size_m;
    format!(
        "version = 1\nname = \"random\"\npreset = \"default\"\nbudget_s = {budget_s}\n\
         start = \"w0\"\ndestination = \"w{last}\"\nwaypoints = [\n{waypoints}]\n\
         edges = [{{ from = \"w1\", to = \"w2\", task = \"line\" }}]\n{tasks}\
         tasks.line = {{ priority = 5, risk = 1, time_s = 100 }}\n\
         connect.nearest = 4\ncurrent.still = true\nsonar.clutter_per_scan = 0\n"
    )
}

#[test]
fn times_before_launch_are_within_a_tenth_of_what_is_flown() {
    let (mut compared, mut worst) = (0, 0.0_f64);
    for seed in 0..80 {
        let text = random_mission(seed);
        let check = checked(&text);
        if !check.go {
            assert!(
                !check.problems.is_empty() && check.route.is_empty(),
                "seed {seed}"
            );
            continue;
        }
        let summary = flown(&text);
        assert_eq!(summary.outcome, MissionOutcome::Docked, "seed {seed}");
        let planned: Vec<_> = check.route.iter().map(|stop| stop.place.clone()).collect();
        let flown: Vec<_> = summary
            .visited
            .iter()
            .map(|node| format!("w{}", node.0))
            .collect();
        // Routes found better on the way are told too.
        assert_eq!(planned, flown, "seed {seed}");
        compared += 1;
        let home_s = check.route.last().unwrap().leave_s;
        worst = worst.max((home_s / summary.time_s - 1.0).abs());
        let legs = summary.path_calls.iter().filter(|leg| leg.completed);
        let legs = check.route[1..].iter().zip(legs);
        for (stop, leg) in legs {
            let error = (stop.leave_s - leg.at_s - leg.leg_s).abs();
            assert!(
                error < 0.1 * (leg.at_s + leg.leg_s),
                "seed {seed}: {stop:?}"
            );
        }
        let done: usize = check.route.iter().map(|stop| stop.tasks.len()).sum();
        assert_eq!(done, summary.tasks, "seed {seed}");
        assert_eq!(
            done + check.left_out.len(),
            check.tasks.len(),
            "seed {seed}"
        );
    }
    assert!(
        compared >= 50 && worst < 0.05,
        "{compared} missions, {worst}"
    );
}

/// Two stations on the way along a line, and a third far off.
fn mission(more: &str) -> String {
    format!(
        "version = 1\nname = \"stations\"\npreset = \"default\"\nreserve_s = 0\n\
         start = \"boat\"\ndestination = \"dock\"\nwaypoints = [\n\
         {{ name = \"boat\", at = [0, 0, 20] }},\n\
         {{ name = \"near\", at = [900, 100, 20], task = \"cast\" }},\n\
         {{ name = \"far\", at = [900, 9000, 20], task = \"cast\" }},\n\
         {{ name = \"dock\", at = [1800, 0, 20] }},\n]\n\
         tasks.cast = {{ priority = 5, risk = 1, time_s = 60 }}\nconnect.nearest = 3\n{more}\n"
    )
}

#[test]
fn work_that_is_too_far_is_not_possible_and_says_by_how_much() {
    let check = checked(&mission("budget_s = 3600\ncurrent.still = true"));
    assert!(check.go, "{:?}", check.problems);
    let (near, far) = (&check.tasks[0], &check.tasks[1]);
    assert!(near.possible && near.reason.is_none());
    let why = far.reason.as_deref().unwrap();
    assert!(
        !far.possible && why.contains("too late") && why.contains("budget_s"),
        "{why}"
    );
    assert_eq!(check.left_out.len(), 1);
    assert_eq!(check.left_out[0].reason, WhyLeftOut::Time);
    let margin_s = check.margin_s.unwrap();
    assert!((margin_s + check.route.last().unwrap().leave_s - 3600.0).abs() < 1e-9);
    // Straight home takes 1200 s of the 3600 s.
    let latest_s = check.latest_launch_s.unwrap();
    assert!((2_390.0..=2_400.0).contains(&latest_s), "{latest_s}");
}

#[test]
fn no_time_to_get_home_is_an_answer_and_wrong_values_are_errors() {
    let check = checked(&mission("budget_s = 1000\ncurrent.still = true"));
    assert!(!check.go && check.route.is_empty() && check.margin_s.is_none());
    assert!(
        check.problems[0].contains("quickest way home"),
        "{:?}",
        check.problems
    );
    assert_eq!(check.latest_launch_s, None);
    let below = mission(
        "budget_s = 3600\nbox = { north_m = [-500, 9500], east_m = [-500, 9500], depth_m = [0, 60] }\nsea_bed.flat_m = 22",
    );
    let check = checked(&below);
    assert!(
        !check.go && check.problems[0].contains("waypoints[0] (boat)"),
        "{:?}",
        check.problems
    );
    assert!(check.tasks.len() == 2 && check.tasks.iter().all(|task| !task.possible));
    let file = MissionFile::from_toml(&mission("budget_s = -5")).unwrap();
    let (data, mut report) = (MissionData::default(), DataReport::default());
    let wrong = with_planners(|driver| file.launch_check(&data, Seed(0), driver, &mut report));
    assert!(wrong.unwrap_err().to_string().contains("budget_s"));
}

#[test]
fn a_tide_that_keeps_the_vehicle_from_home_says_when_to_launch() {
    // 2.5 m/s against the vehicle at the launch, with it six hours later.
    let tide = "current = { truth = { gain = 1, delay_s = 0 }, analytic.tide = [{ major_mps = [-2.5, 0], period_s = 44714, strongest_s = 0 }] }";
    let check = checked(&mission(&format!("budget_s = 3600\n{tide}")));
    assert!(!check.go, "{check:?}");
    let said = &check.problems[0];
    let later: f64 = said
        .split_once("launch ")
        .and_then(|(_, rest)| rest.split(' ').next()?.parse().ok())
        .unwrap();
    assert!((3_000.0..12_000.0).contains(&later), "{said}");
}

#[test]
fn a_spur_from_which_nothing_leads_on_is_no_way() {
    let text = "version = 1\nname = \"spur\"\npreset = \"default\"\nbudget_s = 9000\nstart = \"a\"\n\
        destination = \"b\"\nwaypoints = [{ name = \"a\", at = [0, 0, 9] }, { name = \"m\", at = [500, 0, 9] },\n\
        { name = \"end\", at = [500, 500, 9], task = \"look\" }, { name = \"b\", at = [1000, 0, 9] }]\n\
        edges = [{ from = \"a\", to = \"m\" }, { from = \"m\", to = \"end\" }, { from = \"m\", to = \"b\" }]\n\
        tasks.look = { priority = 5, risk = 1, time_s = 0 }\ncurrent.still = true\n";
    let check = checked(text);
    assert!(check.go, "{:?}", check.problems);
    assert!(!check.tasks[0].possible, "{check:?}");
    assert_eq!(check.left_out[0].reason, WhyLeftOut::NoWay);
}

#[test]
fn what_no_route_does_beside_the_rest_is_not_put_down_to_time() {
    let text = |budget_s: u32, only: &str| {
        let text = format!(
            "version = 1\nname = \"fork\"\npreset = \"default\"\nbudget_s = {budget_s}\nstart = \"boat\"\ndestination = \"dock\"\n\
             waypoints = [\n{{ name = \"boat\", at = [0, 0, 10] }},\n{{ name = \"a\", at = [500, 300, 10], task = \"look\" }},\n\
             {{ name = \"b\", at = [500, -300, 10], task = \"cast\" }},\n{{ name = \"dock\", at = [1000, 0, 10] }},\n]\n\
             edges = [\n{{ from = \"boat\", to = \"a\" }},\n{{ from = \"a\", to = \"dock\" }},\n\
             {{ from = \"boat\", to = \"b\" }},\n{{ from = \"b\", to = \"dock\" }},\n]\n\
             tasks.look = {{ priority = 3, risk = 1, time_s = 60 }}\ntasks.cast = {{ priority = 2, risk = 1, time_s = 60 }}\n\
             current.still = true\nsonar.clutter_per_scan = 0\n"
        );
        text.replace("\" },\n{ from", &format!("\"{only} }},\n{{ from"))
            .replace("\"dock\" },\n]", &format!("\"dock\"{only} }},\n]"))
    };
    // Where edges lead back, a later route does what the first leaves out.
    assert!(checked(&text(9_000, "")).left_out.is_empty());
    let one_way = ", directed = true";
    for (budget_s, why) in [(9_000, WhyLeftOut::NoWay), (1_300, WhyLeftOut::Time)] {
        let check = checked(&text(budget_s, one_way));
        let [left] = &check.left_out[..] else {
            panic!("{:?}", check.left_out);
        };
        assert_eq!(
            (left.task.as_str(), left.reason),
            ("cast", why),
            "{}",
            left.text
        );
        assert!(check.tasks.iter().all(|task| task.possible));
    }
}

/// Work at one place that comes after work at the next: no route that passes each waypoint once does both.
fn there_and_back(more: &str) -> String {
    format!(
        "version = 2\nname = \"there and back\"\npreset = \"default\"\nbudget_s = 9000\nstart = \"boat\"\n\
         destination = \"dock\"\nwaypoints = [\n{{ name = \"boat\", at = [0, 0, 20] }},\n\
         {{ name = \"mooring\", at = [600, 0, 20], task = \"recover\" }},\n\
         {{ name = \"buoy\", at = [1200, 300, 20], task = \"release\" }},\n\
         {{ name = \"bend\", at = [900, -300, 20] }},\n{{ name = \"dock\", at = [600, -600, 20] }},\n]\n\
         edges = [{{ from = \"boat\", to = \"mooring\" }}, {{ from = \"mooring\", to = \"buoy\" }}, \
         {{ from = \"buoy\", to = \"bend\" }}, {{ from = \"bend\", to = \"mooring\" }}, \
         {{ from = \"mooring\", to = \"dock\" }}, {{ from = \"bend\", to = \"dock\" }}]\n\
         tasks.release = {{ priority = 5, risk = 1, time_s = 60 }}\n\
         tasks.recover = {{ priority = 5, risk = 1, time_s = 300, after = [\"release\"] }}\n\
         box = {{ north_m = [-500, 1800], east_m = [-1200, 900], depth_m = [2, 60] }}\nsea_bed.flat_m = 80\n\
         sonar.clutter_per_scan = 0\n{more}\n"
    )
}

const STILL: &str = "current.still = true";

#[test]
fn work_that_only_a_later_route_does_is_told_with_its_time() {
    let text = there_and_back(STILL);
    let (check, summary) = (checked(&text), flown(&text));
    assert!(check.go && check.left_out.is_empty(), "{check:?}");
    let done: Vec<_> = check.route.iter().filter(|s| !s.tasks.is_empty()).collect();
    let told: Vec<_> = done.iter().map(|s| (&*s.place, &*s.tasks[0])).collect();
    assert_eq!(told, [("buoy", "release"), ("mooring", "recover")]);
    assert_eq!(summary.tasks, 2);
    let home_s = check.route.last().unwrap().leave_s;
    assert!((home_s / summary.time_s - 1.0).abs() < 0.01, "{home_s}");
    assert!((check.margin_s.unwrap() - (9_000.0 - home_s)).abs() < 1e-9);
}

#[test]
fn fixes_at_the_surface_are_told_as_they_are_flown() {
    for more in [
        "surface.every_s = 450",
        "navigation = { drift_percent = 1, most_error_m = 5 }",
    ] {
        let text = there_and_back(&format!("{STILL}\n{more}"));
        let (check, summary) = (checked(&text), flown(&text));
        let fixes_s: f64 = check.route.iter().map(|stop| stop.fixes_s).sum();
        assert!(fixes_s > 100.0, "{more}: {check:?}");
        let home_s = check.route.last().unwrap().leave_s;
        let error = (home_s / summary.time_s - 1.0).abs();
        assert!(error < 0.1, "{more}: {home_s} s, {} s", summary.time_s);
    }
}

#[test]
fn a_wait_for_a_window_is_told_at_its_stop() {
    let text =
        there_and_back(STILL).replace("time_s = 60", "time_s = 60, windows = [[2000, 3000]]");
    let check = checked(&text);
    let buoy = check
        .route
        .iter()
        .find(|stop| stop.place == "buoy")
        .unwrap();
    assert!((buoy.leave_s - 2_060.0).abs() < 3.0, "{check:?}");
    assert!(
        (buoy.arrive_s + buoy.waits_s - 2_000.0).abs() < 3.0,
        "{check:?}"
    );
}

#[test]
fn the_true_sea_is_not_told_before_the_launch() {
    let current = |gain: f64| {
        format!(
            "current = {{ truth = {{ gain = {gain}, delay_s = 0 }}, analytic.tide = [{{ major_mps = [0.4, 0.2], period_s = 44714, strongest_s = 0 }}] }}"
        )
    };
    let clear = checked(&there_and_back(&current(1.0)));
    let stone = "obstacles = [{ class = \"uncertain\", at = [900, 150, 20], radius_m = 60 }]";
    for more in [current(2.0), format!("{}\n{stone}", current(1.0))] {
        let text = there_and_back(&more);
        assert_eq!(checked(&text), clear, "{more}");
        assert!((flown(&text).time_s - clear.route.last().unwrap().leave_s).abs() > 1.0);
    }
}

/// From deep down the way to the surface and back takes nearly all the time between two fixes: no route tells.
#[test]
fn a_mission_that_is_late_in_the_sea_as_forecast_does_not_go() {
    for (every_s, goes) in [(420, false), (560, true)] {
        let text = there_and_back(&format!("{STILL}\nsurface.every_s = {every_s}"));
        let places = ["[600, 0, ", "[1200, 300, ", "[900, -300, "];
        let text = places.iter().fold(text, |text, at| {
            text.replace(&format!("{at}20]"), &format!("{at}56]"))
        });
        let text = text
            .replace("time_s = 60", "time_s = 0")
            .replace("time_s = 300", "time_s = 0");
        let (check, summary) = (checked(&text), flown(&text));
        assert_eq!(check.go, goes, "{check:?}");
        assert_eq!(summary.outcome == MissionOutcome::Docked, goes);
        if !goes {
            assert!(check.problems[0].contains("as forecast"), "{check:?}");
            assert!(check.latest_launch_s.is_none() && !check.route.is_empty());
        }
    }
}

#[test]
fn waypoints_at_one_place_are_told_but_for_the_start_at_the_dock() {
    let told = |text: &str| checked(text).warnings;
    let text = there_and_back(STILL);
    assert_eq!(told(&text), [] as [String; 0]);
    let slip = text.replace("[900, -300, 20]", "[1200, 300, 20]");
    assert!(
        told(&slip)[0].starts_with("waypoints buoy and bend are at one place"),
        "{:?}",
        told(&slip)
    );
    let home = text.replace("[600, -600, 20]", "[0, 0, 20]");
    assert_eq!(told(&home), [] as [String; 0]);
}
