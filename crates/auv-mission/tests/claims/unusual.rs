//! What is legal and seldom: vehicles that are not where they should be, gauges and places at their limits.

use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_mission::driver::Stepped;
use auv_mission::{Contingency, Event, Mission, Observation, SyncSettings, Synchroniser};
use auv_ocean::FlatBed;
use auv_planning::Vehicle;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_types::{Point3, Seed, Vector3};
use std::sync::Arc;

fn place(x: f64, z: f64) -> Point3<f64> {
    Point3::new(x, 0.0, z)
}

/// North along 900 m of sea 20 m deep, a task of 60 s, and on.
fn mission(vehicle: Vehicle) -> Mission {
    let waypoints = [0.0, 900.0, 1800.0].map(|x| Waypoint::at(place(x, 20.0)));
    let task = Task {
        priority: 6.0,
        risk: 2.0,
        completion_time_s: 60.0,
    };
    let edges = [Edge::undirected(0, 1, task), Edge::undirected(1, 2, task)];
    let network = Network::new(&waypoints, &edges, vehicle.speed_mps).unwrap();
    Mission::new(Arc::new(network), NodeId(0), NodeId(2), 20_000.0, vehicle)
}

fn synchroniser(mission: Mission) -> Synchroniser {
    Synchroniser::new(Arc::new(mission), SyncSettings::default(), Seed(0)).unwrap()
}

fn tick(synchroniser: &mut Synchroniser, time_s: f64, position: Point3<f64>) {
    let observation = Observation {
        time_s,
        position,
        velocity: Vector3::zeros(),
        regions: [].into(),
    };
    Stepped::new(&GreedyRoute, &StraightPath).tick(synchroniser, observation);
}

/// Held up on the way for as long as the leg was to take, or with a clock that jumped.
#[test]
fn a_task_is_done_only_by_a_vehicle_that_is_there() {
    let mut synchroniser = synchroniser(mission(Vehicle::paper()));
    tick(&mut synchroniser, 0.0, place(0.0, 20.0));
    let due_s = synchroniser.due_s();
    assert_eq!(due_s, 360.0);
    tick(&mut synchroniser, due_s, place(300.0, 20.0));
    assert_eq!(synchroniser.due_s(), due_s + 200.0 + 60.0);
}

/// An estimate of depth that is a little off, or a bed that is nearer than charted.
#[test]
fn a_vehicle_lower_than_it_may_be_goes_on_and_has_its_contingencies() {
    for vehicle in [Vehicle::paper(), Vehicle::default()] {
        // Least altitude, standard deviations and depth: 0.3 m, 3 m too low, and below the charted bed.
        for (depth_m, goes_on) in [(20.3, true), (23.0, true), (24.5, false)] {
            let mut mission = mission(vehicle);
            mission.sea_bed = Some(Arc::new(FlatBed::new(24.0)));
            mission.min_altitude_m = 4.0;
            let mut synchroniser = synchroniser(mission);
            tick(&mut synchroniser, 0.0, place(0.0, depth_m));
            let end = synchroniser.trajectory().unwrap().end().position;
            let leads_on = (end - place(900.0, 20.0)).norm() < 50.0;
            assert_eq!(leads_on, goes_on, "{depth_m} m: {end}");
            synchroniser.step(Event::AltitudeMeasured { altitude_m: 1.0 });
            assert_eq!(synchroniser.outcome(), None, "{depth_m} m");
            assert_eq!(synchroniser.contingency(), Some(Contingency::Surface));
            let up = synchroniser.trajectory().unwrap();
            assert!(up.end().position.z.abs() < 1e-9);
            assert!(up.points().iter().all(|p| p.position.z <= depth_m + 1e-6));
        }
    }
}

#[test]
fn a_loiter_that_no_memory_holds_is_refused() {
    let mut mission = mission(Vehicle::default());
    for (for_s, refused) in [(Contingency::LONGEST_S, false), (1e9, true)] {
        mission.contingencies = vec![Contingency::Loiter { for_s }];
        assert_eq!(!mission.validate().is_empty(), refused, "{for_s}");
    }
}

#[cfg(feature = "serde")]
#[test]
fn a_large_battery_and_a_gauge_gone_wild_are_resumed() {
    use auv_mission::{Battery, Checkpoint};
    for left_j in [1.9e9, -1e308, 1e308, f64::MAX, f64::MIN] {
        let mut mission = mission(Vehicle::paper());
        mission.battery = Some(Battery {
            usable_j: 3e9,
            hotel_w: 100.0,
            propulsion_j_per_m: 10.0,
        });
        let mut synchroniser = synchroniser(mission);
        tick(&mut synchroniser, 0.0, place(0.0, 20.0));
        synchroniser.step(Event::BatteryMeasured { left_j });
        let text = synchroniser.save().to_text().unwrap();
        let checkpoint = Checkpoint::from_text(&text).unwrap();
        let resumed = Synchroniser::resume(Arc::clone(synchroniser.mission()), checkpoint);
        let resumed = resumed.unwrap_or_else(|e| panic!("{left_j}: {e}"));
        assert_eq!(resumed.available_s(), synchroniser.available_s());
    }
}
