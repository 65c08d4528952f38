//! Rare but legal cases: vehicles off their trajectories, gauges and places at their limits.

use auv_graph::{Edge, Network, NodeId, Route, Task, Waypoint};
use auv_mission::driver::Stepped;
use auv_mission::{
    AbortReason, Battery, Contingency, Event, Mission, Observation, Outcome, SyncSettings,
    Synchroniser,
};
use auv_obstacles::{ObstacleId, Region};
use auv_ocean::{CurrentField, FlatBed};
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{PlanError, Planned, RoutePlanner, RouteProblem, Run, Vehicle};
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
    tick_among(synchroniser, time_s, position, &[]);
}

fn tick_among(
    synchroniser: &mut Synchroniser,
    time_s: f64,
    position: Point3<f64>,
    regions: &[Region],
) {
    let observation = Observation {
        position_sigma_m: 0.0,
        time_s,
        position,
        velocity: Vector3::zeros(),
        regions: regions.into(),
    };
    Stepped::new(&GreedyRoute, &StraightPath).tick(synchroniser, observation);
}

/// The vehicle is delayed by the whole time of the leg, or its clock jumped.
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
fn a_vehicle_below_the_least_altitude_goes_on_and_has_its_contingencies() {
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

/// A tracker that divides by zero now and then.
#[test]
fn a_malformed_region_keeps_the_last_valid_regions_of_its_obstacle() {
    let sound = |obstacle, x| Region {
        obstacle: ObstacleId(obstacle),
        ..Region::ball(place(x, 20.0), 50.0)
    };
    let (rock, other) = (sound(1, 450.0), sound(2, -900.0));
    let broken = [
        Region {
            radius_m: f64::NAN,
            ..rock
        },
        Region {
            radius_m: f64::INFINITY,
            ..rock
        },
        Region {
            radius_m: -1.0,
            ..rock
        },
        Region {
            centre: place(f64::NAN, 0.0),
            ..rock
        },
        Region {
            velocity_mps: Vector3::new(0.0, f64::NAN, 0.0),
            ..rock
        },
        Region {
            growth_mps: f64::NEG_INFINITY,
            ..rock
        },
        Region {
            from_s: f64::NAN,
            ..rock
        },
    ];
    for broken in broken {
        let mut synchroniser = synchroniser(mission(Vehicle::paper()));
        tick_among(&mut synchroniser, 0.0, place(0.0, 20.0), &[rock, other]);
        tick_among(&mut synchroniser, 10.0, place(0.0, 20.0), &[broken, other]);
        // No straight way leads through the rock: the vehicle stays clear of it.
        let way = synchroniser.trajectory().unwrap();
        assert!(
            way.segments()
                .all(|(a, b)| rock.clearance(a, b).clearance_m > 0.0),
            "{broken:?}"
        );
        #[cfg(feature = "serde")]
        {
            let text = synchroniser.save().to_text().unwrap();
            let saved = auv_mission::Checkpoint::from_text(&text).unwrap();
            assert!(Synchroniser::resume(Arc::clone(synchroniser.mission()), saved).is_ok());
        }
    }
}

/// A planner that fails at its first calls.
struct Fails(std::sync::atomic::AtomicU32);

impl RoutePlanner for Fails {
    fn name(&self) -> &str {
        "fails"
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        let left = &self.0;
        let one_less = |n: u32| n.checked_sub(1);
        let order = std::sync::atomic::Ordering::Relaxed;
        if left.fetch_update(order, order, one_less).is_ok() {
            return Err(PlanError::Failed {
                planner: "fails".into(),
                reason: "out of luck".into(),
            });
        }
        GreedyRoute.plan_route(run, problem)
    }
}

#[test]
fn a_planner_that_fails_at_the_launch_costs_no_task() {
    // The fourth failure in a row is the last: the vehicle goes home, which is quickest.
    for (failures, calls, tasks) in [(1, 2, 2), (3, 4, 2), (9, 4, 0)] {
        let planner = Fails(failures.into());
        let mut synchroniser = synchroniser(mission(Vehicle::paper()));
        let launch = Observation {
            position_sigma_m: 0.0,
            time_s: 0.0,
            position: place(0.0, 20.0),
            velocity: Vector3::zeros(),
            regions: [].into(),
        };
        Stepped::new(&planner, &StraightPath).tick(&mut synchroniser, launch);
        assert_eq!(synchroniser.route_calls().len(), calls);
        assert_eq!(synchroniser.route_calls()[calls - 1].tasks, tasks);
        assert!(synchroniser.trajectory().is_some());
    }
}

#[test]
fn a_covered_destination_is_not_waited_for_until_the_battery_is_empty() {
    let mut mission = mission(Vehicle::paper());
    mission.battery = Some(Battery {
        usable_j: 130.0 * 1_200.0,
        hotel_w: 100.0,
        propulsion_j_per_m: 10.0,
    });
    let mut synchroniser = synchroniser(mission);
    let over_the_destination = Region::ball(place(1_800.0, 20.0), 60.0);
    let (mut time_s, mut position) = (0.0, place(0.0, 20.0));
    while synchroniser.outcome().is_none() {
        tick_among(&mut synchroniser, time_s, position, &[over_the_destination]);
        time_s += 5.0;
        position = synchroniser.trajectory().unwrap().at(time_s).0;
    }
    let spent = Outcome::Aborted(AbortReason::EnergySpent);
    assert_eq!(synchroniser.outcome(), Some(spent));
    assert_eq!(synchroniser.contingency(), Some(Contingency::Surface));
    assert!(synchroniser.available_s() >= 0.0 && position.z.abs() < 1e-9);
}

/// 4 m/s against the vehicle, from 20,000 to 30,000 s by its clock.
#[derive(Debug)]
struct Tide;

impl CurrentField for Tide {
    fn velocity_at(&self, _place: &Point3<f64>, time_s: f64) -> Vector3<f64> {
        let runs = (20_000.0..30_000.0).contains(&time_s);
        Vector3::new(if runs { -4.0 } else { 0.0 }, 0.0, 0.0)
    }

    fn max_speed_mps(&self) -> f64 {
        4.0
    }
}

#[test]
fn the_forecast_is_checked_for_the_time_of_the_launch() {
    for (launch_s, refused) in [
        (0.0, false),
        (25_000.0, true),
        (43_200.0, false),
        (f64::NAN, true),
    ] {
        let mut mission = mission(Vehicle::paper());
        mission.current = Some(Arc::new(Tide));
        mission.launch_s = launch_s;
        assert_eq!(!mission.validate().is_empty(), refused, "{launch_s} s");
    }
}

#[test]
fn a_loiter_too_long_for_memory_is_refused() {
    let mut mission = mission(Vehicle::default());
    for (for_s, refused) in [(Contingency::LONGEST_S, false), (1e9, true)] {
        mission.contingencies = vec![Contingency::Loiter { for_s }];
        assert_eq!(!mission.validate().is_empty(), refused, "{for_s}");
    }
}

#[cfg(feature = "serde")]
#[test]
fn a_large_battery_and_a_broken_gauge_are_resumed() {
    use auv_mission::Checkpoint;
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
