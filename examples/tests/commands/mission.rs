//! The answers of `mission` to invalid input, and the files it leaves.

use crate::program;
use std::path::Path;
use std::process::{Command, Output};

fn mission(program: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(program);
    command.args(arguments).env_remove("AUV_DATA_DIR");
    command.output().unwrap()
}

fn manifest(path: &str) -> String {
    format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn bad_input_gets_one_message_exit_code_2_and_no_output() {
    let Some(program) = program("mission") else {
        return;
    };
    let (baynes, nordic) = (
        manifest("missions/baynes_sound.toml"),
        manifest("missions/nordic.toml"),
    );
    let (folder, text) = (manifest("missions"), manifest("Cargo.toml"));
    let refused: &[(&[&str], &[&str])] = &[
        (
            &["--mission", "no/such.toml"],
            &["no/such.toml", "check the path"],
        ),
        (&["--mission", ""], &["empty", "give a path"]),
        (
            &["--mission", &folder],
            &["missions", "is a folder: give a file"],
        ),
        (&["--mission", &text], &["Cargo.toml", "version = 1"]),
        (
            &["--mission", &baynes],
            &["--bathymetry FILE", "AUV_DATA_DIR"],
        ),
        (
            &["--mission", &nordic, "--bathymetry", "no.nc"],
            &["no.nc", "check the path"],
        ),
        (
            &[
                "--mission",
                &nordic,
                "--bathymetry",
                &text,
                "--currents",
                &text,
            ],
            &["Cargo.toml", "give a complete"],
        ),
        (
            &["--mission", &baynes, "--bathymetry", &folder],
            &["is a folder"],
        ),
        (&["--ais", &text], &["Cargo.toml", "column"]),
        (&["--seed", "-1"], &["--seed", "whole number"]),
        (&["--seed", "NaN"], &["--seed", "whole number"]),
        (&["--seed", "18446744073709551616"], &["--seed", "2^64"]),
        (&["--threads", "0"], &["--threads", "give 1 to 1024"]),
        (&["--threads", "many"], &["--threads", "whole number"]),
        (
            &["--out", &text],
            &["Cargo.toml", "cannot be written", "another place"],
        ),
        (&["--out", ""], &["--out", "give a folder"]),
        (&["--sed", "1"], &["--sed", "--help"]),
        (&["mission.toml"], &["mission.toml", "--help"]),
    ];
    for (arguments, parts) in refused {
        let output = mission(&program, arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        assert!(
            said.starts_with("mission: ") && said.matches('\n').count() == 1,
            "{said}"
        );
        for part in *parts {
            assert!(said.contains(part), "{arguments:?}: {said}");
        }
    }
}

#[test]
fn a_mission_leaves_a_picture_a_log_and_a_replay() {
    let Some(program) = program("mission") else {
        return;
    };
    let out = std::env::temp_dir().join(format!("auv-mission-{}", std::process::id()));
    let file = out.join("small.toml");
    std::fs::create_dir_all(&out).unwrap();
    let document = include_str!("../../../docs/mission-file.md");
    let least = document.split("```toml\n").nth(1).unwrap();
    std::fs::write(&file, least.split("```").next().unwrap()).unwrap();
    let (file, folder) = (file.display().to_string(), out.display().to_string());
    let output = mission(&program, &["--mission", &file, "--out", &folder, "--json"]);
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    assert!(output.status.success(), "{:?}", output);
    assert_eq!(String::from_utf8(output.stdout).unwrap().lines().count(), 1);
    assert!(read("mission.svg").starts_with("<svg"));
    assert!(read("replay.html").contains("two stations"));
    assert!(read("log.jsonl").lines().count() > 3);
    assert!(read("track.csv").starts_with("time_s,depth_m,"));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("has no [datum]"), "{said}");
    assert!(!out.join("route.geojson").exists());
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn what_was_read_from_a_file_is_told_in_every_form() {
    let Some(program) = program("mission") else {
        return;
    };
    let out = std::env::temp_dir().join(format!("auv-data-{}", std::process::id()));
    std::fs::create_dir_all(&out).unwrap();
    let write = |name: &str, text: &str| {
        std::fs::write(out.join(name), text).unwrap();
        out.join(name).display().to_string()
    };
    let mission_of = |depth_m: i32| {
        format!(
            "version = 1\nname = \"near\"\npreset = \"default\"\nbudget_s = 1800\nstart = \"a\"\ndestination = \"b\"\n\
             waypoints = [{{ name = \"a\", at = [0, 0, {depth_m}] }}, {{ name = \"b\", at = [300, 0, 10] }}]\n\
             edges = [{{ from = \"a\", to = \"b\" }}]\ncurrent.still = true\n\
             datum = {{ latitude_deg = 58, longitude_deg = 11 }}\n\
             box = {{ north_m = [-400, 700], east_m = [-400, 400], depth_m = [0, 60] }}\n[sea_bed]\nflat_m = 50\n"
        )
    };
    let file = write("near.toml", &mission_of(10));
    let ships = write(
        "ships.csv",
        "MMSI,BaseDateTime,LAT,LON,SOG,COG,Length,Draft\n7,2024-05-01T06:00:00,58.2,11.0,0.0,90,120,\n",
    );
    let folder = out.display().to_string();
    let given = ["--mission", &file, "--ais", &ships, "--out", &folder];
    let run = |more: &[&str]| {
        let output = mission(&program, &[&given[..], more].concat());
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (
            output.status.code(),
            text(output.stdout),
            text(output.stderr),
        )
    };
    let assumed = "1 ships report no draught: 6 m is assumed";
    let (code, text, _) = run(&["--data"]);
    assert_eq!(code, Some(0));
    assert!(
        text.starts_with("ais: comma-separated text, 1 ships\n"),
        "{text}"
    );
    assert!(text.contains(&format!("  assumed: {assumed}\n")), "{text}");
    assert!(!out.join("log.jsonl").exists());
    let json = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap();
    let (_, text, _) = run(&["--data", "--json"]);
    assert_eq!(json(&text)["files"][0]["assumed"][0], assumed);
    let (code, text, said) = run(&["--json"]);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(json(&text)["warnings"][0], format!("ais: {assumed}"));
    assert!(said.contains(&format!("warning: ais: {assumed}")), "{said}");
    // A refused mission leaves what was read before.
    write("near.toml", &mission_of(49));
    let (code, text, said) = run(&["--data"]);
    assert!(code == Some(2) && text.contains(assumed), "{text}{said}");
    assert!(said.contains("waypoints") || said.contains(" a "), "{said}");
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_check_before_launch_flies_nothing_and_no_is_an_answer() {
    let Some(program) = program("mission") else {
        return;
    };
    let out = std::env::temp_dir().join(format!("auv-check-{}", std::process::id()));
    std::fs::create_dir_all(&out).unwrap();
    let document = include_str!("../../../docs/mission-file.md");
    let least = document.split("```toml\n").nth(1).unwrap();
    let least = least.split("```").next().unwrap();
    let (file, folder) = (out.join("small.toml"), out.join("flown"));
    let (path, folder_path) = (file.display().to_string(), folder.display().to_string());
    let check = |text: &str, json: &[&str]| {
        std::fs::write(&file, text).unwrap();
        let given = ["--check", "--mission", &path, "--out", &folder_path];
        let output = mission(&program, &[&given[..], json].concat());
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let value: serde_json::Value = serde_json::from_str(&check(least, &["--json"])).unwrap();
    assert_eq!(value["go"], true);
    let legs = value["route"].as_array().unwrap();
    assert_eq!(legs[1]["place"], "station");
    assert_eq!(legs[1]["tasks"][0], "profile");
    assert!(value["margin_s"].as_f64().unwrap() > 0.0 && value["energy_left_percent"].is_null());
    let text = check(least, &[]);
    assert!(text.starts_with("two stations: GO\n"), "{text}");
    assert!(
        text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );
    let late = least.replace("budget_s = 2000.0", "budget_s = 100.0");
    let value: serde_json::Value = serde_json::from_str(&check(&late, &["--json"])).unwrap();
    assert!(
        value["go"] == false && value["latest_launch_s"].is_null(),
        "{value}"
    );
    assert!(
        value["problems"][0].as_str().unwrap().contains("budget_s"),
        "{value}"
    );
    assert!(!folder.exists());
    std::fs::remove_dir_all(out).unwrap();
}
