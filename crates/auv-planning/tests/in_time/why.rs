//! Why tasks are left out.

use auv_graph::{
    Edge, EdgeId, Network, NodeId, Task, TaskName, TaskPlace, TimeModel, TimedTask, Waypoint,
};
use auv_planning::timed::{LeftOut, left_out};
use auv_planning::{RouteProblem, Schedule, TaskDone};
use auv_types::Point3;

const WORK: Task = Task {
    priority: 2.0,
    risk: 1.0,
    completion_time_s: 20.0,
};

fn task(place: TaskPlace) -> TimedTask {
    TimedTask {
        name: TaskName::Number(0),
        place,
        task: WORK,
        windows: Vec::new(),
        mandatory: false,
        after: Vec::new(),
        chain: None,
    }
}

fn at(node: u32) -> TimedTask {
    task(TaskPlace::Node(NodeId(node)))
}

/// 0 to 3 along a line of 100 m each at 1 m/s; 4 leads nowhere on, 5 has no edges.
fn network() -> Network {
    let waypoints = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
    let waypoints = waypoints.map(|x| Waypoint::at(Point3::new(100.0 * x, 0.0, 0.0)));
    let edges = [
        Edge::undirected(0, 1, Task::TRANSIT),
        Edge::undirected(1, 2, Task::TRANSIT),
        Edge::undirected(2, 3, Task::TRANSIT),
        Edge::directed(1, 4, Task::TRANSIT),
    ];
    Network::new(&waypoints, &edges, 1.0).unwrap()
}

/// The reasons where a route does the tasks `done`.
fn reasons(tasks: Vec<TimedTask>, done: &[usize], available_s: f64) -> Vec<(usize, LeftOut)> {
    let network = network();
    let model = TimeModel {
        tasks,
        ..TimeModel::default()
    };
    let problem = RouteProblem {
        time_model: Some(&model),
        ..RouteProblem::new(&network, NodeId(0), NodeId(3), available_s)
    };
    let done = done.iter().map(|&task| TaskDone { task, start_s: 0.0 });
    let schedule = Schedule {
        done: done.collect(),
        ..Schedule::default()
    };
    left_out(&problem, &model, &schedule)
}

#[test]
fn places_without_a_way_there_or_on_are_told() {
    let tasks = vec![at(5), at(4), at(1), task(TaskPlace::Edge(EdgeId(3)))];
    let expected = [
        (0, LeftOut::NoWay),
        (1, LeftOut::NoWay),
        (2, LeftOut::Time),
        // Its near end leads on, but who passes it does not come back.
        (3, LeftOut::Time),
    ];
    assert_eq!(reasons(tasks, &[], 1e4), expected);
}

#[test]
fn windows_that_close_before_the_earliest_arrival_are_told() {
    let closes = |place, last_s| TimedTask {
        windows: vec![[0.0, last_s]],
        ..task(place)
    };
    let node = TaskPlace::Node(NodeId(2));
    // Node 2 is reached after 200 s, the far end of edge 1 as well.
    let edge = TaskPlace::Edge(EdgeId(1));
    let tasks = vec![
        closes(node, 199.0),
        closes(node, 200.0),
        closes(edge, 199.0),
        closes(edge, 200.0),
    ];
    let expected = [
        (0, LeftOut::Window),
        (1, LeftOut::Time),
        (2, LeftOut::Window),
        (3, LeftOut::Time),
    ];
    assert_eq!(reasons(tasks, &[], 1e4), expected);
}

#[test]
fn a_task_after_another_waits_for_it() {
    let after = |before: usize, last_s: f64| TimedTask {
        windows: vec![[0.0, last_s]],
        after: vec![before],
        ..at(1)
    };
    // The first is done after 220 s at the earliest, the one after it 20 s later.
    let tasks = vec![
        at(2),
        after(0, 219.0),
        after(0, 220.0),
        after(2, 239.0),
        after(2, 240.0),
    ];
    let expected = [
        (1, LeftOut::Window),
        (2, LeftOut::Time),
        (3, LeftOut::Window),
        (4, LeftOut::Order),
    ];
    assert_eq!(reasons(tasks.clone(), &[0], 1e4), expected);
    // What it comes after is left out.
    assert_eq!(reasons(tasks, &[1], 1e4)[1], (2, LeftOut::Order));
    // One that can never be done delays nothing.
    let never = TimedTask {
        windows: vec![[0.0, 1.0]],
        ..at(2)
    };
    let expected = [(0, LeftOut::Window), (1, LeftOut::Order)];
    assert_eq!(reasons(vec![never, after(0, 150.0)], &[], 1e4), expected);
}

#[test]
fn each_reason_is_a_sentence() {
    let all = [
        (LeftOut::NoWay, "no way leads there and on"),
        (LeftOut::Window, "its windows close too early"),
        (LeftOut::Order, "what it comes after or with is left out"),
        (LeftOut::Time, "no time is left for it"),
        (LeftOut::Weight, "more weight would be left out for it"),
    ];
    for (reason, text) in all {
        assert_eq!(reason.to_string(), text);
    }
}
