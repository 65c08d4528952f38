//! A covered target is waited for nearby; a wait without end is given up safely.

use crate::world::{Detours, Routes};
use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_mission::driver::Stepped;
use auv_mission::{
    AbortReason, Contingency, Mission, Observation, Outcome, SyncSettings, Synchroniser,
};
use auv_obstacles::Region;
use auv_planning::{
    PathPlanner, PathProblem, PlanError, Planned, Run, Trajectory, Vehicle, baseline::StraightPath,
};
use auv_types::{Point3, Seed, Vector3};
use std::sync::Arc;

/// A destination 1500 m away that a ball covers until the given time.
fn fly(
    covered_until_s: f64,
    vehicle: Vehicle,
    ladder: &[Contingency],
) -> (Synchroniser, Observation, f64) {
    let destination = Point3::new(1500.0, 0.0, 50.0);
    let places = [Point3::new(0.0, 0.0, 50.0), destination].map(Waypoint::at);
    let edge = Edge::undirected(0, 1, Task::TRANSIT);
    let network = Arc::new(Network::new(&places, &[edge], vehicle.speed_mps).unwrap());
    let mut mission = Mission::new(network, NodeId(0), NodeId(1), 4000.0, vehicle);
    mission.clearance_m = 5.0;
    mission.contingencies = ladder.to_vec();
    let mut synchroniser =
        Synchroniser::new(Arc::new(mission), SyncSettings::default(), Seed(1)).unwrap();
    let mut ball = Region::ball(destination, 100.0);
    let mut nearest_m = f64::INFINITY;
    let seen = fly_to_the_end(&mut synchroniser, &Detours, |time_s, position| {
        ball.from_s = time_s;
        let covered = time_s < covered_until_s;
        if covered {
            nearest_m = nearest_m.min((position - destination).norm());
        }
        covered.then_some(ball).into_iter().collect()
    });
    (synchroniser, seen, nearest_m)
}

/// Ticks every 10 s on the trajectory in force, with the regions of that time, until the mission ends.
/// Returns the last observation.
fn fly_to_the_end(
    synchroniser: &mut Synchroniser,
    paths: &dyn PathPlanner,
    mut regions: impl FnMut(f64, Point3<f64>) -> Vec<Region>,
) -> Observation {
    let driver = Stepped::new(&Routes, paths);
    let start = synchroniser.mission().start;
    let at_start = (synchroniser.mission().position_of(start), Vector3::zeros());
    let mut time_s = 0.0;
    loop {
        let (position, velocity) = synchroniser.trajectory().map_or(at_start, |t| t.at(time_s));
        let seen = Observation {
            position_sigma_m: 0.0,
            time_s,
            position,
            velocity,
            regions: regions(time_s, position).into(),
        };
        driver.tick(synchroniser, seen.clone());
        if synchroniser.outcome().is_some() {
            return seen;
        }
        time_s += 10.0;
    }
}

#[test]
fn a_covered_destination_is_waited_for_nearby_and_reached_soon_after() {
    for vehicle in [Vehicle::paper(), Vehicle::default()] {
        let (synchroniser, seen, nearest_m) = fly(2000.0, vehicle, &Contingency::LADDER);
        let ended_s = seen.time_s;
        assert_eq!(synchroniser.outcome(), Some(Outcome::Docked));
        assert!((105.0..260.0).contains(&nearest_m), "{nearest_m} m");
        assert!(
            ended_s < 2000.0 + 400.0 / vehicle.speed_mps + 60.0,
            "{ended_s} s"
        );
        let waited_s = synchroniser.path_calls()[0].waited_s;
        assert!((1.0..2000.0).contains(&waited_s), "{waited_s} s");
    }
}

#[test]
fn a_mission_that_times_out_flies_its_contingencies() {
    let gone = Some(Outcome::Aborted(AbortReason::TimedOut));
    for vehicle in [Vehicle::paper(), Vehicle::default()] {
        let (synchroniser, seen, _) = fly(f64::INFINITY, vehicle, &Contingency::LADDER);
        assert_eq!(synchroniser.outcome(), gone);
        assert_eq!(synchroniser.contingency(), Some(Contingency::Surface));
        assert!(seen.position.z.abs() < 1.0, "{}", seen.position);

        let (synchroniser, seen, _) = fly(f64::INFINITY, vehicle, &[Contingency::ReturnAlongTrack]);
        assert_eq!(synchroniser.outcome(), gone);
        assert_eq!(
            synchroniser.contingency(),
            Some(Contingency::ReturnAlongTrack)
        );
        let start = Point3::new(0.0, 0.0, 50.0);
        assert!((seen.position - start).norm() < 30.0, "{}", seen.position);

        let (synchroniser, seen, _) = fly(f64::INFINITY, vehicle, &[]);
        assert_eq!(
            (synchroniser.outcome(), synchroniser.contingency()),
            (gone, None)
        );
        assert!(seen.time_s <= 8_020.0);
    }
}

/// Finds no path to any place.
struct NoWay;

impl PathPlanner for NoWay {
    fn name(&self) -> &str {
        "no way"
    }

    fn plan_path(
        &self,
        _run: &mut Run<'_>,
        _problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        Err(PlanError::Failed {
            planner: "no way".into(),
            reason: "walls on all sides".into(),
        })
    }
}

#[test]
fn a_vehicle_that_is_shut_in_surfaces_while_it_can() {
    let places = [0.0, 1000.0, 2000.0, 3000.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 50.0)));
    let task = Task {
        priority: 6.0,
        risk: 2.0,
        completion_time_s: 60.0,
    };
    let edges = [(0, 1), (1, 3), (0, 2), (2, 3), (0, 3)];
    let edges = edges.map(|(a, b)| Edge::undirected(a, b, task));
    let network = Arc::new(Network::new(&places, &edges, 3.0).unwrap());
    let mission = Mission::new(network, NodeId(0), NodeId(3), 9000.0, Vehicle::paper());
    let settings = SyncSettings::default();
    let patience_s = settings.waiting.max_shut_in_s;
    let mut synchroniser = Synchroniser::new(Arc::new(mission), settings, Seed(1)).unwrap();
    let seen = fly_to_the_end(&mut synchroniser, &NoWay, |_, _| Vec::new());
    let given_up = Outcome::Aborted(AbortReason::ShutIn);
    assert_eq!(synchroniser.outcome(), Some(given_up));
    assert!(seen.position.z.abs() < 1.0, "{}", seen.position);
    let ended_s = seen.time_s;
    assert!(
        (patience_s..patience_s + 200.0).contains(&ended_s),
        "{ended_s} s"
    );
}

/// Finds no path to one place.
struct NotTo(Point3<f64>);

impl PathPlanner for NotTo {
    fn name(&self) -> &str {
        "not to"
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        let mut planned = StraightPath.plan_path(run, problem)?;
        if problem.target == self.0 {
            planned.violation = 1.0;
        }
        Ok(planned)
    }
}

#[test]
fn a_leg_whose_path_calls_are_spent_is_dropped() {
    let places = [0.0, 500.0, 1000.0].map(|x| Point3::new(x, 0.0, 50.0));
    let task = Task {
        priority: 6.0,
        risk: 2.0,
        completion_time_s: 60.0,
    };
    let edges = [
        Edge::undirected(0, 1, task),
        Edge::undirected(1, 2, task),
        Edge::undirected(0, 2, Task::TRANSIT),
    ];
    let network = Arc::new(Network::new(&places.map(Waypoint::at), &edges, 3.0).unwrap());
    let mission = Mission::new(network, NodeId(0), NodeId(2), 4000.0, Vehicle::paper());
    let mut settings = SyncSettings::default();
    settings.waiting.max_path_calls = 5;
    let mut synchroniser = Synchroniser::new(Arc::new(mission), settings, Seed(1)).unwrap();
    let seen = fly_to_the_end(&mut synchroniser, &NotTo(places[1]), |_, _| Vec::new());
    assert_eq!(synchroniser.outcome(), Some(Outcome::Docked));
    assert_eq!(synchroniser.visited(), [NodeId(0), NodeId(2)]);
    assert_eq!(synchroniser.path_calls()[0].replanned_paths, 4);
    assert!(seen.time_s < 500.0, "{} s", seen.time_s);
}
