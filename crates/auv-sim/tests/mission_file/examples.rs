//! The missions of the document and of the examples.

use crate::{documented, scenario};
use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_population::Workers;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{DataFile, MissionData, MissionFile, MissionFileError};
use auv_sim::{Log, MissionOutcome, Scenario, Summary, simulate};
use auv_types::Seed;
use std::path::Path;

/// The mission of a text with its data files; `None` without AUV_DATA_DIR.
fn built_with_files(text: &str) -> Option<Result<Scenario, MissionFileError>> {
    let Ok(folder) = std::env::var("AUV_DATA_DIR") else {
        println!("skipped: set AUV_DATA_DIR");
        return None;
    };
    let file = MissionFile::from_toml(text).unwrap();
    let read =
        |name: Option<&str>| name.map(|name| std::fs::read(Path::new(&folder).join(name)).unwrap());
    let bathymetry = read(file.bathymetry_file());
    let currents = read(file.currents_file());
    let ais = read(file.ais_file());
    let data = MissionData {
        bathymetry: bathymetry.as_deref(),
        currents: currents.as_deref(),
        ais: ais.as_deref(),
    };
    Some(file.scenario(&data, Seed(0)))
}

fn with_files(text: &str) -> Option<Scenario> {
    built_with_files(text).map(Result::unwrap)
}

fn flown(scenario: &Scenario, threads: usize) -> (Summary, String) {
    let workers = Workers::new(threads).unwrap();
    let routes = GaRoute::new(GaSettings::default()).with_workers(workers.clone());
    let paths = PsoPath::new(PathSearch::default()).with_workers(workers);
    let mut log = Log::keeping_lines();
    let summary = simulate(scenario, &Stepped::new(&routes, &paths), &mut log).unwrap();
    (summary, log.sha256())
}

#[test]
fn every_mission_of_the_document_is_valid() {
    let texts = documented();
    assert!(texts.len() >= 3);
    for text in texts {
        match scenario(text) {
            Ok(scenario) => assert!(scenario.mission.network.num_nodes() >= 2),
            Err(MissionFileError::Data { file, reason }) => {
                assert_eq!(file, DataFile::Bathymetry);
                assert!(reason.contains("hand one over"), "{reason}");
                with_files(text);
            }
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn the_mission_with_all_features_docks_and_is_equal_on_two_threads() {
    let everything = scenario(documented()[1]).unwrap();
    let (summary, hash) = flown(&everything, 1);
    assert_eq!(
        summary.outcome,
        MissionOutcome::Docked,
        "{}",
        summary.reason
    );
    assert_eq!(
        (summary.judgement.collisions, summary.judgement.groundings),
        (0, 0)
    );
    assert!(summary.tasks > 0 && summary.remaining_s >= 600.0);
    assert_eq!(flown(&everything, 2).1, hash);
}

#[test]
fn a_waypoint_outside_the_current_model_is_reported() {
    let nordic = include_str!("../missions/nordic.toml");
    let far = nordic
        .replace(
            "longitude_deg = 13.20, depth_m = 60",
            "longitude_deg = 9.0, depth_m = 60",
        )
        .replace("[13.10, 13.90]", "[8.90, 13.90]");
    assert_ne!(far, nordic);
    let Some(built) = built_with_files(&far) else {
        return;
    };
    let error = built.unwrap_err().to_string();
    assert!(
        error.contains("outside the model of the current"),
        "{error}"
    );
}

#[test]
fn the_example_missions_are_valid() {
    let harrow = scenario(include_str!("../missions/harrow_inlet.toml")).unwrap();
    assert_eq!(harrow.mission.network.num_nodes(), 44);
    let guides = &harrow.mission.guides;
    assert!(guides.len() > 10, "{} ways round shoals", guides.len());
    if let Some(baynes) = with_files(include_str!("../missions/baynes_sound.toml")) {
        assert_eq!(baynes.mission.network.num_nodes(), 20);
        assert!(
            baynes.field.ships().len() > 60,
            "{}",
            baynes.field.ships().len()
        );
    }
    if let Some(nordic) = with_files(include_str!("../missions/nordic.toml")) {
        assert!(nordic.current_moves_vehicle);
        let current = nordic.mission.current.as_deref().unwrap();
        for waypoint in nordic.mission.network.waypoints() {
            let speed_mps = current.velocity_at(&waypoint.position, 0.0).norm();
            assert!(
                speed_mps > 0.01 && speed_mps < 1.0,
                "{speed_mps} m/s at {}",
                waypoint.name
            );
        }
    }
}

#[test]
fn a_jet_that_is_stronger_than_the_vehicle_is_crossed_there_and_back() {
    let file = MissionFile::from_toml(include_str!("../missions/across_a_jet.toml")).unwrap();
    for seed in 0..3 {
        let scenario = file.scenario(&MissionData::default(), Seed(seed)).unwrap();
        let current = scenario.mission.current.as_deref().unwrap();
        assert!(current.max_speed_mps() > 1.3 * scenario.mission.vehicle.speed_mps);
        let (summary, _) = flown(&scenario, 1);
        assert_eq!(
            summary.outcome,
            MissionOutcome::Docked,
            "{}",
            summary.reason
        );
        assert_eq!(summary.tasks, 3);
    }
}

/// The documented mission of a name.
fn documented_as(name: &str) -> MissionFile {
    let named = format!("name = \"{name}\"");
    let text = documented().into_iter().find(|text| text.contains(&named));
    MissionFile::from_toml(text.unwrap()).unwrap()
}

/// Flies a mission with both bodies and some seeds; everything is done, all come home.
fn all_is_done(file: &MissionFile, seeds: u64) {
    for body in auv_sim::Body::ALL {
        let file = file.clone().with_body(body);
        for seed in 0..seeds {
            let scenario = file.scenario(&MissionData::default(), Seed(seed)).unwrap();
            let (summary, _) = flown(&scenario, 1);
            let reason = format!("{body:?} {seed}: {}", summary.reason);
            assert_eq!(summary.outcome, MissionOutcome::Docked, "{reason}");
            let done = file.works_done(&scenario.mission, &summary);
            let works = file.works(&scenario.mission);
            let left: Vec<&str> = works
                .iter()
                .zip(done)
                .filter_map(|(work, done)| (!done).then_some(work.name.as_str()))
                .collect();
            assert!(left.is_empty(), "{reason} without {left:?}");
        }
    }
}

#[test]
fn documented_plans_are_flown() {
    all_is_done(&documented_as("cast, then line, before the ferry"), 2);
    all_is_done(&documented_as("survey and casts"), 2);
}

#[test]
fn the_example_missions_are_flown() {
    for text in [
        include_str!("../missions/tidal_narrows.toml"),
        include_str!("../missions/ice_lid.toml"),
        include_str!("../missions/box_survey.toml"),
        include_str!("../missions/cable_inspection.toml"),
    ] {
        all_is_done(&MissionFile::from_toml(text).unwrap(), 2);
    }
}
