//! `vehicle_stdio`: a vehicle driven from another language, and lines that are refused.

use crate::program;
use serde_json::Value;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

const MISSION: &str = r#"
version = 1
name = "two stations"
preset = "default"
budget_s = 2000.0
start = "boat"
destination = "dock"
waypoints = [
    { name = "boat", at = [0, 0, 20] },
    { name = "station", at = [900, 300, 20], task = "profile" },
    { name = "dock", at = [1800, 0, 20] },
]
tasks.profile = { priority = 6, risk = 2, time_s = 60 }
connect.nearest = 2
"#;

/// The mission as a file of the test's own.
fn mission(name: &str) -> String {
    let file = std::env::temp_dir().join(format!("auv-{}-{name}.toml", std::process::id()));
    std::fs::write(&file, MISSION).unwrap();
    file.to_str().unwrap().to_owned()
}

#[test]
fn a_script_flies_the_mission_and_takes_it_up_after_a_restart() {
    let Some(program) = program("vehicle_stdio") else {
        return;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("vehicle_stdio/drive.py");
    let file = mission("script");
    let flown = Command::new("python3")
        .arg(script)
        .arg(program)
        .args(["--mission", &file])
        .output();
    std::fs::remove_file(&file).unwrap();
    let Ok(flown) = flown else {
        println!("skipped: there is no python3");
        return;
    };
    let text = String::from_utf8(flown.stdout).unwrap();
    assert!(flown.status.success(), "{text}");
    assert!(text.contains("restarted"), "{text}");
    assert!(text.trim_end().ends_with("docked"), "{text}");
    assert_eq!(
        text.matches("leg ").count(),
        2,
        "each leg is told once: {text}"
    );
}

#[test]
fn a_wrong_line_is_refused_and_changes_nothing() {
    let Some(program) = program("vehicle_stdio") else {
        return;
    };
    let file = mission("refused");
    let mut child = Command::new(program)
        .args(["--mission", &file])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = [
        "not JSON",
        r#"{"type": "observation", "time_s": 0, "position": [0, 0, 20]}"#,
        r#"{"type": "resume", "checkpoint": "nothing"}"#,
        r#"{"type": "observation", "time_s": 0, "position": [0, 0, 20], "velocity": [0, 0, 0]}"#,
        r#"{"type": "observation", "time_s": 1, "position": [0, 0, 20], "velocity": [0, 0, 0],
            "scan": {"heading_rad": 0, "background": 1.5, "echoes": [
                {"position": [30, 0, 20], "velocity": null, "radius_m": -1,
                 "position_sigma_m": 1, "velocity_sigma_mps": 0, "radius_sigma_m": 1}]}}"#,
    ]
    .map(|line| line.replace('\n', " "));
    let mut input = child.stdin.take().unwrap();
    input.write_all(lines.join("\n").as_bytes()).unwrap();
    drop(input);
    let output = child.wait_with_output().unwrap();
    std::fs::remove_file(&file).unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    let answers: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let kinds: Vec<_> = answers
        .iter()
        .map(|a| a["type"].as_str().unwrap())
        .collect();
    let wanted = ["ready", "refused", "refused", "refused", "orders", "orders"];
    assert_eq!(kinds, wanted);
    assert!(answers[2]["reason"].as_str().unwrap().contains("velocity"));
    assert!(answers[4]["trajectory"].is_array() && answers[4]["set_point"].is_object());
    assert!(answers[4]["refused"].is_null());
    assert_eq!(answers[5]["refused"]["malformed"], 1, "{}", answers[5]);
}
