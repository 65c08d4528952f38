//! Fixes at the surface: as often as told, where told, before docking, and after a dock was missed.

use crate::flight::{ANTENNA_M, FIX_S, Flight, TICK_S, fly, mission};
use auv_graph::NodeId;
use auv_mission::{Event, Mission, Navigation, Outcome, Surfacing};
use auv_obstacles::TimedPoint;
use auv_planning::Vehicle;
use auv_types::{Point3, libm};

/// When the vehicle had been at the surface long enough for a fix.
fn fixes_s(flight: &Flight) -> Vec<f64> {
    let is_up = |p: &TimedPoint| p.position.z <= ANTENNA_M;
    let mut parts = flight.track.chunk_by(|a, b| is_up(a) == is_up(b));
    let mut under_s = 0.0;
    let fix_s = |part: &[TimedPoint]| {
        if !is_up(&part[0]) {
            under_s = part[part.len() - 1].time_s;
            return None;
        }
        let long_enough = |p: &&TimedPoint| p.time_s - under_s >= FIX_S;
        part.iter().find(long_enough).map(|p| p.time_s)
    };
    parts.by_ref().filter_map(fix_s).collect()
}

fn docked(mission: Mission, error: f64) -> Flight {
    let flight = fly(mission, |under_m| error * under_m, |_, _| None);
    assert_eq!(flight.synchroniser.outcome(), Some(Outcome::Docked));
    assert_eq!(flight.synchroniser.visited(), [0, 1, 2, 3].map(NodeId));
    flight
}

/// A vehicle whose error is one per cent of its way.
fn erring(budget_s: f64, most_error_m: Option<f64>) -> Mission {
    let mut mission = mission(Vehicle::default(), budget_s);
    mission.navigation = Some(Navigation {
        drift_percent: 1.0,
        most_error_m,
        ..Navigation::default()
    });
    mission
}

#[test]
fn the_vehicle_is_at_the_surface_as_often_as_told() {
    for (vehicle, every_s) in [(Vehicle::default(), 900.0), (Vehicle::paper(), 400.0)] {
        let mut mission = mission(vehicle, 6e3);
        mission.surfacing = Some(Surfacing::every(every_s));
        let flight = docked(mission, 0.0);
        let fixes_s = fixes_s(&flight);
        assert!(!fixes_s.is_empty() && flight.surfacings() == fixes_s.len());
        let mut since_s = 0.0;
        for fix_s in fixes_s {
            assert!(
                fix_s - since_s <= every_s + TICK_S,
                "{since_s} to {fix_s} s"
            );
            since_s = fix_s;
        }
        let docks_s = flight.track.last().unwrap().time_s;
        assert!(
            docks_s - since_s <= every_s + TICK_S,
            "{since_s} to {docks_s} s"
        );
    }
}

#[test]
fn fixes_are_taken_near_the_waypoints_told() {
    let mut mission = mission(Vehicle::default(), 6e3);
    mission.surfacing = Some(Surfacing::every(900.0));
    mission.fix_places = vec![NodeId(2)];
    let there = mission.position_of(NodeId(2));
    let flight = docked(mission, 0.0);
    let begun = flight.surfaced.iter().zip(&flight.track);
    let begun: Vec<Point3<f64>> = begun
        .filter(|(up, _)| **up)
        .map(|(_, p)| p.position)
        .collect();
    assert_eq!(fixes_s(&flight).len(), 1);
    // Within 50 m where it begins to rise; a helix is at most 4.5 turn radii wide.
    assert!((begun[0] - there).xy().norm() <= 50.0);
    for place in begun {
        assert!((place - there).xy().norm() <= 50.0 + 2.0 * 4.5 * 20.0);
    }
}

#[test]
fn a_vehicle_unsure_of_its_place_surfaces_and_docks_only_when_sure() {
    // 2,400 m give an error of 24 m; the dock asks for twice the error to be no more than 10 m.
    let flight = docked(erring(9e3, None), 0.01);
    let fixes = fixes_s(&flight);
    assert_eq!(fixes.len(), 1, "one fix, over the dock");
    let dock = Point3::new(0.0, 800.0, 0.0);
    let after = flight.track.iter().filter(|p| p.time_s >= fixes[0]);
    let places: Vec<_> = after.map(|p| p.position).collect();
    let way_m: f64 = places.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
    assert!(
        2.0 * 0.01 * way_m <= 10.0,
        "{way_m} m from the fix to the dock"
    );
    assert!((places[0] - dock).xy().norm() < 200.0);
    // A vehicle that is sure enough does not surface.
    assert_eq!(docked(erring(9e3, None), 0.001).surfacings(), 0);
}

#[test]
fn an_error_greater_than_allowed_is_put_right_at_once() {
    let most_m = 6.0;
    let flight = docked(erring(9e3, Some(most_m)), 0.01);
    let worst_m = 0.01 * flight.under_m.iter().copied().fold(0.0, f64::max);
    // 600 m a fix: 2,400 m and the ways up and down again.
    assert!(fixes_s(&flight).len() >= 4);
    // The way up adds to the error, a helix from 40 m at most, and so do the way while the fix is taken and two ticks.
    let vehicle = Vehicle::default();
    let up_m = 2.0 * 40.0 / libm::tan(0.9 * vehicle.max_pitch_rad);
    let added_m = up_m + (FIX_S + 2.0 * TICK_S) * vehicle.speed_mps;
    assert!(
        worst_m > most_m && worst_m <= most_m + 0.01 * added_m,
        "{worst_m} m"
    );
}

/// Flies a vehicle that is in contact with the dock from such a try on.
fn docking(tries: u32, contact_at: usize) -> Flight {
    let mut mission = mission(Vehicle::default(), 9e3);
    mission.docking.tries = tries;
    let dock = mission.position_of(mission.destination);
    let (mut arrivals, mut was_there) = (0, false);
    fly(
        mission,
        |_| 0.0,
        move |_, here| {
            let is_there = (here.position - dock).norm() < 0.5;
            arrivals += usize::from(is_there && !was_there);
            was_there = is_there;
            let docked = is_there && arrivals >= contact_at;
            Some(Event::DockContact { docked })
        },
    )
}

#[test]
fn a_missed_dock_is_tried_again_from_the_surface_as_often_as_told() {
    for (tries, contact_at, surfacings) in [(1, 1, 0), (1, 9, 0), (3, 1, 0), (3, 2, 1), (3, 9, 2)] {
        let flight = docking(tries, contact_at);
        let case = format!("{tries} tries, contact at {contact_at}");
        assert_eq!(
            flight.synchroniser.outcome(),
            Some(Outcome::Docked),
            "{case}"
        );
        assert_eq!(flight.surfacings(), surfacings, "{case}");
        assert_eq!(fixes_s(&flight).len(), surfacings, "{case}");
    }
}
