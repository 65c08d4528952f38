//! Legs are flown along lines, in directions and at speeds as asked.

use crate::flight::{Flight, TICK_S, fly, mission};
use auv_graph::{ArcId, NodeId};
use auv_mission::{Mission, Outcome};
use auv_ocean::FlatBed;
use auv_planning::{Arrival, Vehicle};
use auv_types::{Point3, Vector3, libm};
use std::sync::Arc;

fn docked(mission: Mission) -> Flight {
    let flight = fly(mission, |_| 0.0, |_, _| None);
    assert_eq!(flight.synchroniser.outcome(), Some(Outcome::Docked));
    assert_eq!(flight.synchroniser.visited(), [0, 1, 2, 3].map(NodeId));
    flight
}

fn arc(mission: &Mission, from: u32, to: u32) -> ArcId {
    mission
        .network
        .arc_between(NodeId(from), NodeId(to))
        .unwrap()
}

/// How far a place is from a polyline, metres.
fn aside_m(place: &Point3<f64>, line: &[Point3<f64>]) -> f64 {
    let from_piece = |pair: &[Point3<f64>]| {
        let piece = pair[1] - pair[0];
        let share = (place - pair[0]).dot(&piece) / piece.norm_squared();
        (place - (pair[0] + piece * share.clamp(0.0, 1.0))).norm()
    };
    line.windows(2)
        .map(from_piece)
        .fold(f64::INFINITY, f64::min)
}

/// The part of a flight from its last passage of a waypoint to the next.
fn leg(flight: &Flight, from: Point3<f64>, to: Point3<f64>) -> Vec<Point3<f64>> {
    let near = |place: &Point3<f64>, goal: &Point3<f64>| (place - goal).norm();
    let places: Vec<Point3<f64>> = flight.track.iter().map(|p| p.position).collect();
    let nearest = |goal: Point3<f64>| {
        let each = places.iter().enumerate();
        let found = each.min_by(|a, b| near(a.1, &goal).total_cmp(&near(b.1, &goal)));
        found.unwrap().0
    };
    places[nearest(from)..=nearest(to)].to_vec()
}

#[test]
fn a_leg_along_a_line_keeps_to_its_guide() {
    for vehicle in [Vehicle::default(), Vehicle::paper()] {
        let mut mission = mission(vehicle, 6e3);
        let along = arc(&mission, 1, 2);
        // The guide leads 150 m outside; it is rounded as the vehicle turns.
        let ends = [1, 2].map(|node| mission.position_of(NodeId(node)));
        let corner = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
        let corners = [
            ends[0],
            corner(950.0, 300.0, 33.0),
            corner(950.0, 500.0, 36.0),
            ends[1],
        ];
        let guide = auv_planning::polyline::rounded(&corners, 1.1 * vehicle.turn_radius_m);
        mission.guides.insert(along, guide.clone());
        mission.courses.lines.insert(along);
        let flight = docked(mission);
        let places = leg(&flight, ends[0], ends[1]);
        let turn_m = vehicle.turn_radius_m;
        for place in &places {
            let aside_m = aside_m(place, &guide);
            // It comes from the south: until it has turned it is aside.
            let is_turning = (place - ends[0]).norm() < 6.0 * turn_m;
            assert!(
                aside_m < 1.0 || is_turning && aside_m <= 2.5 * turn_m,
                "{aside_m} m at {place}"
            );
        }
        assert!(
            places.iter().any(|p| p.x > 940.0),
            "the guide is followed to its corner"
        );
    }
}

#[test]
fn a_line_is_flown_no_deeper_than_the_bed_allows() {
    let mut mission = mission(Vehicle::paper(), 6e3);
    mission.sea_bed = Some(Arc::new(FlatBed::new(45.0)));
    mission.min_altitude_m = 5.0;
    let along = arc(&mission, 1, 2);
    let ends = [1, 2].map(|node| mission.position_of(NodeId(node)));
    // In its middle the guide is 10 m too deep.
    mission.guides.insert(
        along,
        vec![ends[0], Point3::new(800.0, 400.0, 50.0), ends[1]],
    );
    mission.courses.lines.insert(along);
    let flight = docked(mission);
    let places = leg(&flight, ends[0], ends[1]);
    let deepest_m = places.iter().map(|p| p.z).fold(0.0, f64::max);
    assert!((39.0..=40.0 + 1e-6).contains(&deepest_m), "{deepest_m} m");
    assert!(
        places.iter().all(|p| (p.x - 800.0).abs() < 1e-6),
        "straight as seen from above"
    );
}

/// The direction in which a place was reached, and how far the way to it was straight.
fn arrival(flight: &Flight, place: Point3<f64>, direction: Vector3<f64>) -> (f64, f64) {
    let places: Vec<Point3<f64>> = flight.track.iter().map(|p| p.position).collect();
    let at = places
        .iter()
        .position(|p| (p - place).norm() < 0.1)
        .unwrap();
    let along = (places[at] - places[at - 1]).normalize().dot(&direction);
    let straight = (0..=at).rev().map(|k| place - places[k]);
    let aside_m = |offset: &Vector3<f64>| (offset - direction * offset.dot(&direction)).norm();
    let straight = straight.take_while(|offset| aside_m(offset) < 0.2);
    (along, straight.last().unwrap().norm())
}

#[test]
fn a_waypoint_is_reached_in_the_direction_asked() {
    let lead_m = 60.0;
    for vehicle in [Vehicle::default(), Vehicle::paper()] {
        for direction in [Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y()] {
            let mut mission = mission(vehicle, 6e3);
            let there = mission.position_of(NodeId(2));
            let arrives = Arrival { direction, lead_m };
            mission.courses.arrivals.insert(NodeId(2), arrives);
            let flight = docked(mission);
            let (along, straight_m) = arrival(&flight, there, direction);
            let tick_m = TICK_S * vehicle.speed_mps;
            assert!(along > 0.999, "{direction:?}: {along}");
            assert!(
                straight_m > lead_m - tick_m - 1.0,
                "{direction:?}: {straight_m} m"
            );
        }
    }
}

#[test]
fn a_dock_is_reached_on_its_course() {
    for heading_deg in [0.0_f64, 90.0, 180.0, -90.0] {
        let mut mission = mission(Vehicle::default(), 6e3);
        mission.docking.heading_deg = Some(heading_deg);
        mission.docking.lead_in_m = 40.0;
        let dock = mission.position_of(mission.destination);
        let (sin, cos) = libm::sincos(heading_deg.to_radians());
        let direction = Vector3::new(cos, sin, 0.0);
        let (along, straight_m) = arrival(&docked(mission), dock, direction);
        assert!(
            along > 0.999 && straight_m > 40.0 - 1.5 * TICK_S - 1.0,
            "{heading_deg}: {along}, {straight_m} m"
        );
    }
}

#[test]
fn an_arc_is_flown_at_its_own_speed() {
    let mut mission = mission(Vehicle::default(), 6e3);
    let along = arc(&mission, 1, 2);
    mission.courses.speeds_mps.insert(along, 0.8);
    let ends = [1, 2].map(|node| mission.position_of(NodeId(node)));
    let flight = docked(mission);
    let places = leg(&flight, ends[0], ends[1]);
    for pair in places.windows(2) {
        assert!((pair[1] - pair[0]).norm() <= 0.8 * TICK_S + 1e-6);
    }
    let first = leg(&flight, Point3::new(0.0, 0.0, 20.0), ends[0]);
    assert!(
        first
            .windows(2)
            .any(|pair| (pair[1] - pair[0]).norm() > 1.4 * TICK_S)
    );
}
