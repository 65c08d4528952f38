//! Mandatory tasks that lie off the quickest way.

use auv_graph::{Edge, Network, NodeId, Task, TaskName, TaskPlace, TimeModel, TimedTask, Waypoint};
use auv_planning::RouteProblem;
use auv_planning::timed::{Step, TimedNetwork, TimedTour, fill, pieces};
use auv_types::Point3;

/// Steps of a tour that is filled: one-way edges lead 0, 1, 3 and, longer, 0, 4, 2, 5, 3; there is a task at node 2.
fn filled(mandatory: bool, available_s: f64) -> Vec<u32> {
    let at = [
        (0, 0),
        (500, 0),
        (500, 400),
        (1_000, 0),
        (250, 300),
        (750, 300),
    ];
    let waypoint = |(x, y): (i32, i32)| Waypoint::at(Point3::new(f64::from(x), f64::from(y), 5.0));
    let edges = [(0, 1), (1, 3), (0, 4), (4, 2), (2, 5), (5, 3)];
    let edges = edges.map(|(from, to)| Edge::directed(from, to, Task::TRANSIT));
    let network = Network::new(&at.map(waypoint), &edges, 1.0).unwrap();
    let model = TimeModel {
        tasks: vec![TimedTask {
            name: TaskName::Text("cast".into()),
            place: TaskPlace::Node(NodeId(2)),
            task: Task {
                priority: 1.0,
                risk: 1.0,
                completion_time_s: 60.0,
            },
            windows: Vec::new(),
            after: Vec::new(),
            chain: None,
            mandatory,
        }],
        ..TimeModel::default()
    };
    let mut problem = RouteProblem::new(&network, NodeId(0), NodeId(3), available_s);
    problem.time_model = Some(&model);
    let tables = TimedNetwork::new(&problem, &model);
    let quickest = [0, 1, 3].map(Step::pass).to_vec();
    let mut tour = TimedTour::new(&tables, quickest).unwrap();
    fill(&tables, &mut tour, &pieces(&tables));
    tour.steps().iter().map(|step| step.node).collect()
}

#[test]
fn steps_make_way_for_a_mandatory_task_alone() {
    assert_eq!(filled(true, 2_000.0), [0, 4, 2, 5, 3]);
    assert_eq!(filled(false, 2_000.0), [0, 1, 3]);
    assert_eq!(filled(true, 1_100.0), [0, 1, 3], "there is no time for it");
}
