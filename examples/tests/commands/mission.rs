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
