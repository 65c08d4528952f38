//! The keys of routes in time are read as they are meant, written, and refused by name.

#![cfg(feature = "serde")]
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "tests compare exact values and say where they fail"
)]

use auv_graph::format::{from_json, to_json};
use auv_graph::{EdgeId, NodeId, Passing, TaskName, TaskPlace};

/// Every key.
const WHOLE: &str = r#"{"format": "auv-route-1", "name": "tide", "directed": false, "speed": 1.5, "budget": 7200,
 "start": 0, "goal": 2, "nodes": [[0, 0, 5], [900, 0, 20], [1800, 0, 20]], "edges": [[0, 1, 7, 2, 60], [1, 2, 0, 1, 0]],
 "tasks": [{"id": "cast", "node": 2, "rho": 8, "xi": 2, "delta": 600, "windows": [[1800, 3600], [600, 900], [800, 1000]], "mandatory": true},
           {"id": 7, "edge": 0, "rho": 5, "xi": 1, "chain": "box", "after": ["cast"]},
           {"id": "line", "edge": 1, "rho": 5, "xi": 1, "chain": "box"}],
 "chains": {"box": {"split": true}, "alone": {}},
 "profiles": {"times": [0, 3600], "travel": {"0": [500, 900], "0-": [700, 600]}},
 "visits": {"nodes": [1], "every_s": 5400}, "destinations": [0, 2], "may_wait": false}"#;

#[test]
fn every_key_is_read_as_it_is_meant() {
    let instance = from_json(WHOLE).unwrap();
    let model = instance.time_model.as_ref().unwrap();
    let [cast, seven, line] = &model.tasks[..] else {
        unreachable!("three tasks");
    };
    assert_eq!(cast.name, TaskName::Text("cast".into()));
    assert_eq!(seven.name, TaskName::Number(7));
    let places = [cast, seven, line].map(|task| task.place);
    let edge = |edge| TaskPlace::Edge(EdgeId(edge));
    assert_eq!(places, [TaskPlace::Node(NodeId(2)), edge(0), edge(1)]);
    let work = cast.task;
    assert_eq!(
        (work.priority, work.risk, work.completion_time_s),
        (8.0, 2.0, 600.0)
    );
    assert_eq!(line.task.completion_time_s, 0.0);
    // In their order, and those that touch are one.
    assert_eq!(cast.windows, [[600.0, 1000.0], [1800.0, 3600.0]]);
    assert!(line.windows.is_empty());
    assert_eq!(
        [cast, seven, line].map(|task| task.mandatory),
        [true, false, false]
    );
    assert_eq!((&cast.after[..], &seven.after[..]), (&[][..], &[0][..]));
    // Chains are in the order of their names.
    let chains: Vec<_> = model
        .chains
        .iter()
        .map(|c| (&c.name[..], c.may_split))
        .collect();
    assert_eq!(chains, [("alone", false), ("box", true)]);
    assert_eq!(
        [cast, seven, line].map(|task| task.chain),
        [None, Some(1), Some(1)]
    );
    let network = &instance.network;
    let travel_s = |from, to, at_s| {
        let arc = network.arc_between(NodeId(from), NodeId(to)).unwrap();
        model.profiles.of(arc).map(|profile| profile.travel_s(at_s))
    };
    assert_eq!(travel_s(0, 1, 1800.0), Some(700.0));
    assert_eq!(travel_s(1, 0, 3600.0), Some(600.0));
    assert_eq!(travel_s(1, 2, 0.0), None);
    let visits = model.visits.as_ref().unwrap();
    assert_eq!(
        (&visits.nodes[..], visits.every_s),
        (&[NodeId(1)][..], 5400.0)
    );
    assert_eq!(model.destinations, [NodeId(0), NodeId(2)]);
    assert!(!model.may_wait && model.passing == Passing::Free);
}

#[test]
fn what_is_written_is_read_again() {
    let instance = from_json(WHOLE).unwrap();
    assert_eq!(from_json(&to_json(&instance).unwrap()).unwrap(), instance);
    // Without any of the keys there is no model; with one of them the others have their usual values.
    let (before, _) = WHOLE.split_once(r#" "tasks""#).unwrap();
    let plain = format!("{}}}", before.trim_end().trim_end_matches(','));
    assert_eq!(from_json(&plain).unwrap().time_model, None);
    let patient = plain.replace("}", r#", "may_wait": true}"#);
    let patient = from_json(&patient).unwrap();
    assert_eq!(patient.time_model, Some(auv_graph::TimeModel::default()));
    assert_eq!(from_json(&to_json(&patient).unwrap()).unwrap(), patient);
}

#[test]
fn what_is_wrong_is_named() {
    for (right, wrong, named) in [
        (
            r#""node": 2, "rho""#,
            r#""rho""#,
            "tasks[0] (cast) gives no place",
        ),
        (
            r#""edge": 0"#,
            r#""edge": 0, "node": 1"#,
            "tasks[1] (7) gives no place or two",
        ),
        (r#""node": 2"#, r#""node": 9"#, "tasks[0] (cast).node"),
        (r#""edge": 1"#, r#""edge": 9"#, "tasks[2] (line).edge"),
        (r#"["cast"]"#, r#"["nobody"]"#, "names `nobody`"),
        (r#""id": "line""#, r#""id": "cast""#, "rename one"),
        (r#""xi": 2"#, r#""xi": 0"#, "tasks[0] (cast).xi"),
        (r#""delta": 600"#, r#""delta": -1"#, "tasks[0] (cast).delta"),
        (r#""0-": "#, r#""9": "#, "profiles.travel.9 names no arc"),
        (
            r#""0-": "#,
            r#""north": "#,
            "profiles.travel.north names no arc",
        ),
        ("[500, 900]", "[500]", "profiles.travel.0"),
        ("[500, 900]", "[5000, 0]", "profiles.travel.0"),
        ("[0, 3600]", "[3600, 0]", "profiles"),
        (r#""every_s": 5400"#, r#""every_s": 0"#, "visits.every_s"),
        (r#"[1], "every_s""#, r#"[8], "every_s""#, "visits.nodes"),
        (
            r#""destinations": [0, 2]"#,
            r#""destinations": [0, 8]"#,
            "destinations",
        ),
        (r#""split": true"#, r#""spilt": true"#, "spilt"),
    ] {
        assert!(WHOLE.contains(right), "{right}");
        let message = from_json(&WHOLE.replacen(right, wrong, 1))
            .unwrap_err()
            .to_string();
        assert!(message.contains(named), "{wrong}: {message}");
    }
    // The other way of an edge that leads one way is no arc.
    let one_way = WHOLE.replace(r#""directed": false"#, r#""directed": true"#);
    let message = from_json(&one_way).unwrap_err().to_string();
    assert!(
        message.contains("profiles.travel.0- names no arc"),
        "{message}"
    );
    let task = r#"{"id": 1, "node": 2, "rho": 1, "xi": 1},"#;
    let many = WHOLE.replacen(
        r#""tasks": ["#,
        &format!(r#""tasks": [{}"#, task.repeat(10_001)),
        1,
    );
    let message = from_json(&many).unwrap_err().to_string();
    assert!(message.contains("at most 10000"), "{message}");
}
