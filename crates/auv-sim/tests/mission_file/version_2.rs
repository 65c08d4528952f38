//! The keys of version 2: water level, true bed, altimeter.

use crate::{documented, scenario};
use auv_mission::driver::Stepped;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_sim::mission_file::MissionFile;
use auv_sim::{Limit, Log, Summary, simulate};

/// A mission over a flat-topped bank, with more keys.
fn bank(version: u32, keys: &str) -> String {
    format!(
        "version = {version}\nname = \"bank\"\npreset = \"default\"\nbudget_s = 3600\nstart = \"A\"\ndestination = \"B\"\n\
         guidance_error_m = 0\nwaypoints = [{{ name = \"A\", at = [0, 0, 10] }}, {{ name = \"B\", at = [900, 0, 10] }}]\n\
         edges = [{{ from = \"A\", to = \"B\" }}]\ncurrent.still = true\n\
         [box]\nnorth_m = [-300, 1200]\neast_m = [-300, 300]\ndepth_m = [2, 60]\n\
         [sea_bed.analytic]\nbase_depth_m = 20\nsigma = {{ least_m = 1, relative = 0 }}\n{keys}"
    )
}

fn flown(text: &str) -> (Summary, String) {
    let scenario = scenario(text).unwrap();
    let mut log = Log::hash_only();
    let summary = simulate(
        &scenario,
        &Stepped::new(&GreedyRoute, &StraightPath),
        &mut log,
    );
    (summary.unwrap(), log.sha256())
}

#[test]
fn version_1_refuses_the_keys_of_version_2_by_name() {
    for (keys, name) in [
        ("[water_level]\nheight_m = 1", "`water_level`"),
        ("[altimeter]", "`altimeter`"),
        ("[sea_bed]\ntruth = \"drawn\"", "`sea_bed.truth`"),
        ("[sea_bed]\ncorrelation_m = 50", "`sea_bed.correlation_m`"),
        ("[sea_bed.chart]\ndatum = \"lat\"", "`sea_bed.chart.datum`"),
        (
            "[current.model]\nextrapolate = true",
            "`current.model.extrapolate`",
        ),
        ("[ais.columns]\nvessel = \"ship\"", "`ais.columns`"),
    ] {
        let refusal = MissionFile::from_toml(&bank(1, keys))
            .unwrap_err()
            .to_string();
        assert!(
            refusal.contains(name) && refusal.contains("set version = 2"),
            "{refusal}"
        );
    }
    let wrong = "[sea_bed]\ncorrelation_m = 50\n[water_level]\ntide = [{ amplitude_m = 1e9, period_s = 0, highest = 0 }]\n[altimeter]\ndropout = 1";
    let refusal = scenario(&bank(2, wrong)).unwrap_err().to_string();
    for part in [
        "correlation_m is only used",
        "water_level.tide[0].amplitude_m",
        "tide[0].period_s",
    ] {
        assert!(refusal.contains(part), "{refusal}");
    }
    let refusal = scenario(&bank(2, "[altimeter]\ndropout = 1"))
        .unwrap_err()
        .to_string();
    assert!(
        refusal.contains("altimeter.dropout is 1; give"),
        "{refusal}"
    );
}

#[test]
fn files_of_version_1_keep_their_meaning_in_version_2() {
    let old = documented()[0];
    let new = old.replace("version = 1", "version = 2");
    assert_eq!(flown(old), flown(&new));
    assert_eq!(flown(&bank(1, "")), flown(&bank(2, "")));
}

#[test]
fn planners_know_the_lowest_level_and_the_judge_the_true_one() {
    let level =
        "[water_level]\nheight_m = 1\ntide = [{ amplitude_m = 2, period_s = 14400, highest = 0 }]";
    let scenario = scenario(&bank(2, level)).unwrap();
    // High water at the launch, low water two hours later, when the mission times out.
    let bed = scenario.mission.sea_bed.as_deref().unwrap();
    assert!(
        (bed.depth_at(0.0, 0.0) - 19.0).abs() < 0.01,
        "{}",
        bed.depth_at(0.0, 0.0)
    );
    let (summary, _) = flown(&bank(2, level));
    let least_m = summary.judgement.min_altitude_m;
    // About ten minutes after high water the level is 2.9 m.
    assert!(
        least_m > 20.0 + 2.8 - 10.0 - 0.1 && least_m < 20.0 + 3.0 - 10.0,
        "{least_m}"
    );
    // 3 m lower the bank is too shallow for waypoints 10 m deep: 20 - 3 - 5 - 2 < 10.1.
    let low = bank(2, "[water_level]\nheight_m = -3.1");
    let refusal = crate::scenario(&low).unwrap_err().to_string();
    assert!(refusal.contains("the deepest allowed"), "{refusal}");
}

#[test]
fn a_drawn_bed_is_judged_and_measured() {
    let shallow = |sigma: f64| {
        let drawn = bank(2, "[sea_bed]\ntruth = \"drawn\"\ncorrelation_m = 100");
        drawn.replace("least_m = 1,", &format!("least_m = {sigma},"))
    };
    let charted = scenario(&bank(2, "")).unwrap();
    let drawn = scenario(&shallow(1.0)).unwrap();
    assert!(charted.altimeter.is_none());
    assert!(drawn.true_bed.is_some() && drawn.altimeter.is_some());
    let (summary, _) = flown(&shallow(1.0));
    assert_eq!(summary, flown(&shallow(1.0)).0);
    let least_m = summary.judgement.min_altitude_m;
    assert!(least_m < 9.9 && least_m > 6.9, "{least_m}");
    // The least altitude of 5 m over a bed that is often less than 15 m deep.
    let (summary, _) = flown(&shallow(2.5).replace("sigmas", "sigma"));
    let broken = &summary.judgement.limits_broken;
    assert!(
        broken.iter().all(|b| b.limit == Limit::Altitude),
        "{broken:?}"
    );
}
