//! What a vehicle has no room for is found out before launch: left out with a warning, or refused.
#![cfg(feature = "mission-file")]
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_mission::Mission;
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::{MissionOutcome, Scenario, Summary, simulate};
use auv_types::{Bounds, Point3, Seed};

/// A survey vehicle's mission over a bed of 40 m with a pit in it, narrower than the vehicle's circle.
fn scenario(waypoints: &str, edges: &str) -> Result<Scenario, String> {
    let text = format!(
        "version = 1\nname = \"room\"\npreset = \"default\"\nbudget_s = 6000\nstart = \"a\"\ndestination = \"b\"\n\
         waypoints = [{waypoints}]\n{edges}\ncurrent.still = true\nsonar.clutter_per_scan = 0\n\
         tasks.look = {{ priority = 5, risk = 1, time_s = 60 }}\ntasks.pass = {{ priority = 5, risk = 1, time_s = 0 }}\n\
         box = {{ north_m = [-400, 1400], east_m = [-400, 400], depth_m = [2, 100] }}\n\
         altitude = {{ least_m = 5, sigmas = 0 }}\n\
         [sea_bed.analytic]\nbase_depth_m = 40\n\
         features = [{{ name = \"pit\", shape.disc = {{ centre = [500, 0], radius_m = 6 }}, depth_m = 90, skirt_m = 10 }}]\n"
    );
    let file = MissionFile::from_toml(&text).map_err(|error| error.to_string())?;
    let scenario = file.scenario(&MissionData::default(), Seed(1));
    scenario.map_err(|error| error.to_string())
}

fn flown(scenario: &Scenario) -> Summary {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    simulate(scenario, &Stepped::new(&routes, &paths), &mut ()).unwrap()
}

const ENDS: &str = "{ name = \"a\", at = [0, 0, 20] }, { name = \"b\", at = [1000, 0, 20] }";

#[test]
fn a_station_without_room_for_its_circle_is_left_out_and_named() {
    let waypoints = format!(
        "{ENDS}, {{ name = \"deep\", at = [500, 0, 45], task = \"look\" }}, {{ name = \"free\", at = [500, 200, 20], task = \"look\" }}"
    );
    let scenario = scenario(&waypoints, "connect.nearest = 3").unwrap();
    let text = scenario.warnings.join("\n");
    assert_eq!(scenario.warnings.len(), 1, "{text}");
    for part in [
        "waypoints[2] (deep)",
        "circle of 21 m",
        "raise it to 33.5 m",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let summary = flown(&scenario);
    assert_eq!(
        (summary.outcome, summary.tasks),
        (MissionOutcome::Docked, 1)
    );
    assert!(summary.judgement.min_altitude_m >= 5.0);
}

#[test]
fn a_station_raised_as_told_is_worked() {
    let waypoints = format!("{ENDS}, {{ name = \"deep\", at = [500, 0, 32], task = \"look\" }}");
    let scenario = scenario(&waypoints, "connect.nearest = 2").unwrap();
    assert_eq!(scenario.warnings, Vec::<String>::new());
    let summary = flown(&scenario);
    assert_eq!(
        (summary.outcome, summary.tasks),
        (MissionOutcome::Docked, 1)
    );
    assert!(summary.judgement.min_altitude_m >= 5.0);
}

#[test]
fn a_mission_that_needs_a_waypoint_without_room_is_refused() {
    let waypoints = format!("{ENDS}, {{ name = \"deep\", at = [500, 0, 80], task = \"pass\" }}");
    let edges = "edges = [{ from = \"a\", to = \"deep\" }, { from = \"deep\", to = \"b\" }]";
    let text = scenario(&waypoints, edges).unwrap_err();
    for part in [
        "destination",
        "cannot be reached",
        "waypoints[2] (deep)",
        "raise it to 33.5 m",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

/// A mission made in code, from 10 m to 150 m depth over 150 m, in a corridor of a width.
fn in_code(half_width_m: f64) -> Scenario {
    let values = auv_sim::Preset::Default.values();
    let place = |north_m: f64, depth_m: f64| Waypoint::at(Point3::new(north_m, 0.0, depth_m));
    let waypoints = [place(0.0, 10.0), place(150.0, 150.0)];
    let edges = [Edge::directed(0, 1, Task::TRANSIT)];
    let network = Network::new(&waypoints, &edges, values.vehicle.speed_mps).unwrap();
    let mission = Mission {
        bounds: Some(Bounds::new(
            Point3::new(-200.0, -half_width_m, 2.0),
            Point3::new(1_400.0, half_width_m, 200.0),
        )),
        reserve_s: 0.0,
        ..Mission::new(
            network.into(),
            NodeId(0),
            NodeId(1),
            4_000.0,
            values.vehicle,
        )
    };
    Scenario {
        guidance_error_m: 0.0,
        ..Scenario::new(mission, Vec::new(), Seed(1)).unwrap()
    }
}

#[test]
fn an_arc_too_steep_for_its_corridor_is_refused_by_name_in_missions_made_in_code_too() {
    let scenario = in_code(15.0);
    let text = scenario.validate().to_string();
    for part in [
        "destination",
        "cannot be reached",
        "edges[0] (0 - 1)",
        "from 10.0 m to 150.0 m depth over 150 m",
        "within the box",
        "widen the box",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let paths = PsoPath::new(PathSearch::default());
    let routes = GaRoute::new(GaSettings::default());
    let refused = simulate(&scenario, &Stepped::new(&routes, &paths), &mut ());
    assert!(
        refused
            .unwrap_err()
            .to_string()
            .contains("edges[0] (0 - 1)")
    );
}

#[test]
fn an_arc_too_steep_for_its_corridor_is_flown_where_circles_have_room() {
    let scenario = in_code(300.0);
    assert_eq!(scenario.warnings, Vec::<String>::new());
    assert_eq!(flown(&scenario).outcome, MissionOutcome::Docked);
}
