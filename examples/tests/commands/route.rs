//! The answers of `route` to invalid files, and to instances without a route.

use crate::{answer_to, program};
use serde_json::Value;

const TRIANGLE: &str = r#"{"format": "auv-route-1", "directed": false, "speed": 3.0, "budget": 700,
    "start": 0, "goal": 2, "nodes": [[0, 0, 20], [900, 0, 20], [1800, 0, 20]],
    "edges": [[0, 1, 6, 2, 30], [1, 2, 4, 2, 30], [0, 2, 1, 2, 0]]}"#;

const OPLIB: &str = "NAME : three\nTYPE : OP\nDIMENSION : 3\nCOST_LIMIT : 40\n\
    EDGE_WEIGHT_TYPE : EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 10 0\n3 0 10\n\
    NODE_SCORE_SECTION\n1 0\n2 5\n3 7\nDEPOT_SECTION\n1\n-1\nEOF\n";

#[test]
fn bad_files_get_one_message_with_culprit_and_remedy() {
    let Some(program) = program("route") else {
        return;
    };
    let with = |old: &str, new: &str| {
        assert!(TRIANGLE.contains(old));
        TRIANGLE.replace(old, new)
    };
    let oplib = |old: &str, new: &str| {
        assert!(OPLIB.contains(old));
        OPLIB.replace(old, new)
    };
    let refused: Vec<(String, &[&str])> = vec![
        (String::new(), &["found nothing", "give an auv-route-1"]),
        ("[1]".into(), &["found `[`", "give an auv-route-1"]),
        (
            TRIANGLE[..150].into(),
            &["EOF", "give one complete JSON object"],
        ),
        (
            r#"{"start": [0, 0, 5], "target": [9, 0, 5], "obstacles": []}"#.into(),
            &["path planner", "give one complete JSON object"],
        ),
        (
            with("700", "NaN"),
            &["budget is NaN", "give a finite number"],
        ),
        (
            with("700", "1e999"),
            &["budget is inf", "give a finite number"],
        ),
        (with("700", "-1"), &["budget is -1", "at least 0"]),
        (
            with("\"speed\": 3.0,", ""),
            &["`speed`", "give one complete"],
        ),
        (
            with("\"speed\"", "\"sped\""),
            &["`sped`", "give one complete"],
        ),
        (with("3.0", "0"), &["speed is 0", "above 0"]),
        (
            with("auv-route-1", "auv-route-9"),
            &["auv-route-9", "reads"],
        ),
        (
            with("\"goal\": 2", "\"goal\": 7"),
            &["goal is node 7", "0 to 2"],
        ),
        (
            with("\"start\": 0", "\"start\": 7"),
            &["start is node 7", "0 to 2"],
        ),
        (with("1800", "1e300"), &["nodes[2]", "1e300", "give finite"]),
        (
            with("4, 2, 30", "4, 0, 30"),
            &["edges[1].risk is 0", "above 0"],
        ),
        (with("4, 2, 30", "-4, 2, 30"), &["edges[1].priority is -4"]),
        (
            with("4, 2, 30", "4, 2, -30"),
            &["edges[1].completion_time", "-30"],
        ),
        (
            with("[1, 2, 4", "[1, 1, 4"),
            &["edges[1]", "itself", "remove"],
        ),
        (
            with("[1, 2, 4", "[1, 0, 4"),
            &["edges[1]", "edges[0]", "keep one"],
        ),
        (
            with("[1, 2, 4", "[1, 9, 4"),
            &["edges[1] names node 9", "0 to 2"],
        ),
        (
            with("[1, 2, 4, 2, 30], [0, 2, 1, 2, 0]", "[1, 0, 4]"),
            &["edges[1] has 3 entries", "give [i, j"],
        ),
        (
            with(", [1, 2, 4, 2, 30], [0, 2, 1, 2, 0]", ""),
            &["destination 2 cannot be reached from node 0", "add some"],
        ),
        (
            oplib("DEPOT_SECTION\n1\n-1\n", ""),
            &["DEPOT_SECTION", "add it"],
        ),
        (oplib("COST_LIMIT : 40\n", ""), &["COST_LIMIT", "add it"]),
        (
            oplib(": 40", ": none"),
            &["line 4", "`none`", "finite number"],
        ),
        (oplib("EUC_2D", "XRAY1"), &["`XRAY1`", "EUC_2D", "EXPLICIT"]),
        (
            oplib("EUC_2D", "EXPLICIT"),
            &["EDGE_WEIGHT_FORMAT is missing", "give one of FULL_MATRIX"],
        ),
        (
            oplib("DIMENSION : 3", "DIMENSION : 20000"),
            &["line 3", "Network::MAX_NODES"],
        ),
        (
            "n 3\nm 1\ntmax 40\n0 0 0\n9 9 0\n".into(),
            &["line 1 gives n 3", "give 2"],
        ),
        (
            oplib("2 10 0\n", "9 10 0\n"),
            &["line 8", "node `9`", "1 to 3"],
        ),
        (
            oplib("3 7\n", ""),
            &["NODE_SCORE_SECTION", "node 3", "add it"],
        ),
        ("40 2\n0 0 0\n9 9 0\n".into(), &["line 1", "give 1"]),
        ("40 1\n0 0\n9 9 0\n".into(), &["line 2", "x, y and score"]),
    ];
    for (i, (text, parts)) in refused.iter().enumerate() {
        let output = answer_to(&program, &format!("bad-{i}"), text, &["--json"]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}: {said}");
        assert!(output.stdout.is_empty(), "{text}");
        assert!(
            said.starts_with("route: ") && said.matches('\n').count() == 1,
            "{said}"
        );
        for part in *parts {
            assert!(said.contains(part), "{part} is not in: {said}");
        }
    }
}

#[test]
fn every_offender_is_named() {
    let Some(program) = program("route") else {
        return;
    };
    let text = TRIANGLE
        .replace("6, 2, 30", "6, 0, 30")
        .replace("4, 2, 30", "-4, 2, 30");
    let said = String::from_utf8(answer_to(&program, "two", &text, &[]).stderr).unwrap();
    assert!(
        said.contains("edges[0].risk") && said.contains("edges[1].priority"),
        "{said}"
    );
}

#[test]
fn options_out_of_range_are_refused() {
    let Some(program) = program("route") else {
        return;
    };
    for (options, part) in [
        (["--budget-ms", "-1"], "at least 0"),
        (["--budget-ms", "NaN"], "finite number"),
        (["--evaluations", "-3"], "whole number"),
        (["--threads", "0"], "give 1 to 1024"),
        (["--planner", "pso"], "give one of ga, ica, exact"),
        (["--preset", "best"], "give one of paper, default"),
    ] {
        let output = answer_to(&program, "options", TRIANGLE, &options);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(options[0]) && said.contains(part), "{said}");
    }
}

#[test]
fn too_little_time_gives_the_quickest_route_and_the_shortfall() {
    let Some(program) = program("route") else {
        return;
    };
    // 1800 m at 3 m/s without a task on the way take 600 s.
    for planner in ["ga", "ica", "exact", "greedy"] {
        for (budget, shortfall) in [("540", "60 s more"), ("0", "600 s more")] {
            let text = TRIANGLE.replace("700", budget);
            let options = ["--json", "--planner", planner, "--budget-ms", "20"];
            let output = answer_to(&program, planner, &text, &options);
            let said = String::from_utf8(output.stderr).unwrap();
            assert!(
                output.status.success() && said.contains(shortfall),
                "{said}"
            );
            let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
            assert_eq!(answer["route"], serde_json::json!([0, 2]));
            assert!(answer["violation"].as_f64().unwrap() > 0.0);
        }
    }
}

#[test]
fn every_planner_and_preset_answers() {
    let Some(program) = program("route") else {
        return;
    };
    for (planner, preset) in [
        ("ga", "default"),
        ("ga", "paper"),
        ("ica", "default"),
        ("ica", "paper"),
        ("exact", "default"),
    ] {
        let options = ["--json", "--planner", planner, "--preset", preset];
        let output = answer_to(&program, "ok", TRIANGLE, &options);
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(answer["route"], serde_json::json!([0, 1, 2]), "{planner}");
        let output = answer_to(&program, "tour", OPLIB, &options);
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(
            (&answer["weight"], &answer["tasks"]),
            (&12.0.into(), &3.into())
        );
    }
    let stay = TRIANGLE.replace("\"goal\": 2", "\"goal\": 0");
    let output = answer_to(&program, "stay", &stay, &["--json"]);
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["route"], serde_json::json!([0]));
}

#[test]
fn given_distances_and_classic_headers_have_their_right_answers() {
    let Some(program) = program("route") else {
        return;
    };
    // All tours of five nodes enumerated by hand: 1 2 4 5 1 earns 55 in 33.
    let explicit = |format: &str, numbers: &str| {
        format!(
            "NAME : five\nTYPE : OP\nDIMENSION : 5\nCOST_LIMIT : 33\nEDGE_WEIGHT_TYPE : EXPLICIT\n\
             EDGE_WEIGHT_FORMAT : {format} \nEDGE_WEIGHT_SECTION\n{numbers}\nNODE_SCORE_SECTION\n\
             1 2\n2 14\n3 9\n4 22\n5 17\nDEPOT_SECTION\n1\n-1\n"
        )
    };
    // Four places in Norway, in degrees and minutes; the quickest tour through all has 1,285 km.
    let geo = "NAME: fjords\nTYPE: OP\nTSPSOL: 1285\nDIMENSION: 4\nCOST_LIMIT: 1300\n\
        EDGE_WEIGHT_TYPE: GEO\nEDGE_WEIGHT_FORMAT: FUNCTION\nNODE_COORD_SECTION\n1 60.23 5.19\n\
        2 63.25 10.23\n3 59.54 10.45\n4 58.58 5.44\nNODE_SCORE_SECTION\n1 0\n2 5\n3 6\n4 7\n\
        DEPOT_SECTION\n1\n-1\nEOF\n";
    let classic = "\u{feff}n 5\nm 1\ntmax 17\n0.0\t0.0\t0\n3 4 10\n6 0 20\n-6 8 30\n6 8 0\n";
    let answers = [
        (
            explicit(
                "FULL_MATRIX",
                "0 9 4 13 7\n9 0 6 5 11\n4 6 0 8 10\n13 5 8 0 12\n7 11 10 12 0",
            ),
            (55.0, 33.0),
        ),
        (
            explicit("LOWER_DIAG_ROW", "0 9 0 4 6 0\n 13 5 8 0 7 11 10\n12 0"),
            (55.0, 33.0),
        ),
        (
            explicit("UPPER_ROW", "9 4 13 7 6 5 11\n8 10 12"),
            (55.0, 33.0),
        ),
        (geo.into(), (18.0, 1285.0)),
        // By 6 0 and 3 4 to the last point: 6 + 5 + 5. The other order takes 18.
        (classic.into(), (30.0, 16.0)),
    ];
    for planner in ["ga", "ica", "exact"] {
        for (text, (weight, time_s)) in &answers {
            let options = ["--json", "--planner", planner, "--evaluations", "3000"];
            let output = answer_to(&program, "right", text, &options);
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{planner}: {said}");
            let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
            let found = (
                answer["weight"].as_f64().unwrap(),
                answer["time_s"].as_f64().unwrap(),
            );
            assert!((found.0 - weight).abs() < 1e-9, "{planner}: {answer}");
            assert!((found.1 - time_s).abs() < 1e-9, "{planner}: {answer}");
        }
    }
}
