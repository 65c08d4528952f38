//! The answers of `path` to invalid scenes, and to scenes without a path.

use crate::{answer_to, program};

const GATE: &str = r#"{"id": "gate", "speed": 3.0, "start": [0, 0, 20], "target": [600, 0, 20],
    "bounds": {"lo": [-100, -300, 0], "hi": [700, 300, 100]},
    "obstacles": [{"centre": [300, 10, 20], "radius": 40}]}"#;

#[test]
fn bad_scenes_get_one_message_with_culprit_and_remedy() {
    let Some(program) = program("path") else {
        return;
    };
    let with = |old: &str, new: &str| {
        assert!(GATE.contains(old));
        GATE.replace(old, new)
    };
    let refused: Vec<(String, &[&str])> = vec![
        (String::new(), &["empty", "give one JSON object"]),
        ("gate".into(), &["line 1", "give one JSON object"]),
        (GATE[..80].into(), &["EOF", "give one JSON object"]),
        (
            r#"{"format": "auv-route-1", "nodes": []}"#.into(),
            &["route planner", "give one JSON object"],
        ),
        (with("3.0", "NaN"), &["line 1", "give one JSON object"]),
        (with("3.0", "1e999"), &["out of range"]),
        (with("3.0", "0"), &["speed is 0", "give 0.001 to 1000"]),
        (
            with("3.0", "1e308"),
            &["speed is 1e308", "give 0.001 to 1000"],
        ),
        (with("3.0", "[3, 1]"), &["sequence", "speed"]),
        (with("600", "1e308"), &["target is (1e308", "give finite"]),
        (with("[600, 0, 20]", "[600, 0]"), &["length 2", "[x, y, z]"]),
        (
            with("40", "-40"),
            &["obstacles[0] has radius -40", "give metres"],
        ),
        (
            with("40", "1e308"),
            &["obstacles[0] has radius 1e308", "at most"],
        ),
        (
            with("\"speed\"", "\"velocity\""),
            &["`velocity`", "`speed`"],
        ),
        (with("\"radius\"", "\"size\""), &["`size`", "`radius`"]),
        (with("-100", "900"), &["bounds", "give low <= high"]),
    ];
    for (k, (scene, parts)) in refused.iter().enumerate() {
        let output = answer_to(&program, &format!("scene-{k}"), scene, &["--json"]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{scene}: {said}");
        assert!(output.stdout.is_empty() && said.matches('\n').count() == 1);
        assert!(said.starts_with("path: ") && said.len() < 500, "{said}");
        for part in *parts {
            assert!(said.contains(part), "{part} missing: {said}");
        }
    }
}

#[test]
fn scenes_without_a_path_name_the_reason() {
    let Some(program) = program("path") else {
        return;
    };
    let said = |name: &str, scene: &str| {
        let output = answer_to(&program, name, scene, &["--evaluations", "200"]);
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    };
    let inside = said("inside", &GATE.replace("[600, 0, 20]", "[300, 0, 20]"));
    assert!(inside.contains("blocked by obstacle 0"), "{inside}");
    let outside = said("outside", &GATE.replace("[600, 0, 20]", "[900, 0, 20]"));
    assert!(
        outside.contains("the target lies 200.000 m outside the bounds"),
        "{outside}"
    );
    let same = said("same", &GATE.replace("[600, 0, 20]", "[0, 0, 20]"));
    assert!(same.contains("nothing to fly"), "{same}");
}
