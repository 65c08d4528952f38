//! Mistakes in mission files give one message with the place and the remedy.

use crate::{documented, scenario};
use auv_sim::mission_file::{DataFile, MissionData, MissionFile, MissionFileError};
use auv_types::Seed;

/// The error of the document's mission with all features after a replacement in its text.
fn answer(old: &str, new: &str) -> String {
    let text = documented()[1];
    assert_eq!(text.matches(old).count(), 1, "{old}");
    match scenario(&text.replace(old, new)) {
        Ok(_) => panic!("accepted: {new}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn every_mistake_is_reported_with_its_place_and_a_remedy() {
    // The text replaced, its replacement, and parts of the message.
    let mistakes: [(&str, &str, &[&str]); 70] = [
        (
            "version = 1",
            "version = 3",
            &["version = 3", "give version = 1 or 2"],
        ),
        ("version = 1", "", &["version", "missing"]),
        ("version = 1", "version = \"1\"", &["give version = 1"]),
        ("\"everything\"", "\"everything", &["line 2", "string"]),
        (
            "budget_s = 7200",
            "budgit_s = 7200",
            &["line 8", "`budgit_s`", "`budget_s`"],
        ),
        (
            "budget_s = 7200",
            "budget_s = \"7200\"",
            &["line 8", "give a number"],
        ),
        (
            "budget_s = 7200",
            "budget_s = nan",
            &["budget_s is NaN; give"],
        ),
        (
            "budget_s = 7200",
            "budget_s = -1",
            &["budget_s is -1; give"],
        ),
        (
            "budget_s = 7200",
            "budget_s = 1e300",
            &["budget_s is", "give"],
        ),
        (
            "budget_s = 7200",
            "budget_s = 1500",
            &["budget_s", "less than the quickest way home; give more"],
        ),
        (
            "reserve_s = 600",
            "reserve_s = 7200",
            &["reserve_s is 7200; give", "less than budget_s"],
        ),
        (
            "tick_s = 1",
            "tick_s = 1e-9",
            &["tick_s is", "give 0.05 to 600"],
        ),
        (
            "guidance_error_m = 2",
            "guidance_error_m = -2",
            &["guidance_error_m is -2; give"],
        ),
        (
            "clearance_m = 0",
            "clearance_m = 1e9",
            &["clearance_m is", "give"],
        ),
        (
            "random_obstacles = 2",
            "random_obstacles = 99999999",
            &["at most 10000"],
        ),
        (
            "random_obstacles = 2",
            "random_obstacles = -2",
            &["line 13", "-2"],
        ),
        (
            "\"default\"",
            "\"deflt\"",
            &["line 5", "did you mean `default`"],
        ),
        (
            "start = \"boat\"",
            "start = \"bot\"",
            &["start names the waypoint bot", "correct the name"],
        ),
        (
            "start = \"boat\"",
            "start = \"dock\"",
            &["destination is the start", "second waypoint"],
        ),
        (
            "at = [1800, 100, 20]",
            "at = [1000, 1000, 20]",
            &["waypoints[4] (gate)", "on land", "move it"],
        ),
        (
            "at = [1800, 100, 20]",
            "at = [1800, 100, 99]",
            &["waypoints[4] (gate)", "deepest allowed", "raise it"],
        ),
        (
            "at = [1800, 100, 20]",
            "at = [9800, 100, 20]",
            &["waypoints[4] (gate)", "outside the box", "move it"],
        ),
        (
            "at = [1800, 100, 20]",
            "at = [1800]",
            &["line", "[north, east, depth]"],
        ),
        (
            "at = [1800, 100, 20]",
            "at = [700, -700, 10]",
            &[
                "waypoints[4] (gate)",
                "inside obstacles[0] (fish farm)",
                "move",
            ],
        ),
        (
            "name = \"boat\", at = [0, 0, 20]",
            "name = \"boat\", at = [700, -700, 10]",
            &["waypoints[0] (boat)", "inside obstacles[0]", "move"],
        ),
        (
            "name = \"dock\", at = [2400, 0, 20]",
            "name = \"dock\", at = [770, -700, 10]",
            &["waypoints[5] (dock)", "with the clearance", "move"],
        ),
        (
            "name = \"gate\"",
            "name = \"dock\"",
            &["waypoints[5].name", "taken; give another"],
        ),
        (
            "name = \"gate\"",
            "name = \"\"",
            &["waypoints[4].name", "empty", "give another"],
        ),
        (
            "task = \"profile\" }",
            "task = \"profil\" }",
            &["waypoints[1] (station).task", "profil,", "correct the name"],
        ),
        (
            "{ priority = 4,",
            "{ priority = inf,",
            &["tasks.profile.priority is inf; give"],
        ),
        ("risk = 2,", "risk = 0,", &["tasks.profile.risk is 0; give"]),
        (
            "to = \"corner B\"",
            "to = \"corner C\"",
            &["edges[0] (corner A - corner C)", "correct the name"],
        ),
        (
            "to = \"corner B\"",
            "to = \"corner A\"",
            &["edges[0]", "to itself; remove it"],
        ),
        (
            "within_m = 3000",
            "within_m = 1",
            &["destination dock cannot be reached from boat; add edges"],
        ),
        (
            "nearest = 3",
            "nearest = 0",
            &["connect.nearest is 0; give 1 to 1000"],
        ),
        (
            "within_m = 3000",
            "within_m = nan",
            &["connect.within_m is NaN; give"],
        ),
        (
            "except = [\"gate\"]",
            "except = [\"gat\"]",
            &["connect.except", "gat,", "correct the name"],
        ),
        (
            "nearest = 3\nwithin_m = 3000\ncell_m = 25",
            "nearest = 3\ncell_m = -1",
            &["connect.cell_m is -1; give"],
        ),
        (
            "nearest = 3\nwithin_m = 3000\ncell_m = 25",
            "nearest = 3\ncell_m = 0.001",
            &["connect", "nodes", "choose another cell size"],
        ),
        (
            "latitude_deg = 49.5\n",
            "latitude_deg = 95\n",
            &["datum.latitude_deg is 95; give"],
        ),
        (
            "[datum]\nlatitude_deg = 49.5\nlongitude_deg = -124.5\n",
            "",
            &["waypoints[1] (station)", "state the [datum]"],
        ),
        (
            "north_m = [-500, 3000]",
            "north_m = [3000, -500]",
            &["box", "give [low, high]"],
        ),
        (
            "north_m = [-500, 3000]",
            "north_m = [-500, inf]",
            &["box", "give [low, high]"],
        ),
        (
            "north_m = [-500, 3000]\n",
            "",
            &["box needs north_m and east_m"],
        ),
        (
            "base_depth_m = 60",
            "base_depth_m = nan",
            &["sea_bed.analytic.base_depth_m is NaN; give"],
        ),
        (
            "[sea_bed.analytic]",
            "[sea_bed]\nflat_m = 60\n[sea_bed.analytic]",
            &["sea_bed", "keep one"],
        ),
        (
            "radius_m = 50 }, depth_m = 6",
            "radius_m = -50 }, depth_m = 6",
            &["features[3] (shoal).shape.radius_m is -50; give"],
        ),
        (
            "still = false",
            "still = true",
            &["current is still and analytic; keep one"],
        ),
        (
            "gain = [0.8, 1.2]",
            "gain = [1.2, 0.8]",
            &["current.truth.gain", "the lower one first"],
        ),
        (
            "gain = [0.8, 1.2]",
            "gian = 1",
            &["line", "`gian`", "`gain`"],
        ),
        (
            "mean_mps = [0.05, 0]",
            "mean_mps = [nan, 0]",
            &["current.analytic.mean_mps", "give"],
        ),
        (
            "mean_mps = [0.05, 0]",
            "mean_mps = [5, 0]",
            &["current as forecast", "from boat to dock", "another time"],
        ),
        (
            "radius_m = 60",
            "radius_m = -60",
            &["obstacles[0] (fish farm).radius_m is -60; give"],
        ),
        (
            "radius_m = 60",
            "radius_m = [60, 70, 80]",
            &["line", "give a number or [low, high]"],
        ),
        (
            "top_m = -2\nbottom_m = 20",
            "top_m = -2",
            &["obstacles[0] (fish farm)", "give both"],
        ),
        (
            "top_m = -2\nbottom_m = 20",
            "top_m = 30\nbottom_m = 20",
            &["obstacles[0] (fish farm)", "top < bottom"],
        ),
        (
            "class = \"moving\"",
            "class = \"static\"",
            &[
                "obstacles[1] (trawl).velocity_mps",
                "class moving or drifting",
            ],
        ),
        (
            "class = \"moving\"",
            "class = \"movin\"",
            &["line", "`movin`", "`moving`"],
        ),
        (
            "scatter_m = 100",
            "scatter_m = -1",
            &["obstacles[1] (trawl).scatter_m is -1; give"],
        ),
        (
            "radius_m = 10\nuncertainty_m = 0.2",
            "radius_m = 10\nuncertainty_m = -1",
            &["obstacles[2] (lost net).uncertainty_m is -1; give"],
        ),
        (
            "clear_of_waypoints_m = 150",
            "clear_of_waypoints_m = 5000",
            &["obstacle_groups[0] (crab gear) has room for", "give fewer"],
        ),
        (
            "speed_mps = [0, 0.1]",
            "speed_mps = -1",
            &["obstacle_groups[1] (floating wood).speed_mps is -1; give"],
        ),
        (
            "length_m = 60",
            "length_m = -60",
            &["ships[0] (ferry).length_m is -60; give"],
        ),
        (
            "[[0, 1000, -1400], [600, 1000, 1300]]",
            "[]",
            &["ships[0] (ferry).fixes is empty; give"],
        ),
        (
            "speed_mps = 1.4",
            "speed_mps = nan",
            &["vehicle.", "NaN; give"],
        ),
        (
            "range_m = 120",
            "rang_m = 120",
            &["[sonar]", "`rang_m`", "`range_m`"],
        ),
        (
            "range_m = 120",
            "range_m = 20",
            &["sonar.range_m is 20", "confirmed too late", "give at least"],
        ),
        (
            "confirm_hits = 4",
            "sonar = { range_m = 3 }",
            &["[tracker]", "give [sonar]"],
        ),
        (
            "{ evaluations = 2000 }",
            "{ evals = 2000 }",
            &["[synchroniser]", "`evals`", "`evaluations`"],
        ),
        (
            "radius_m = 100 }]",
            "radius_m = 0 }]",
            &["obstacle_motion.keep_out[0].radius_m is 0; give"],
        ),
    ];
    for (old, new, parts) in mistakes {
        let said = answer(old, new);
        for part in parts {
            assert!(said.contains(part), "{new}: {said}");
        }
        assert!(!said.contains('\n'), "one line: {said}");
    }
}

#[test]
fn settings_that_cannot_be_repeated_are_refused() {
    for (line, named) in [
        (
            "launch_budget = { wall_time = { secs = 1, nanos = 0 } }",
            "launch_budget",
        ),
        ("path_budget = { target_cost = 3 }", "path_budget"),
        ("compute = \"measured\"", "compute"),
        ("acceptance = \"as_claimed\"", "acceptance"),
    ] {
        let said = answer("replan = \"late\"", line);
        assert!(said.contains(named), "{said}");
    }
}

/// All texts that have one number of a TOML value replaced.
fn spoilt(whole: &toml::Value, by: f64) -> Vec<(String, String)> {
    fn places(value: &mut toml::Value, path: &str, visit: &mut dyn FnMut(&str, &mut toml::Value)) {
        match value {
            toml::Value::Table(table) => {
                for (key, inner) in table.iter_mut() {
                    places(inner, &format!("{path}.{key}"), visit);
                }
            }
            toml::Value::Array(list) => {
                for (i, inner) in list.iter_mut().enumerate() {
                    places(inner, &format!("{path}[{i}]"), visit);
                }
            }
            toml::Value::Integer(_) | toml::Value::Float(_) => visit(path, value),
            _ => {}
        }
    }
    let mut count = 0;
    places(&mut whole.clone(), "", &mut |_, _| count += 1);
    let mut texts = Vec::new();
    for chosen in 0..count {
        let (mut copy, mut i, mut place) = (whole.clone(), 0, String::new());
        places(&mut copy, "", &mut |path, value| {
            if i == chosen {
                *value = toml::Value::Float(by);
                place = path.to_owned();
            }
            i += 1;
        });
        texts.push((place, toml::to_string(&copy).unwrap()));
    }
    texts
}

#[test]
fn every_number_must_be_finite() {
    let whole: toml::Value = toml::from_str(documented()[1]).unwrap();
    for by in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let texts = spoilt(&whole, by);
        assert!(texts.len() > 150, "{}", texts.len());
        for (place, text) in texts {
            let said = scenario(&text)
                .expect_err(&format!("{by} as {place}"))
                .to_string();
            assert!(!said.contains('\n'), "{said}");
        }
    }
}

#[test]
fn a_truncated_file_is_refused_or_still_complete() {
    let text = documented()[1];
    let cuts = (0..text.len())
        .step_by(61)
        .filter(|&i| text.is_char_boundary(i));
    for cut in cuts {
        if let Err(error) = scenario(&text[..cut]) {
            let said = error.to_string();
            assert!(!said.is_empty() && !said.contains('\n'), "{said}");
        }
    }
    assert!(scenario(&text[..text.len() / 4]).is_err());
}

#[test]
fn damaged_data_files_are_named() {
    let file = MissionFile::from_toml(documented()[2]).unwrap();
    let answer = |data: &MissionData<'_>| file.scenario(data, Seed(0)).unwrap_err().to_string();
    assert!(answer(&MissionData::default()).starts_with("bathymetry: "));
    for bytes in [&b""[..], b"hello", b"\x89HDF\r\n\x1a\n", b"CDF\x01\0\0"] {
        let said = answer(&MissionData {
            bathymetry: Some(bytes),
            ..MissionData::default()
        });
        assert!(
            said.starts_with("bathymetry: ") && said.contains("give a complete"),
            "{said}"
        );
    }
    let own = MissionFile::from_toml(documented()[1]).unwrap();
    for (bytes, part) in [
        (&b"\xff\xfev\0e\0"[..], "save it as UTF-8"),
        (b"K\xf8benhavn", "column vessel is missing"),
        (b"", "column vessel is missing"),
        (b"vessel,BaseDateTime,LAT,LON\n", "give rows with"),
    ] {
        let data = MissionData {
            ais: Some(bytes),
            ..MissionData::default()
        };
        let said = own.scenario(&data, Seed(0)).unwrap_err().to_string();
        assert!(
            said.starts_with(&DataFile::Ais.to_string()) && said.contains(part),
            "{said}"
        );
    }
}

#[test]
fn wrong_values_are_errors_and_no_answer_of_the_launch_check() {
    let text = documented()[0].replace("version = 1", "version = 2");
    for (line, told) in [
        (
            "docking.lead_in_m = 50",
            "docking.lead_in_m needs the course",
        ),
        ("surface.every_s = -5", "surface.every_s is -5"),
        (
            "surface = { every_s = 900, at_most_s = 0 }",
            "surface.at_most_s is 0",
        ),
    ] {
        match scenario(&format!("{text}\n{line}\n")) {
            Err(MissionFileError::Invalid(wrong)) => {
                assert!(
                    wrong.list().len() == 1 && wrong.to_string().contains(told),
                    "{wrong}"
                );
            }
            other => panic!("{line}: {other:?}"),
        }
    }
}

#[test]
fn nothing_is_dropped_or_left_without_meaning() {
    let text = documented()[0].replace("version = 1", "version = 2");
    for (line, told) in [
        (
            "box = { north_m = [-500, 2500, 1], east_m = [-800, 800], depth_m = [2, 60] }",
            "`box.north_m` has a list of 3, more than it takes; leave out the rest",
        ),
        (
            "tasks.cast = { priority = 1, risk = 1, windows = [[0, 60, 90]], time_s = 1 }",
            "`tasks.cast.windows",
        ),
        (
            "tasks.cast = { priority = 1, risk = 1, windows = [[nan, 60]], time_s = 1 }",
            "tasks.cast.windows[0] is [NaN, 60]; give [from, until]",
        ),
        (
            "tasks.cast = { priority = 1, risk = 1, time_s = 1 }\ntasks.cast = 2",
            "a key is given twice; keep one of them",
        ),
        (
            "current = { still = false, moves_vehicle = true }",
            "current.still is false, and nothing says how the water moves; give",
        ),
        (
            "emergency = [{ when = \"leak\", do = [] }]",
            "emergency[0].do is empty; give",
        ),
        (
            "emergency = [{ when = \"leak\", do = [{ loiter = { for_s = -5 } }] }]",
            "emergency[0].do[0].loiter.for_s is -5; give",
        ),
        (
            "tasks.cast = { priority = 1, risk = 1, pattern = { kind = \"profile\", from_m = 9, to_m = 9 } }",
            "pattern.to_m is 9; give",
        ),
    ] {
        let said = scenario(&format!("{text}\n{line}\n")).map(|_| ());
        let said = said.unwrap_err().to_string();
        assert!(said.contains(told), "{line}: {said}");
    }
}
