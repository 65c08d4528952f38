//! Files of every text format.

use crate::cases::each_case;
use crate::mutation::damaged;
use auv_graph::RouteInstance;
use auv_graph::format::{from_classic, from_json, from_optw, read};
use auv_mission::driver::Stepped;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::format::Scene;
use auv_planning::{Budget, PathPlanner, RoutePlanner, RouteProblem, Run};
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::simulate;
use auv_types::Seed;
use auv_types::rand::RngExt;

/// An instance that was read can be planned.
fn plan(instance: &RouteInstance) {
    let problem = RouteProblem {
        time_model: instance.time_model.as_ref(),
        ..RouteProblem::new(
            &instance.network,
            instance.start,
            instance.destination,
            instance.budget_s,
        )
    };
    let mut run = Run::new(Seed(0), Budget::evaluations(50));
    if let Ok(planned) = GreedyRoute.plan_route(&mut run, &problem) {
        assert!(
            !planned.cost.is_nan() && !planned.violation.is_nan(),
            "{planned}"
        );
    }
}

#[test]
fn networks_as_json() {
    let whole = [
        include_str!("../../instances/harbour.json").to_owned(),
        in_time(),
    ];
    each_case(4_000, |random| {
        let text = damaged(&whole[random.random_range(0..whole.len())], random);
        if let Ok(instance) = from_json(&text) {
            plan(&instance);
        }
    });
}

/// A small instance with every key of routes in time.
fn in_time() -> String {
    let text = include_str!("../../../docs/routes-in-time.md");
    let block = text
        .split("```json\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next());
    block.map_or_else(
        || include_str!("../../instances/harbour.json").into(),
        ToOwned::to_owned,
    )
}

const OPLIB: &str = "NAME : six\nCOMMENT : drawn\nTYPE : OP\nDIMENSION : 6\nCOST_LIMIT : 60\n\
    EDGE_WEIGHT_TYPE : EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 10 3\n3 20 -4\n4 8 12\n5 15 9\n6 3 7\n\
    NODE_SCORE_SECTION\n1 0\n2 5\n3 9\n4 4\n5 7\n6 1\nDEPOT_SECTION\n1\n-1\nEOF\n";
const MATRIX: &str = "NAME : three\nTYPE : OP\nDIMENSION : 3\nCOST_LIMIT : 12\nEDGE_WEIGHT_TYPE : EXPLICIT\n\
    EDGE_WEIGHT_FORMAT : LOWER_DIAG_ROW\nEDGE_WEIGHT_SECTION\n0\n3 0\n4 5 0\nNODE_SCORE_SECTION\n1 0\n2 5\n3 9\n\
    DEPOT_SECTION\n1\n-1\nEOF\n";
const CLASSIC: &str =
    "40 1\n0.0 0.0 0\n10.0 3.0 5\n20.0 -4.0 9\n8.0 12.0 4\n15.0 9.0 7\n0.0 0.0 0\n";
const OPTW: &str = "1 1 5 1\n0 0\n0 40 40 0 0 0 0 0 1236\n1 45 68 90 10 1 1 1 912 967\n2 45 70 90 30 1 1 1 825 870\n\
    3 42 66 90 10 1 1 1 65 146\n4 42 68 90 10 1 1 1 727 782\n5 42 65 90 10 1 1 1 15 67\n";

#[test]
fn networks_of_benchmarks() {
    assert!(read(OPLIB.as_bytes(), "six").is_ok() && read(MATRIX.as_bytes(), "three").is_ok());
    assert!(from_classic(CLASSIC, "five").is_ok());
    each_case(6_000, |random| {
        let whole = [OPLIB, MATRIX, CLASSIC, OPTW][random.random_range(0..4)];
        let text = damaged(whole, random);
        let read = [
            read(text.as_bytes(), "drawn").ok(),
            from_classic(&text, "drawn").ok(),
            from_optw(
                &text,
                "drawn",
                [None, Some(1), Some(2)][random.random_range(0..3)],
            )
            .ok(),
        ];
        read.iter().flatten().for_each(plan);
    });
}

#[test]
fn scenes() {
    let whole = [
        include_str!("../../scenes/behind_and_below.json"),
        include_str!("../../scenes/deep_stream.json"),
        include_str!("../../scenes/jet.json"),
        include_str!("../../scenes/islands.json"),
    ];
    each_case(1_500, |random| {
        let text = damaged(whole[random.random_range(0..whole.len())], random);
        let Ok(scene) = Scene::from_json(text.as_bytes()) else {
            return;
        };
        let problem = scene.problem();
        let mut run = Run::new(Seed(0), Budget::evaluations(20));
        if let Ok(planned) = StraightPath.plan_path(&mut run, &problem) {
            assert!(
                !planned.cost.is_nan() && !planned.violation.is_nan(),
                "{planned}"
            );
            let report = auv_verify::verify_trajectory(&problem, &planned.best);
            assert!(planned.violation > 0.0 || report.is_valid(), "{report}");
        }
    });
}

/// One case in ten of those that make a mission is flown.
#[test]
fn mission_files() {
    let document = include_str!("../../../docs/first-mission.md");
    let first = document
        .split("```toml\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next());
    let first = first.expect("the first mission");
    let harrow = include_str!("../../missions/harrow_inlet.toml");
    let jet = include_str!("../../missions/across_a_jet.toml");
    each_case(300, |random| {
        let (whole, reads_only) = match random.random_range(0..20) {
            0..14 => (first, false),
            14..19 => (harrow, true),
            _ => (jet, true),
        };
        let Ok(file) = MissionFile::from_toml(&damaged(whole, random)) else {
            return;
        };
        let flown = random.random_range(0..10) == 0;
        if reads_only && !flown {
            return;
        }
        let Ok(scenario) = file.scenario(&MissionData::default(), Seed(0)) else {
            return;
        };
        if !reads_only && flown && scenario.mission.budget_s < 2e4 && scenario.tick_s > 0.5 {
            let driver = Stepped::new(&GreedyRoute, &StraightPath);
            let summary = simulate(&scenario, &driver, &mut ());
            let summary = summary.expect("a mission that the reader passed");
            assert!(
                !summary.mission_weight.is_nan() && !summary.time_s.is_nan(),
                "{summary}"
            );
        }
    });
}

#[test]
fn tracks() {
    let whole = "time_s,depth_m,north_m,east_m,note\n0,5,0.0,0.0,a\n1,5.5,1.5,0.25,b\n2,6,3.0,0.5,\"c, d\"\n";
    each_case(20_000, |random| {
        if let Ok(track) = auv_report::read_track(&damaged(whole, random), None) {
            assert!(
                track
                    .iter()
                    .all(|p| p.time_s.is_finite() && p.position.iter().all(|x| x.is_finite()))
            );
        }
    });
}
