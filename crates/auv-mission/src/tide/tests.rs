//! A narrows that lets a vehicle of 3 m/s pass near slack water only.

use super::*;
use crate::driver::Stepped;
use crate::mode::{LegMode, Mode};
use crate::{Observation, SyncSettings, Synchroniser};
use auv_graph::{Edge, Task, Waypoint};
use auv_ocean::{AnalyticCurrent, CurrentGain, Footprint, TidalConstituent};
use auv_planning::Vehicle;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_types::{Seed, Vector3};
use std::sync::Arc;

const SLACK_S: f64 = 7_200.0;

fn place(north_m: f64) -> Point3<f64> {
    Point3::new(north_m, 0.0, 20.0)
}

/// From 0 to 1 through the narrows half way, against up to 6 m/s until slack water, then with as much.
fn narrows(budget_s: f64) -> Mission {
    let waypoints = [0.0, 3_000.0].map(|x| Waypoint::at(place(x)));
    let edges = [Edge::undirected(0, 1, Task::TRANSIT)];
    let network = Arc::new(Network::new(&waypoints, &edges, 3.0).unwrap());
    let mut mission = Mission::new(network, NodeId(0), NodeId(1), budget_s, Vehicle::paper());
    let line = [1_400.0, 1_600.0].map(|north| [north, 0.0]);
    mission.current = Some(Arc::new(AnalyticCurrent {
        tide: vec![TidalConstituent::turning_at(SLACK_S, [0.6, 0.0])],
        gains: vec![CurrentGain {
            shape: Footprint::Line {
                points: line.to_vec(),
                half_width_m: 300.0,
            },
            gain: 10.0,
            skirt_m: 300.0,
        }],
        ..AnalyticCurrent::default()
    }));
    mission
}

fn tide(mission: &Mission) -> Tide {
    Tide::of(mission, Stretch::default()).unwrap()
}

#[test]
fn legs_depend_on_the_departure_only_where_the_current_changes_enough() {
    let mut mission = narrows(14_400.0);
    assert!(Tide::of(&mission, Stretch::default()).is_some());
    let current = mission.current.take();
    assert_eq!(Tide::of(&mission, Stretch::default()), None);
    let forecast = current.unwrap();
    let weak = ForecastError {
        gain: 0.1,
        delay_s: 0.0,
    };
    mission.current = Some(Arc::new(Perturbed::new(forecast, weak)));
    assert_eq!(Tide::of(&mission, Stretch::default()), None);
}

#[test]
fn a_leg_against_the_tide_waits_for_slack_and_later_never_arrives_earlier() {
    let mission = narrows(14_400.0);
    let tide = tide(&mission);
    let arc = mission.network.arc_between(NodeId(0), NodeId(1)).unwrap();
    let leaves_s = tide.leaves_s(arc, 0.0);
    // Every current that may be met lets it pass then: 3 m/s against 1.2 x 6 m/s x sin.
    assert!(
        (3_000.0..SLACK_S + 1_200.0).contains(&leaves_s),
        "{leaves_s}"
    );
    for water in possible(&mission) {
        let travel_s = travel_time_s(&[place(0.0), place(3_000.0)], &water, 3.0, leaves_s);
        assert!(travel_s.unwrap() <= tide.travel_s(arc, leaves_s) + 1e-9);
    }
    let arrivals = (0..140).map(|k| 100.0 * f64::from(k));
    let arrivals = arrivals
        .map(|t| t + tide.travel_s(arc, t))
        .filter(|s| s.is_finite());
    let arrivals: Vec<f64> = arrivals.collect();
    assert!(arrivals.len() > 50 && arrivals.is_sorted_by(|a, b| *a <= *b + 1e-9));
    let home_s = tide.home_s(NodeId(0), 0.0);
    assert!((home_s - tide.travel_s(arc, 0.0)).abs() < 1.0 && home_s > leaves_s);
    let way = tide.way_home(&mission, &mission.network, NodeId(0), 0.0);
    assert_eq!(way, Some(vec![NodeId(0), NodeId(1)]));
}

#[test]
fn a_mission_that_the_tide_keeps_from_home_is_refused_before_launch() {
    let refused = narrows(5_000.0).validate().to_string();
    assert!(refused.contains("budget_s"), "{refused}");
    assert!(narrows(14_400.0).validate().is_empty());
    // With the tide there is no need to wait.
    let mut out = narrows(5_000.0);
    (out.start, out.destination) = (out.destination, out.start);
    assert!(out.validate().is_empty());
}

#[test]
fn the_vehicle_stays_until_the_tide_lets_it_pass() {
    let mission = Arc::new(narrows(14_400.0));
    let settings = SyncSettings::default();
    let mut synchroniser = Synchroniser::new(mission, settings, Seed(0)).unwrap();
    let driver = Stepped::new(&GreedyRoute, &StraightPath);
    let tick = |synchroniser: &mut Synchroniser, time_s: f64| {
        let observation = Observation {
            position_sigma_m: 0.0,
            time_s,
            position: place(0.0),
            velocity: Vector3::zeros(),
            regions: Arc::from([]),
        };
        driver.tick(synchroniser, observation);
        match &synchroniser.view().state.mode {
            Mode::Leg(leg) => (leg.mode, leg.departs_s),
            mode => panic!("{mode:?}"),
        }
    };
    let (mode, departs_s) = tick(&mut synchroniser, 0.0);
    assert!(
        mode == LegMode::Holding && departs_s > 3_000.0,
        "{mode:?} {departs_s}"
    );
    assert_eq!(synchroniser.route_calls()[0].route, [NodeId(0), NodeId(1)]);
    assert!(synchroniser.route_calls()[0].valid);
    assert_eq!(synchroniser.trajectory().unwrap().length_m(), 0.0);
    // The wait is expected too.
    let expected_s = synchroniser.view().leg().unwrap().expected_s;
    assert!(expected_s > departs_s + 500.0, "{expected_s}");
    assert_eq!(tick(&mut synchroniser, 0.5 * departs_s).0, LegMode::Holding);
    let (mode, _) = tick(&mut synchroniser, departs_s);
    assert!(matches!(mode, LegMode::Underway { .. }), "{mode:?}");
}
