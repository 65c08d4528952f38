//! A mission flown by a body in six degrees of freedom, steered by set-points alone.

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::{Body, MissionOutcome, simulate};
use auv_types::Seed;

#[test]
fn a_remus_100_docks_and_keeps_to_its_timed_place() {
    let file =
        MissionFile::from_toml(include_str!("../missions/harrow_inlet.toml")).expect("sound");
    let file = file.with_body(Body::Remus100);
    let scenario = file
        .scenario(&MissionData::default(), Seed(3))
        .expect("a sound mission");
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    let summary = simulate(&scenario, &Stepped::new(&routes, &paths), &mut ()).expect("flown");
    assert_eq!(summary.outcome, MissionOutcome::Docked, "{summary}");
    assert_eq!(summary.judgement.collisions, 0);
    assert!(summary.judgement.limits_broken.is_empty(), "{summary}");
    let usual_m = summary.following.quantile_m(0.95);
    assert!(usual_m <= 3.0, "{usual_m} m off the timed place");
    let dock_error_m = summary.dock_error_m.expect("docked");
    assert!(dock_error_m <= 10.0, "{dock_error_m} m from the dock");
}
