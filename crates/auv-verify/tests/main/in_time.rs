//! Routes in time on a small network.

use auv_graph::{
    Edge, Network, NodeId, Route, Task, TaskName, TaskPlace, TimeModel, TimedTask, Waypoint,
};
use auv_planning::{RouteProblem, Schedule, TaskDone};
use auv_types::Point3;
use auv_verify::{RouteReport, TimeViolation as V, verify_route_in_time};

pub(crate) const NEARLY_S: f64 = 0.9e-6;
pub(crate) const BEYOND_S: f64 = 1.1e-6;

pub(crate) fn task(priority: f64, risk: f64, completion_time_s: f64) -> Task {
    Task {
        priority,
        risk,
        completion_time_s,
    }
}

/// Waypoints 300 m apart in a line, at 3 m/s; 100 s a leg. Edge 0 takes 50 s of work, edge 1 takes 20 s, edges 2
/// (one way) and 3 (from end to start, 900 m) none.
pub(crate) fn network() -> Network {
    let waypoints = [0.0, 300.0, 600.0, 900.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 9.0)));
    let edges = [
        Edge::undirected(0, 1, task(4.0, 2.0, 50.0)),
        Edge::undirected(2, 1, task(6.0, 4.0, 20.0)),
        Edge::directed(2, 3, Task::TRANSIT),
        Edge::undirected(3, 0, Task::TRANSIT),
    ];
    Network::new(&waypoints, &edges, 3.0).unwrap()
}

/// A task of weight 2 that takes 30 s.
pub(crate) fn work(place: TaskPlace) -> TimedTask {
    TimedTask {
        name: TaskName::Number(0),
        place,
        task: task(8.0, 4.0, 30.0),
        windows: Vec::new(),
        mandatory: false,
        after: Vec::new(),
        chain: None,
    }
}

pub(crate) fn at(node: u32) -> TaskPlace {
    TaskPlace::Node(NodeId(node))
}

/// A model with these tasks.
pub(crate) fn model(tasks: impl IntoIterator<Item = TimedTask>) -> TimeModel {
    TimeModel {
        tasks: tasks.into_iter().collect(),
        ..TimeModel::default()
    }
}

pub(crate) fn route(nodes: &[u32]) -> Route {
    Route::new(nodes.iter().copied().map(NodeId).collect())
}

pub(crate) fn schedule(departures_s: &[f64], done: &[(usize, f64)]) -> Schedule {
    let done = done
        .iter()
        .map(|&(task, start_s)| TaskDone { task, start_s });
    Schedule {
        departures_s: departures_s.to_vec(),
        done: done.collect(),
        end_s: 0.0,
    }
}

/// From node 0 to node 3 within 1,000 s.
pub(crate) fn checked(
    model: &TimeModel,
    nodes: &[u32],
    departures_s: &[f64],
    done: &[(usize, f64)],
) -> (RouteReport, Vec<V>) {
    let network = network();
    let problem = RouteProblem {
        time_model: Some(model),
        ..RouteProblem::new(&network, NodeId(0), NodeId(3), 1_000.0)
    };
    verify_route_in_time(&problem, &route(nodes), &schedule(departures_s, done))
}

pub(crate) fn found(
    model: &TimeModel,
    nodes: &[u32],
    departures_s: &[f64],
    done: &[(usize, f64)],
) -> Vec<V> {
    checked(model, nodes, departures_s, done).1
}

/// The line from node 0 to node 3, each node left as soon as work of 30 s at node 1, if any, is done.
pub(crate) fn along(model: &TimeModel, done: &[(usize, f64)]) -> Vec<V> {
    let work_s = 30.0 * done.len() as f64;
    let departures_s = [0.0, 150.0 + work_s, 270.0 + work_s];
    found(model, &[0, 1, 2, 3], &departures_s, done)
}
