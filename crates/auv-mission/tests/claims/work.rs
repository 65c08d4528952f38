//! Work at waypoints is flown as asked, begins within its windows and is booked.

use crate::flight::{Flight, TICK_S, fly, mission, with_manner, work_at};
use auv_graph::{NodeId, TimeModel};
use auv_mission::{Manner, Mission, Outcome, Pattern};
use auv_planning::Vehicle;
use auv_types::{Point3, libm};
use std::sync::Arc;

/// Flies work at waypoint 1, 800 m from the start, and gives the flight and the times between which it is done.
fn worked(mission: Mission) -> (Flight, f64, f64) {
    let takes_s = mission.time_model.as_ref().unwrap().tasks[0]
        .task
        .completion_time_s;
    let flight = fly(mission, |_| 0.0, |_, _| None);
    assert_eq!(flight.synchroniser.outcome(), Some(Outcome::Docked));
    let done = flight.synchroniser.timed_done();
    assert_eq!((done.len(), done[0].task), (1, 0));
    assert!(flight.synchroniser.timed_due().is_empty());
    assert_eq!(flight.synchroniser.weight(), 3.0);
    assert_eq!(
        flight.synchroniser.visited(),
        [0, 1, 2, 3].map(NodeId),
        "the vehicle goes on after its work"
    );
    let begins_s = done[0].start_s;
    (flight, begins_s, begins_s + takes_s)
}

/// A vehicle that turns and one that hovers.
fn vehicles() -> [Vehicle; 2] {
    [Vehicle::default(), Vehicle::paper()]
}

/// Ticks are so far apart, and changes of depth so steep at most: what a depth at a tick may lack, metres.
fn missed_m(vehicle: &Vehicle) -> f64 {
    TICK_S * vehicle.speed_mps * libm::sin(vehicle.max_pitch_rad.min(1.57))
}

#[test]
fn a_profile_reaches_both_its_depths_and_the_vehicle_comes_back() {
    for vehicle in vehicles() {
        let manner = Manner {
            pattern: Some(Pattern::Profile {
                from_m: 10.0,
                to_m: 60.0,
            }),
            ..Manner::default()
        };
        let (flight, begins_s, ends_s) = worked(with_manner(mission(vehicle, 6e3), manner, 30.0));
        let (top_m, bottom_m) = flight.depths_m(begins_s, ends_s);
        let missed_m = missed_m(&vehicle);
        assert!((top_m - 10.0).abs() < missed_m, "{top_m} m");
        assert!((bottom_m - 60.0).abs() < missed_m, "{bottom_m} m");
        // On the way there it was no deeper than either waypoint.
        assert!(flight.depths_m(0.0, begins_s).1 < 30.1);
    }
}

#[test]
fn a_yoyo_goes_on_from_its_far_end() {
    for vehicle in vehicles() {
        let manner = Manner {
            pattern: Some(Pattern::Yoyo {
                top_m: 20.0,
                bottom_m: 40.0,
                length_m: 400.0,
                heading_deg: 0.0,
            }),
            ..Manner::default()
        };
        let (flight, begins_s, ends_s) = worked(with_manner(mission(vehicle, 6e3), manner, 0.0));
        let (top_m, bottom_m) = flight.depths_m(begins_s, ends_s);
        assert!(top_m > 19.0 && bottom_m < 41.0 && bottom_m - top_m > 10.0);
        // It begins at 800 m north, ends 400 m north of there, and the next leg begins there.
        let tick_m = TICK_S * vehicle.speed_mps;
        let after = flight.track.iter().find(|p| p.time_s >= ends_s).unwrap();
        let end = Point3::new(1_200.0, 0.0, after.position.z);
        assert!((after.position - end).norm() < 2.0 * tick_m, "{after:?}");
        let north_m = flight.track.iter().map(|p| p.position.x);
        assert!(north_m.fold(0.0, f64::max) > 1_200.0 - tick_m);
    }
}

#[test]
fn a_circle_leads_round_its_waypoint_at_another_depth_and_speed() {
    for vehicle in vehicles() {
        let manner = Manner {
            pattern: Some(Pattern::Circle {
                radius_m: 50.0,
                turns: 2.0,
            }),
            speed_mps: Some(1.0),
            depth_m: Some(50.0),
        };
        let asked = with_manner(mission(vehicle, 9e3), manner, 0.0);
        let centre = asked.position_of(NodeId(1));
        let (flight, begins_s, ends_s) = worked(asked);
        let at_work = |s: f64| (begins_s..ends_s).contains(&s);
        let part: Vec<_> = flight.track.iter().filter(|p| at_work(p.time_s)).collect();
        let on_circle = part.iter().filter(|p| {
            let offset = p.position - centre;
            (offset.xy().norm() - 50.0).abs() < 1.0 && (p.position.z - 50.0).abs() < 0.5
        });
        // Two turns at 1 m/s.
        let least = (2.0 * std::f64::consts::TAU * 50.0 / TICK_S) as usize;
        assert!(on_circle.count() + 2 >= least);
        for pair in part.windows(2) {
            let way_m = (pair[1].position - pair[0].position).norm();
            assert!(way_m <= 1.0 * (pair[1].time_s - pair[0].time_s) + 1e-6);
        }
        // It comes back to the depth of its waypoint.
        let after = flight.track.iter().find(|p| p.time_s >= ends_s).unwrap();
        assert!((after.position.z - 30.0).abs() < 2.0 * missed_m(&vehicle));
    }
}

#[test]
fn work_begins_when_its_window_opens() {
    for vehicle in vehicles() {
        let opens_s = 2.0 * 800.0 / vehicle.speed_mps;
        let manner = Manner {
            pattern: Some(Pattern::Profile {
                from_m: 20.0,
                to_m: 40.0,
            }),
            ..Manner::default()
        };
        let mut mission = with_manner(mission(vehicle, 6e3), manner, 0.0);
        let takes_s = manner.takes_s(&vehicle, mission.position_of(NodeId(1)));
        mission.time_model = Some(Arc::new(TimeModel {
            tasks: vec![work_at(1, takes_s, &[[opens_s, opens_s + 500.0]])],
            ..TimeModel::default()
        }));
        let (flight, begins_s, ends_s) = worked(mission);
        assert!(
            (opens_s..opens_s + 500.0).contains(&begins_s),
            "{begins_s} s"
        );
        // Until then it stays at the depth of its waypoint; then it goes as deep as asked.
        let before_s = (begins_s - 200.0, begins_s - TICK_S);
        let (top_m, bottom_m) = flight.depths_m(before_s.0, before_s.1);
        assert!((top_m - 30.0).abs() < 1.0 && (bottom_m - 30.0).abs() < 1.0);
        assert!(flight.depths_m(begins_s, ends_s).1 > 40.0 - missed_m(&vehicle));
    }
}
