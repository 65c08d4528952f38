//! A hand-made state for tests of single functions.

use crate::beliefs::Beliefs;
use crate::check::Acceptor;
use crate::ledger::Ledger;
use crate::mode::{Awaited, Duty, Leg, LegMode, Mode, NextRoute};
use crate::soundings::Soundings;
use crate::state::{RouteInForce, State};
use crate::tide::Tide;
use crate::view::View;
use crate::{Mission, PathCall, SyncSettings, Synchroniser};
use auv_graph::{
    Edge, EdgeId, Network, NodeId, Task, TaskName, TaskPlace, TimeModel, TimedTask, Waypoint,
};
use auv_obstacles::{Region, TimedPoint};
use auv_planning::{Trajectory, Vehicle};
use auv_types::{Point3, Seed};
use std::sync::Arc;

/// Everything that a [`View`] needs.
pub(crate) struct Fixture {
    pub(crate) mission: Mission,
    pub(crate) settings: SyncSettings,
    pub(crate) home_s: Vec<f64>,
    pub(crate) tide: Option<Tide>,
    pub(crate) state: State,
}

/// A place at 20 m depth.
pub(crate) fn place(x: f64) -> Point3<f64> {
    Point3::new(x, 0.0, 20.0)
}

/// A polyline of places at 20 m depth and times.
pub(crate) fn way(points: &[(f64, f64)]) -> Trajectory {
    let points = points.iter().map(|&(x, t)| TimedPoint::new(place(x), t));
    Trajectory::new(points.collect()).unwrap()
}

impl Fixture {
    /// A vehicle that hovers and makes 3 m/s; waypoints 0, 1 and 2 at 0, 900 and 1800 m north; edges
    /// 0-1 and 1-2 with a task of 60 s, a transit 0-2; 2000 s, a clearance of 5 m; no margins, no
    /// current, no regions. Route 0-1-2 is in force. At 0 s the vehicle is at waypoint 0, on a path to
    /// waypoint 1, where it arrives at 300 s and stays until 360 s.
    pub(crate) fn new() -> Self {
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
        let waypoints = [0.0, 900.0, 1800.0].map(|x| Waypoint::at(place(x)));
        let network = Arc::new(Network::new(&waypoints, &edges, 3.0).unwrap());
        let mut mission = Mission::new(network, NodeId(0), NodeId(2), 2_000.0, Vehicle::paper());
        mission.clearance_m = 5.0;
        let mut settings = SyncSettings::default();
        settings.margins.off_track_m = 5.0;
        settings.margins.detour_margin = 0.0;
        settings.margins.detour_margin_s = 0.0;
        let state = State {
            mode: Mode::Leg(Box::new(Self::leg())),
            beliefs: Beliefs::new(&mission),
            soundings: Soundings::default(),
            ledger: Ledger::new(&mission),
            route: RouteInForce::Planned([0, 1, 2].map(NodeId).to_vec()),
            due: Vec::new(),
            in_force: Some(way(&[(0.0, 0.0), (900.0, 300.0), (900.0, 360.0)]).into()),
            next_question: 2,
        };
        Self {
            mission,
            settings,
            home_s: vec![600.0, 300.0, 0.0],
            tide: None,
            state,
        }
    }

    /// The same with two tasks at waypoint 1, the second after the first, and one along edge 1.
    pub(crate) fn with_timed_tasks() -> Self {
        let task = |place, windows: &[[f64; 2]], after: &[usize]| TimedTask {
            name: TaskName::Number(0),
            place,
            task: Task {
                priority: 4.0,
                risk: 2.0,
                completion_time_s: 30.0,
            },
            windows: windows.to_vec(),
            mandatory: after.is_empty(),
            after: after.to_vec(),
            chain: None,
        };
        let at_1 = TaskPlace::Node(NodeId(1));
        let tasks = vec![
            task(at_1, &[[0.0, 100.0], [500.0, 600.0]], &[]),
            task(at_1, &[], &[0]),
            task(TaskPlace::Edge(EdgeId(1)), &[[0.0, 50.0]], &[]),
        ];
        let mut fixture = Self::new();
        fixture.mission.time_model = Some(Arc::new(TimeModel {
            tasks,
            ..TimeModel::default()
        }));
        fixture
    }

    /// Leg 0-1 as it starts, expected to take 360 s.
    pub(crate) fn leg() -> Leg {
        Leg {
            from: NodeId(0),
            to: NodeId(1),
            duty: Duty::Task(EdgeId(0)),
            mode: LegMode::Underway { arrives_s: 300.0 },
            awaited: Awaited::Nothing,
            next_route: NextRoute::AtTarget,
            started_s: 0.0,
            departs_s: 0.0,
            expected_s: 360.0,
            charged_s: 0.0,
            task_left_s: 60.0,
            works: Vec::new(),
            worked: false,
            waited_s: 0.0,
            booked_s: 0.0,
            asked_s: 0.0,
            fixes: 0,
            fix_asked_s: 0.0,
            dock_contact: None,
            misses: 0,
            missed_s: 0.0,
            astray: None,
            failures: 0,
            calls: 1,
            violation: 0.0,
            cost: 0.0,
            compute_s: 0.0,
        }
    }

    /// The leg, to be changed.
    pub(crate) fn leg_mut(&mut self) -> &mut Leg {
        match &mut self.state.mode {
            Mode::Leg(leg) => leg,
            mode => panic!("no leg in {mode:?}"),
        }
    }

    /// The vehicle at a place at a time.
    pub(crate) fn at(mut self, time_s: f64, x: f64) -> Self {
        self.state.beliefs.now_s = time_s;
        self.state.beliefs.position = place(x);
        self
    }

    /// The vehicle at its place on the trajectory in force at a time.
    pub(crate) fn on_track(self, time_s: f64) -> Self {
        let x = self.state.in_force.as_ref().unwrap().whole.at(time_s).0.x;
        self.at(time_s, x)
    }

    /// The leg changed.
    pub(crate) fn with_leg(mut self, change: impl FnOnce(&mut Leg)) -> Self {
        change(self.leg_mut());
        self
    }

    /// Among such regions.
    pub(crate) fn among(mut self, regions: &[Region]) -> Self {
        self.state.beliefs.regions = regions.into();
        self
    }

    /// Calls a function with a view of the fixture.
    pub(crate) fn view<T>(&self, ask: impl FnOnce(View<'_>) -> T) -> T {
        let mission = Arc::new(self.mission.clone());
        ask(View {
            mission: &mission,
            settings: &self.settings,
            seed: Seed(0),
            acceptor: Acceptor::Verifier,
            home_s: &self.home_s,
            tide: self.tide.as_ref(),
            state: &self.state,
        })
    }

    /// A synchroniser in this state.
    pub(crate) fn into_synchroniser(self) -> Synchroniser {
        Synchroniser::with_state(Arc::new(self.mission), self.settings, Seed(0), self.state)
    }

    /// Calls a function with a view of the fixture and its leg.
    pub(crate) fn ask<T>(&self, ask: impl FnOnce(View<'_>, &Leg) -> T) -> T {
        self.view(|view| ask(view, view.leg().unwrap()))
    }
}

/// A row of the path table with the times that the ledger reads.
pub(crate) fn path_row(completed: bool, waited_s: f64, leg_s: f64) -> PathCall {
    PathCall {
        route_call: 1,
        call: 1,
        from: NodeId(0),
        to: NodeId(1),
        at_s: 0.0,
        violation: 0.0,
        cost: 0.0,
        compute_s: 0.0,
        leg_s,
        expected_s: 0.0,
        available_s: 0.0,
        replan: false,
        next_leg: false,
        replanned_paths: 0,
        waited_s,
        completed,
    }
}
