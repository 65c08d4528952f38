//! A vehicle that cannot hover always has a verified trajectory in hand that ends in a state it can keep.

use crate::world::{Detours, Routes};
use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_mission::driver::Stepped;
use auv_mission::{Mission, Observation, Outcome, SyncSettings, Synchroniser};
use auv_ocean::SeaBed;
use auv_planning::{PathProblem, Vehicle};
use auv_types::{Point3, Seed, Vector3};
use auv_verify::{EndState, WayOn, verify_way_on};
use std::sync::Arc;

/// A bed that rises to the east.
#[derive(Debug)]
struct Shore {
    foot_m: f64,
    slope: f64,
}

impl SeaBed for Shore {
    fn depth_at(&self, _north_m: f64, east_m: f64) -> f64 {
        60.0 - self.slope * (east_m - self.foot_m).max(0.0)
    }

    fn max_slope_near(&self, _north_m: f64, _east_m: f64, _radius_m: f64) -> f64 {
        self.slope
    }
}

/// A waypoint at the lowest depth allowed over a shore, which the straight way reaches upslope.
fn mission(slope: f64) -> Mission {
    let vehicle = Vehicle {
        max_pitch_rad: 0.5,
        ..Vehicle::default()
    };
    let shore = Shore {
        foot_m: 560.0,
        slope,
    };
    let deepest_m = shore.depth_at(0.0, 600.0) - 5.0;
    let places = [
        Point3::new(0.0, 0.0, 20.0),
        Point3::new(0.0, 600.0, deepest_m - 0.5),
        Point3::new(500.0, 0.0, 20.0),
    ];
    let task = Task {
        priority: 5.0,
        risk: 1.0,
        completion_time_s: 0.0,
    };
    let edges = [
        Edge::undirected(0, 1, task),
        Edge::undirected(1, 2, Task::TRANSIT),
    ];
    let network = Network::new(&places.map(Waypoint::at), &edges, vehicle.speed_mps).unwrap();
    let mut mission = Mission::new(Arc::new(network), NodeId(0), NodeId(2), 4000.0, vehicle);
    mission.clearance_m = 5.0;
    mission.min_altitude_m = 5.0;
    mission.sea_bed = Some(Arc::new(shore));
    mission
}

#[test]
fn every_trajectory_in_force_ends_in_a_state_that_can_be_kept() {
    for (slope, planning_s) in [(0.4, 0.0), (0.8, 0.0), (0.8, 5.0)] {
        let mission = Arc::new(mission(slope));
        let mut settings = SyncSettings::default();
        settings.planning.planning_s = planning_s;
        let lasts_s = planning_s + settings.margins.escape_s;
        let mut synchroniser = Synchroniser::new(Arc::clone(&mission), settings, Seed(1)).unwrap();
        let driver = Stepped::new(&Routes, &Detours);
        let dock = mission.position_of(mission.destination);
        let problem = PathProblem {
            sea_bed: mission.sea_bed.as_deref(),
            min_altitude_m: mission.min_altitude_m,
            ..PathProblem::new(dock, dock, &mission.vehicle)
        };
        let at_start = (mission.position_of(mission.start), Vector3::zeros());
        let (mut time_s, mut follows) = (0.0, 0);
        while synchroniser.outcome().is_none() {
            let (position, velocity) = synchroniser.trajectory().map_or(at_start, |t| t.at(time_s));
            assert!(position.z <= problem.deepest_at(position.x, position.y) + 0.02);
            let seen = Observation {
                position_sigma_m: 0.0,
                time_s,
                position,
                velocity,
                regions: vec![].into(),
            };
            if let Some(whole) = driver.tick(&mut synchroniser, seen).follow {
                follows += 1;
                let ends_s = synchroniser.due_s();
                let docks = (whole.at(ends_s).0 - dock).norm() < 1e-3;
                let end = if docks {
                    EndState::Docked
                } else {
                    EndState::UnderWay
                };
                let asked = WayOn {
                    ends_s,
                    lasts_s,
                    end,
                };
                // Until the path is ready, the vehicle rests at the start.
                let path = whole.after(time_s + planning_s);
                let report = verify_way_on(&problem, &path, &asked);
                assert!(report.is_valid(), "{slope} at {time_s} s: {report:?}");
            }
            time_s = (time_s + 5.0).min(synchroniser.due_s().max(time_s + 0.1));
        }
        assert_eq!(synchroniser.outcome(), Some(Outcome::Docked), "{slope}");
        assert!(follows >= 2, "{follows}");
    }
}
