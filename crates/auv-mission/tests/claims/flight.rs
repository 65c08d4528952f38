//! A mission over four waypoints, flown by a perfect vehicle with simple planners.

use crate::world::{Detours, Routes};
use auv_graph::{Edge, Network, NodeId, Task, TaskName, TaskPlace, TimeModel, TimedTask, Waypoint};
use auv_mission::driver::Stepped;
use auv_mission::{Event, Manner, Mission, Observation, SyncSettings, Synchroniser};
use auv_obstacles::TimedPoint;
use auv_planning::Vehicle;
use auv_types::{Point3, Seed, Vector3};
use std::sync::Arc;

/// Time between two ticks at most, seconds.
pub(crate) const TICK_S: f64 = 5.0;

/// No deeper than this the vehicle is at the surface.
pub(crate) const ANTENNA_M: f64 = 0.5;
/// A fix takes so long there, seconds.
pub(crate) const FIX_S: f64 = 60.0;

/// Waypoints 0, 1, 2 and the dock 3 at the corners of a square of 800 m, 20 to 40 m deep; edges along its sides
/// without work.
pub(crate) fn mission(vehicle: Vehicle, budget_s: f64) -> Mission {
    let places = [
        Point3::new(0.0, 0.0, 20.0),
        Point3::new(800.0, 0.0, 30.0),
        Point3::new(800.0, 800.0, 40.0),
        Point3::new(0.0, 800.0, 25.0),
    ];
    let edges = [(0, 1), (1, 2), (2, 3)];
    let edges = edges.map(|(from, to)| Edge::undirected(from, to, Task::TRANSIT));
    let network = Network::new(&places.map(Waypoint::at), &edges, vehicle.speed_mps).unwrap();
    Mission::new(Arc::new(network), NodeId(0), NodeId(3), budget_s, vehicle)
}

/// Work at a waypoint.
pub(crate) fn work_at(node: u32, takes_s: f64, windows: &[[f64; 2]]) -> TimedTask {
    TimedTask {
        name: TaskName::Number(i64::from(node)),
        place: TaskPlace::Node(NodeId(node)),
        task: Task {
            priority: 6.0,
            risk: 2.0,
            completion_time_s: takes_s,
        },
        windows: windows.to_vec(),
        mandatory: false,
        after: Vec::new(),
        chain: None,
    }
}

/// The mission with one task at waypoint 1 that is done so, and stays for a while beside what is flown.
pub(crate) fn with_manner(mut mission: Mission, manner: Manner, stays_s: f64) -> Mission {
    let takes_s = manner.takes_s(&mission.vehicle, mission.position_of(NodeId(1))) + stays_s;
    mission.time_model = Some(Arc::new(TimeModel {
        tasks: vec![work_at(1, takes_s, &[])],
        ..TimeModel::default()
    }));
    mission.manners.insert(0, manner);
    mission
}

/// What a vehicle flew.
pub(crate) struct Flight {
    pub(crate) synchroniser: Synchroniser,
    /// Where it was at each tick.
    pub(crate) track: Vec<TimedPoint>,
    /// The ticks at which it was told to surface.
    pub(crate) surfaced: Vec<bool>,
    /// How far it had gone since its last fix, metres.
    pub(crate) under_m: Vec<f64>,
}

impl Flight {
    /// The depths from one time to another, the least and the greatest.
    pub(crate) fn depths_m(&self, from_s: f64, until_s: f64) -> (f64, f64) {
        let times = from_s..=until_s;
        let part = self.track.iter().filter(|p| times.contains(&p.time_s));
        part.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
            (low.min(p.position.z), high.max(p.position.z))
        })
    }

    /// How often it began to surface.
    pub(crate) fn surfacings(&self) -> usize {
        let begins = |pair: &&[bool]| !pair[0] && pair[1];
        self.surfaced.windows(2).filter(begins).count()
    }
}

/// Flies a mission to its end. The vehicle knows its place with a standard deviation that depends on how far it went
/// since its last fix, and is told what `told` says before each tick.
pub(crate) fn fly(
    mission: Mission,
    sigma_m: impl Fn(f64) -> f64,
    mut told: impl FnMut(&Synchroniser, TimedPoint) -> Option<Event>,
) -> Flight {
    let mission = Arc::new(mission);
    let settings = SyncSettings::default();
    let synchroniser = Synchroniser::new(Arc::clone(&mission), settings, Seed(3)).unwrap();
    let driver = Stepped::new(&Routes, &Detours);
    let mut flight = Flight {
        synchroniser,
        track: Vec::new(),
        surfaced: Vec::new(),
        under_m: Vec::new(),
    };
    let at_start = (mission.position_of(mission.start), Vector3::zeros());
    let (mut time_s, mut under_m, mut under_s) = (0.0, 0.0, 0.0);
    for _ in 0..20_000 {
        let way = flight.synchroniser.trajectory();
        let (position, velocity) = way.map_or(at_start, |way| way.at(time_s));
        if let Some(last) = flight.track.last() {
            under_m += (position - last.position).norm();
        }
        if position.z > ANTENNA_M {
            under_s = time_s;
        } else if time_s - under_s >= FIX_S {
            under_m = 0.0;
        }
        let here = TimedPoint::new(position, time_s);
        if let Some(event) = told(&flight.synchroniser, here) {
            driver.tell(&mut flight.synchroniser, event);
        }
        let seen = Observation {
            position_sigma_m: sigma_m(under_m),
            time_s,
            position,
            velocity,
            regions: Arc::new([]),
        };
        driver.tick(&mut flight.synchroniser, seen);
        flight.track.push(here);
        flight.under_m.push(under_m);
        flight.surfaced.push(flight.synchroniser.surfaces());
        if flight.synchroniser.outcome().is_some() {
            return flight;
        }
        let due_s = flight.synchroniser.due_s();
        time_s = if due_s > time_s {
            due_s.min(time_s + TICK_S)
        } else {
            time_s + TICK_S
        };
    }
    panic!("the mission never ended");
}
