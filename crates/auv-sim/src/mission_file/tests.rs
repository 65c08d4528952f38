//! Compares the schema with its document.

use super::overrides::check_values;
use super::*;
use auv_types::Seed;
use serde::Serialize;

const DOCUMENT: &str = include_str!("../../tests/mission-file.md");

/// The text under a heading.
fn section(heading: &str) -> &'static str {
    let begin = DOCUMENT.find(&format!("\n## {heading}\n"));
    let from = &DOCUMENT[begin.unwrap_or_else(|| panic!("no section {heading}")) + 1..];
    from.find("\n## ").map_or(from, |end| &from[..end])
}

/// The keys or words that a message lists as accepted.
fn expected(message: &str) -> Vec<String> {
    let list = match message.split_once("available keys: ") {
        Some((_, keys)) => keys.split(';').next().unwrap().replace(", ", "` `"),
        None => message.split_once("expected ").expect(message).1.to_owned(),
    };
    let list = format!("{}{list}`", if list.contains("`") { "" } else { "`" });
    let words = list.split('`').map(str::trim);
    words
        .filter(|word| {
            word.chars()
                .all(|c| c.is_ascii_lowercase() || "_0123456789".contains(c))
        })
        .filter(|word| !word.is_empty() && *word != "or")
        .map(str::to_owned)
        .collect()
}

/// The error of a mission file with one more line.
fn answer(line: &str) -> String {
    let text = format!(
        "version = 1\nname = \"x\"\npreset = \"default\"\nstart = \"a\"\ndestination = \"b\"\n\
         waypoints = [{{ name = \"a\", at = [0, 0, 9] }}, {{ name = \"b\", at = [9, 0, 9] }}]\n{line}\n"
    );
    MissionFile::from_toml(&text)
        .and_then(|file| file.scenario(&MissionData::default(), Seed(0)).map(drop))
        .expect_err(line)
        .to_string()
}

#[test]
fn every_accepted_key_and_word_is_explained() {
    let shape = |shape: &str| {
        format!("current.analytic.gains = [{{ gain = 1, skirt_m = 1, shape.{shape} }}]")
    };
    let asked = [
        ("Top level", vec!["zzz = 0".into()]),
        (
            "Place",
            vec![
                "datum.zzz = 0".into(),
                "box.zzz = 0".into(),
                "altitude.zzz = 0".into(),
            ],
        ),
        (
            "Sea bed",
            vec![
                "sea_bed.zzz = 0".into(),
                "sea_bed.truth = \"zzz\"".into(),
                "sea_bed.chart.zzz = 0".into(),
                "sea_bed.chart.sigma.zzz = 0".into(),
                "sea_bed.analytic.zzz = 0".into(),
                "sea_bed.analytic.features = [{ zzz = 0 }]".into(),
                "sea_bed.analytic.features = [{ effect = \"zzz\" }]".into(),
                "sea_bed.analytic.undulations = [{ zzz = 0 }]".into(),
                shape("zzz = {}"),
                shape("disc = { zzz = 0 }"),
                shape("ellipse = { zzz = 0 }"),
                shape("line = { zzz = 0 }"),
                shape("area = { zzz = 0 }"),
                shape("beyond = { zzz = 0 }"),
            ],
        ),
        (
            "Water level and altimeter",
            vec![
                "water_level.zzz = 0".into(),
                "water_level.tide = [{ zzz = 0 }]".into(),
                "altimeter.zzz = 0".into(),
            ],
        ),
        (
            "Current",
            vec![
                "current.zzz = 0".into(),
                "current.truth.zzz = 0".into(),
                "current.model.zzz = 0".into(),
                "current.analytic.zzz = 0".into(),
                "current.analytic.tide = [{ zzz = 0 }]".into(),
                "current.analytic.gains = [{ zzz = 0 }]".into(),
                "current.analytic.vortices = [{ zzz = 0 }]".into(),
            ],
        ),
        (
            "Tasks, waypoints, edges",
            vec![
                "tasks.x = { zzz = 0 }".into(),
                "edges = [{ zzz = 0 }]".into(),
                "connect.zzz = 0".into(),
            ],
        ),
        (
            "Obstacles",
            vec![
                "obstacles = [{ zzz = 0 }]".into(),
                "obstacles = [{ class = \"zzz\" }]".into(),
                "obstacle_groups = [{ zzz = 0 }]".into(),
            ],
        ),
        (
            "Ships",
            vec![
                "ships = [{ zzz = 0 }]".into(),
                "ais.zzz = 0".into(),
                "ais.after_last_fix = \"zzz\"".into(),
            ],
        ),
        ("`[vehicle]`", vec!["vehicle.zzz = 0".into()]),
        (
            "`[navigation]`, `[surface]` and `[docking]`",
            vec![
                "navigation.zzz = 0".into(),
                "surface.zzz = 0".into(),
                "docking.zzz = 0".into(),
            ],
        ),
        ("`[sonar]`", vec!["sonar.zzz = 0".into()]),
        ("`[tracker]`", vec!["tracker.zzz = 0".into()]),
        ("`[clearance]`", vec!["clearance.zzz = 0".into()]),
        (
            "`[synchroniser]`",
            vec![
                "synchroniser.zzz = 0".into(),
                "synchroniser.replan = \"zzz\"".into(),
            ],
        ),
        (
            "`[obstacle_motion]`",
            vec![
                "obstacle_motion.zzz = 0".into(),
                "obstacle_motion.eq5 = \"zzz\"".into(),
            ],
        ),
    ];
    for (heading, lines) in asked {
        for line in lines {
            let message = answer(&line);
            let keys = expected(&message);
            assert!(
                !keys.is_empty() && !keys.contains(&"zzz".into()),
                "{message}"
            );
            for key in keys {
                let named = section(heading);
                let named =
                    named.contains(&format!("`{key}`")) || named.contains(&format!("\"{key}\""));
                assert!(named, "{heading}: {key} of {line} is not explained");
            }
        }
    }
}

/// A value in the document's notation.
fn shown(value: &toml::Value) -> String {
    match value {
        toml::Value::String(word) => word.clone(),
        toml::Value::Array(list) if list.is_empty() => "none".into(),
        toml::Value::Table(table) => {
            let (key, inner) = table.iter().next().unwrap();
            if inner.is_table() {
                format!("{key} {}", shown(inner))
            } else {
                shown(inner)
            }
        }
        other => other.to_string(),
    }
}

fn check_defaults(heading: &str, paper: &impl Serialize, default: &impl Serialize) {
    let tables = [
        toml::Table::try_from(paper).unwrap(),
        toml::Table::try_from(default).unwrap(),
    ];
    let mut documented = 0;
    for line in section(heading)
        .lines()
        .filter(|line| line.starts_with("| `"))
    {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let key = cells[1].trim_matches('`');
        documented += 1;
        for (table, cell) in tables.iter().zip(&cells[3..5]) {
            let value = table.get(key).map_or("none".into(), shown);
            let same = match (value.parse::<f64>(), cell.parse::<f64>()) {
                (Ok(a), Ok(b)) => a == b || (a - b).abs() <= 2e-6 * a.abs(),
                _ => value == *cell,
            };
            assert!(same, "{heading}: {key} is {value}, not {cell}");
        }
    }
    assert!(
        documented >= tables[0].len().max(tables[1].len()) - 1,
        "{heading}"
    );
}

#[test]
fn the_documented_defaults_are_those_of_the_presets() {
    let (paper, default) = (Preset::Paper.values(), Preset::Default.values());
    check_defaults("`[vehicle]`", &paper.vehicle, &default.vehicle);
    check_defaults("`[sonar]`", &paper.sonar, &default.sonar);
    check_defaults("`[tracker]`", &paper.tracker, &default.tracker);
    check_defaults("`[clearance]`", &paper.clearance, &default.clearance);
    check_defaults(
        "`[synchroniser]`",
        &paper.synchroniser,
        &default.synchroniser,
    );
    check_defaults(
        "`[obstacle_motion]`",
        &paper.obstacle_motion,
        &default.obstacle_motion,
    );
    for preset in Preset::ALL {
        let values = preset.values();
        assert!(check_values(&values).is_empty());
        let reserve = match values.reserve_share {
            0.0 => "0".to_owned(),
            share => format!("{share} of the budget"),
        };
        let row = format!(
            "| `{}` | {} | {reserve} | {} | {} | {} | {} | {} |",
            preset.as_str(),
            values.budget_s,
            values.tick_s,
            values.guidance_error_m,
            values.clearance_m,
            values.min_altitude_m,
            values.altitude_sigmas
        );
        assert!(DOCUMENT.contains(&row), "{row}");
    }
}
