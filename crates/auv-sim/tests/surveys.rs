//! Surveys, flown: lines are kept, the polygon is covered, and routes price them right.
#![cfg(feature = "mission-file")]
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_obstacles::TimedPoint;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{DataReport, LaunchCheck, MissionData, MissionFile};
use auv_sim::{Body, Entry, MissionOutcome, Recorder, Scenario, Summary, simulate};
use auv_types::{Point3, Seed};

#[derive(Default)]
struct Track(Vec<TimedPoint>);

impl Recorder for Track {
    fn record(&mut self, entry: Entry<'_>) {
        if let Entry::Flown { track, .. } = entry {
            self.0.extend_from_slice(track);
        }
    }
}

/// A boat, a survey, and a dock.
fn mission(survey: &str, more: &str) -> String {
    format!(
        "version = 2\nname = \"survey\"\npreset = \"default\"\nreserve_s = 300\n\
         start = \"boat\"\ndestination = \"dock\"\ncurrent.still = true\nsonar.clutter_per_scan = 0\n\
         waypoints = [\n\
         {{ name = \"boat\", at = [0, 0, 20] }},\n\
         {{ name = \"dock\", at = [100, 600, 20] }},\n]\n\
         edges = [{{ from = \"boat\", to = \"dock\" }}]\n{more}\n[[surveys]]\n{survey}\n"
    )
}

fn planners<T>(run: impl FnOnce(&Stepped<'_>) -> T) -> T {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    run(&Stepped::new(&routes, &paths))
}

struct Flown {
    scenario: Scenario,
    track: Vec<TimedPoint>,
    summary: Summary,
    check: LaunchCheck,
    done: Vec<(String, bool)>,
}

fn flown(text: &str, body: Body) -> Flown {
    let file = MissionFile::from_toml(text).unwrap().with_body(body);
    let (data, mut report) = (MissionData::default(), DataReport::default());
    let check = planners(|driver| file.launch_check(&data, Seed(1), driver, &mut report)).unwrap();
    let scenario = file.scenario(&data, Seed(1)).unwrap();
    let mut track = Track::default();
    let summary = planners(|driver| simulate(&scenario, driver, &mut track)).unwrap();
    let works = file.works(&scenario.mission);
    let names = works.into_iter().map(|work| work.name);
    let done = names.zip(file.works_done(&scenario.mission, &summary));
    let done = done.collect();
    Flown {
        scenario,
        track: track.0,
        summary,
        check,
        done,
    }
}

/// Distance of a place from a segment, seen from above, metres.
fn off_m(p: &Point3<f64>, a: &Point3<f64>, b: &Point3<f64>) -> f64 {
    let (way, offset) = ((b - a).xy(), (p - a).xy());
    let share = (offset.dot(&way) / way.norm_squared().max(1e-9)).clamp(0.0, 1.0);
    (offset - way * share).norm()
}

/// The greatest distance of the points of lines from the track, metres.
fn worst_off_line_m(flown: &Flown) -> f64 {
    let mission = &flown.scenario.mission;
    let mut worst_m: f64 = 0.0;
    for &arc in &mission.courses.lines {
        let edge = mission.network.arcs()[arc.index()];
        let ends = [edge.tail, edge.head].map(|node| mission.position_of(node));
        let guide = mission.guides.get(&arc).map_or(&ends[..], Vec::as_slice);
        for pair in guide.windows(2) {
            for k in 0..=20 {
                let place = pair[0] + (pair[1] - pair[0]) * (f64::from(k) / 20.0);
                let near = flown.track.windows(2);
                let near = near.map(|leg| off_m(&place, &leg[0].position, &leg[1].position));
                worst_m = worst_m.max(near.fold(f64::INFINITY, f64::min));
            }
        }
    }
    worst_m
}

/// The share of a polygon that lies within half the spacing, and what lines may be off, of the track.
fn covered(flown: &Flown, polygon: &[(f64, f64)], reach_m: f64) -> f64 {
    let inside = |x: f64, y: f64| {
        let mut odd = false;
        for (i, a) in polygon.iter().enumerate() {
            let b = polygon[(i + 1) % polygon.len()];
            if (a.1 > y) != (b.1 > y) && x < (b.0 - a.0) * (y - a.1) / (b.1 - a.1) + a.0 {
                odd = !odd;
            }
        }
        odd
    };
    let (mut all, mut seen) = (0, 0);
    for i in 0..100 {
        for j in 0..100 {
            let (x, y) = (8.0 * f64::from(i) + 4.0, 8.0 * f64::from(j) + 4.0);
            if !inside(x, y) {
                continue;
            }
            all += 1;
            let place = Point3::new(x, y, 0.0);
            let near =
                |leg: &[TimedPoint]| off_m(&place, &leg[0].position, &leg[1].position) <= reach_m;
            seen += u32::from(flown.track.windows(2).any(near));
        }
    }
    f64::from(seen) / f64::from(all)
}

const BOX: [(f64, f64); 4] = [
    (200.0, 100.0),
    (600.0, 100.0),
    (600.0, 400.0),
    (200.0, 400.0),
];
const POLYGON: &str = "polygon = [[200, 100], [600, 100], [600, 400], [200, 400]]";

#[test]
fn a_box_is_covered_by_both_bodies() {
    let survey = format!(
        "name = \"box\"\n{POLYGON}\nspacing_m = 40\nheading_deg = 0\ndepth_m = 15\npriority = 5\nrisk = 1\nmandatory = true"
    );
    for (body, most_m) in [(Body::Point, 2.0), (Body::Remus100, 4.0)] {
        let flown = flown(&mission(&survey, "budget_s = 7200"), body);
        assert!(flown.check.go, "{:?}", flown.check.problems);
        assert_eq!(
            flown.summary.outcome,
            MissionOutcome::Docked,
            "{}",
            flown.summary.reason
        );
        assert!(flown.done.iter().all(|(_, done)| *done), "{:?}", flown.done);
        assert_eq!(flown.done.len(), 8);
        let off_m = worst_off_line_m(&flown);
        assert!(off_m <= most_m, "{body:?} {off_m}");
        let covered = covered(&flown, &BOX, 20.0 + most_m);
        assert!(covered >= 0.99, "{body:?} {covered}");
        assert!((flown.summary.mission_weight - 5.0).abs() < 1e-9);
        let planned_s = flown.check.route.last().unwrap().leave_s;
        let error = planned_s / flown.summary.time_s - 1.0;
        assert!(
            error.abs() < 0.1,
            "{body:?} {planned_s} {}",
            flown.summary.time_s
        );
    }
}

#[test]
fn a_survey_follows_the_bed_and_a_corridor_its_cable() {
    let bed = "budget_s = 7200\nbox = { north_m = [-300, 1200], east_m = [-300, 1200], depth_m = [2, 200] }\n\
        altitude = { least_m = 3, sigmas = 0 }\n[sea_bed.analytic]\nbase_depth_m = 60\nsigma = { least_m = 0, relative = 0 }\n\
        features = [{ name = \"slope\", shape.beyond = { through = [200, 0], towards = [300, 0] }, depth_m = 120, skirt_m = 400, effect = \"dig\" }]";
    let survey = "name = \"cable\"\ncorridor = { along = [[100, 0], [400, 100], [700, 100]], width_m = 60 }\n\
        spacing_m = 30\naltitude_m = 12\npriority = 5\nrisk = 1";
    let flown = flown(&mission(survey, bed), Body::Point);
    assert_eq!(
        flown.summary.outcome,
        MissionOutcome::Docked,
        "{}",
        flown.summary.reason
    );
    assert!(flown.done.iter().all(|(_, done)| *done), "{:?}", flown.done);
    let off_m = worst_off_line_m(&flown);
    assert!(off_m <= 2.0, "{off_m}");
    let bed = flown.scenario.mission.sea_bed.as_ref().unwrap();
    let raised_m = 0.7 * flown.scenario.guidance_error_m;
    let mut worst_m: f64 = 0.0;
    for &arc in &flown.scenario.mission.courses.lines {
        let guide = &flown.scenario.mission.guides[&arc];
        for point in &flown.track {
            let p = &point.position;
            let on_line = guide.windows(2).any(|pair| off_m_of(p, pair) < 1.0);
            let middle = (150.0..650.0).contains(&p.x);
            if on_line && middle {
                let altitude_m = bed.depth_at(p.x, p.y) + raised_m - p.z;
                worst_m = worst_m.max((altitude_m - 12.0).abs());
            }
        }
    }
    assert!(
        worst_m > 0.0 && worst_m <= 1.0 + flown.scenario.guidance_error_m,
        "{worst_m}"
    );
}

#[test]
fn short_lines_follow_a_bed_that_bends() {
    let bed = "budget_s = 7200\nguidance_error_m = 0\nbox = { north_m = [-300, 1200], east_m = [-300, 1200], depth_m = [1, 200] }\n\
        altitude = { least_m = 3, sigmas = 0 }\n[sea_bed.analytic]\nbase_depth_m = 35\nsigma = { least_m = 0, relative = 0 }\n\
        features = [{ name = \"slope\", shape.beyond = { through = [600, 0], towards = [700, 0] }, depth_m = 75, skirt_m = 400, effect = \"dig\" }]";
    let survey = "name = \"bank\"\npolygon = [[220, 100], [420, 100], [420, 250], [220, 250]]\n\
        heading_deg = 0\nspacing_m = 50\naltitude_m = 15\npriority = 5\nrisk = 1";
    for body in Body::ALL {
        let flown = flown(&mission(survey, bed), body);
        assert!(flown.done.iter().all(|(_, done)| *done), "{:?}", flown.done);
        let bed = flown.scenario.mission.sea_bed.as_ref().unwrap();
        let mut seen = 0;
        for point in &flown.track {
            let p = &point.position;
            let lines =
                [125.0, 175.0, 225.0].map(|y| [220.0, 420.0].map(|x| Point3::new(x, y, 0.0)));
            let on_line = lines.iter().any(|pair| off_m_of(p, pair) < 1.0);
            if on_line && (240.0..400.0).contains(&p.x) {
                let off_m = bed.depth_at(p.x, p.y) - p.z - 15.0;
                assert!(off_m.abs() <= 1.0, "{body:?} {point:?} {off_m}");
                seen += 1;
            }
        }
        assert!(seen > 300, "{seen}");
    }
}

fn off_m_of(p: &Point3<f64>, pair: &[Point3<f64>]) -> f64 {
    off_m(p, &pair[0], &pair[1])
}

#[test]
fn a_survey_with_windows_begins_in_one() {
    let survey = format!(
        "name = \"box\"\n{POLYGON}\nspacing_m = 80\ndepth_m = 15\npriority = 5\nrisk = 1\nwindows = [[1500, 1600]]"
    );
    let flown = flown(&mission(&survey, "budget_s = 7200"), Body::Point);
    assert_eq!(flown.summary.outcome, MissionOutcome::Docked);
    let first = flown.summary.timed_done.first().unwrap();
    assert!((1_500.0..=1_600.0).contains(&first.start_s), "{first:?}");
    assert!(flown.done.iter().all(|(_, done)| *done), "{:?}", flown.done);
}

#[test]
fn a_survey_too_long_for_the_budget_is_split_or_left_out() {
    let survey = |split: bool| {
        format!(
            "name = \"box\"\n{POLYGON}\nspacing_m = 40\ndepth_m = 15\npriority = 5\nrisk = 1\nsplit = {split}"
        )
    };
    let count = |split| {
        let flown = flown(&mission(&survey(split), "budget_s = 2200"), Body::Point);
        assert_eq!(flown.summary.outcome, MissionOutcome::Docked);
        flown.done.iter().filter(|(_, done)| *done).count()
    };
    assert_eq!(count(false), 0);
    assert!((1..8).contains(&count(true)));
}

/// Two surveys and a cast, each away from start and dock.
fn two_surveys(connect: usize) -> String {
    let survey = |name: &str, n: f64, e: f64| {
        let m = n + 200.0;
        let f = e + 160.0;
        format!(
            "[[surveys]]\nname = \"{name}\"\npolygon = [[{n}, {e}], [{m}, {e}], [{m}, {f}], [{n}, {f}]]\n\
             spacing_m = 40\ndepth_m = 15\npriority = 5\nrisk = 1\n"
        )
    };
    format!(
        "version = 2\nname = \"two\"\npreset = \"default\"\nbudget_s = 12000\nstart = \"boat\"\ndestination = \"dock\"\n\
         current.still = true\nsonar.clutter_per_scan = 0\nconnect.nearest = {connect}\n\
         waypoints = [\n{{ name = \"boat\", at = [0, 0, 15] }},\n{{ name = \"cast\", at = [-900, -700, 15], task = \"cast\" }},\n\
         {{ name = \"dock\", at = [50, 100, 15] }},\n]\ntasks.cast = {{ priority = 1, risk = 1, time_s = 60 }}\n{}{}",
        survey("north", 700.0, -300.0),
        survey("east", 100.0, 900.0)
    )
}

#[test]
fn several_surveys_and_far_waypoints_are_done_in_one_mission() {
    for connect in 1..=3 {
        let file = MissionFile::from_toml(&two_surveys(connect)).unwrap();
        let (data, mut report) = (MissionData::default(), DataReport::default());
        let check = planners(|driver| file.launch_check(&data, Seed(1), driver, &mut report));
        let check = check.unwrap();
        assert!(
            check.go && check.left_out.is_empty(),
            "{:?}",
            check.left_out
        );
        assert_eq!(check.tasks.len(), 4 + 4 + 1);
    }
}

#[test]
fn a_survey_that_is_too_long_even_alone_is_told_as_a_whole() {
    let text = two_surveys(2).replace("budget_s = 12000", "budget_s = 1800");
    let file = MissionFile::from_toml(&text).unwrap();
    let (data, mut report) = (MissionData::default(), DataReport::default());
    let check = planners(|driver| file.launch_check(&data, Seed(1), driver, &mut report)).unwrap();
    assert!(check.go);
    // 800 m there, 900 m of lines with their turns, and 700 m home take more than 1,530 s.
    let lines = check.tasks.iter().filter(|task| task.survey.is_some());
    let mut lines = lines.peekable();
    assert!(lines.peek().is_some());
    for line in lines {
        let reason = line.reason.as_deref().unwrap_or_default();
        assert!(!line.possible && reason.contains("s too late"), "{line:?}");
    }
}

#[test]
fn the_dock_is_reached_on_its_course() {
    let text = "version = 2\nname = \"docking\"\npreset = \"default\"\nbudget_s = 4000\n\
        start = \"boat\"\ndocks = [\"far\", \"near\"]\ncurrent.still = true\nsonar.clutter_per_scan = 0\n\
        waypoints = [\n{ name = \"boat\", at = [0, 0, 20] },\n{ name = \"a\", at = [600, 0, 20], task = \"cast\" },\n\
        { name = \"far\", at = [0, 2500, 20] },\n{ name = \"near\", at = [600, 500, 20] },\n]\n\
        connect.nearest = 3\ntasks.cast = { priority = 4, risk = 1, time_s = 60 }\n\
        docking = { heading_deg = 180, lead_in_m = 80 }\n";
    for body in Body::ALL {
        let file = MissionFile::from_toml(text).unwrap().with_body(body);
        let scenario = file.scenario(&MissionData::default(), Seed(1)).unwrap();
        let mut track = Track::default();
        let summary = planners(|driver| simulate(&scenario, driver, &mut track)).unwrap();
        assert_eq!(
            summary.outcome,
            MissionOutcome::Docked,
            "{}",
            summary.reason
        );
        let dock = Point3::new(600.0, 500.0, 20.0);
        let end = track.0.last().unwrap();
        assert!((end.position - dock).norm() < 10.0, "{end:?}");
        for point in &track.0 {
            let left_m = point.position.x - dock.x;
            let in_lead = (point.position - dock).norm() < 75.0;
            let near_end = end.time_s - point.time_s < 50.0;
            if in_lead && near_end {
                assert!(
                    left_m > -5.0 && (point.position.y - dock.y).abs() < 5.0,
                    "{body:?} {point:?}"
                );
            }
        }
    }
}

#[test]
fn wrong_surveys_are_refused_with_place_and_remedy() {
    let right =
        format!("name = \"box\"\n{POLYGON}\nspacing_m = 40\ndepth_m = 15\npriority = 5\nrisk = 1");
    let cases = [
        ("spacing_m = 40", "spacing_m = 0", "spacing_m"),
        (
            "depth_m = 15",
            "",
            "neither depth_m nor altitude_m; give one of them",
        ),
        ("depth_m = 15", "altitude_m = 15", "sea_bed"),
        (
            POLYGON,
            "",
            "neither polygon nor corridor; give one of them",
        ),
        (POLYGON, "polygon = [[0, 0], [100, 0]]", "at least 3"),
        (
            POLYGON,
            "polygon = [[0, 0], [100, 100], [100, 0], [0, 100]]",
            "crosses itself",
        ),
        (POLYGON, "polygon = [[0, 0], [100, 0], [200, 0]]", "no area"),
        (
            POLYGON,
            "corridor = { along = [[0, 0]], width_m = 10 }",
            "at least 2",
        ),
        ("risk = 1", "risk = 0", "risk"),
        ("risk = 1", "risk = 1\nheading_deg = \"north\"", "best"),
        ("risk = 1", "risk = 1\nwindows = [[5, 1]]", "windows[0]"),
        ("risk = 1", "risk = 1\norder = \"zigzag\"", "any"),
        ("name = \"box\"", "name = \"\"", "name"),
    ];
    for (from, to, part) in cases {
        let text = mission(&right.replacen(from, to, 1), "budget_s = 7200");
        let file = MissionFile::from_toml(&text);
        let built = file.and_then(|file| file.scenario(&MissionData::default(), Seed(1)));
        let said = built.unwrap_err().to_string();
        assert!(said.contains(part) && !said.contains('\n'), "{to}: {said}");
    }
}
