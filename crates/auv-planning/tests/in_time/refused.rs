//! What cannot be planned in time is told with what stands in the way.

use auv_graph::{
    Edge, EdgeId, Network, NodeId, Passing, Route, Task, TaskName, TaskPlace, TimeModel, TimedTask,
    Visits, Waypoint,
};
use auv_planning::baseline::GreedyRoute;
use auv_planning::timed::schedule_at_once;
use auv_planning::{
    Budget, Objective, PlanError, Planned, RoutePlanner, RouteProblem, Run, StopReason,
};
use auv_types::{Point3, Seed};

/// 0 to 4 along a line of 100 m each at 1 m/s, and back.
fn network() -> Network {
    let waypoints = [0.0, 1.0, 2.0, 3.0, 4.0];
    let waypoints = waypoints.map(|x| Waypoint::at(Point3::new(100.0 * x, 0.0, 0.0)));
    let edges = [0, 1, 2].map(|i| Edge::undirected(i, i + 1, Task::TRANSIT));
    Network::new(&waypoints, &edges, 1.0).unwrap()
}

fn mandatory(name: &str, place: TaskPlace, windows: Vec<[f64; 2]>) -> TimedTask {
    TimedTask {
        name: TaskName::Text(name.into()),
        place,
        task: Task {
            priority: 1.0,
            risk: 1.0,
            completion_time_s: 20.0,
        },
        windows,
        mandatory: true,
        after: Vec::new(),
        chain: None,
    }
}

fn node(node: u32) -> TaskPlace {
    TaskPlace::Node(NodeId(node))
}

fn with(tasks: Vec<TimedTask>) -> TimeModel {
    TimeModel {
        tasks,
        ..TimeModel::default()
    }
}

fn planned(
    model: &TimeModel,
    destination: u32,
    available_s: f64,
) -> Result<Planned<Route>, PlanError> {
    let network = network();
    let problem = RouteProblem {
        time_model: Some(model),
        ..RouteProblem::new(&network, NodeId(0), NodeId(destination), available_s)
    };
    GreedyRoute.plan_route(&mut Run::new(Seed(1), Budget::to_the_cap()), &problem)
}

fn refusal(model: &TimeModel, destination: u32, available_s: f64) -> String {
    planned(model, destination, available_s)
        .unwrap_err()
        .to_string()
}

#[test]
fn mandatory_tasks_that_cannot_be_done_are_named() {
    let remedy = "give more time, wider windows, or make fewer tasks mandatory";
    let early = with(vec![mandatory("cast", node(2), vec![[0.0, 199.0]])]);
    assert_eq!(
        refusal(&early, 3, 1e4),
        format!("not possible: task cast cannot be reached within its windows; {remedy}")
    );
    let long = with(vec![mandatory("cast", node(2), vec![])]);
    assert_eq!(
        refusal(&long, 3, 319.0),
        format!("not possible: task cast alone takes 320.0 s of 319 s; {remedy}")
    );
    assert!(planned(&long, 3, 320.0).unwrap().violation <= 0.0);
    let both = with(vec![
        mandatory("cast", node(1), vec![[390.0, 400.0]]),
        mandatory("line", TaskPlace::Edge(EdgeId(2)), vec![[300.0, 420.0]]),
    ]);
    assert_eq!(
        refusal(&both, 3, 1e4),
        format!("not possible: tasks cast and line cannot go together in either order; {remedy}")
    );
    // Two tasks of one edge are done in one pass.
    let edge = TaskPlace::Edge(EdgeId(2));
    let one_pass = with(vec![
        mandatory("a", edge, vec![]),
        mandatory("b", edge, vec![]),
    ]);
    assert!(planned(&one_pass, 3, 340.0).unwrap().violation <= 0.0);
}

#[test]
fn what_the_quickest_route_lacks_is_its_violation() {
    let late = planned(&with(Vec::new()), 3, 240.0).unwrap();
    assert_eq!(late.best.nodes(), [0, 1, 2, 3].map(NodeId));
    assert!((late.violation - 60.0 / 240.0).abs() < 1e-12, "{late:?}");
    assert_eq!(late.stats.stop, StopReason::Optimal);
    let schedule = late.schedule.unwrap();
    assert!((schedule.end_s - 300.0).abs() < 1e-9);
    assert_eq!(schedule.departures_s.len(), 3);
}

#[test]
fn destinations_without_a_way_are_refused() {
    let message = refusal(&with(Vec::new()), 4, 1e4);
    assert!(
        message.starts_with("destination 4 cannot be reached from node 0"),
        "{message}"
    );
    let either = TimeModel {
        destinations: vec![NodeId(4), NodeId(2)],
        ..TimeModel::default()
    };
    let nearest = planned(&either, 4, 1e4).unwrap();
    assert_eq!(nearest.best.nodes().last(), Some(&NodeId(2)));
}

#[test]
fn only_the_most_weight_is_planned_in_time() {
    let (network, model) = (network(), TimeModel::default());
    let problem = RouteProblem {
        time_model: Some(&model),
        objective: Objective::paper(),
        ..RouteProblem::new(&network, NodeId(0), NodeId(3), 1e4)
    };
    let run = &mut Run::new(Seed(1), Budget::to_the_cap());
    let message = GreedyRoute.plan_route(run, &problem).unwrap_err();
    let expected =
        "planner greedy does not support routes in time with objectives other than the most weight";
    assert_eq!(message.to_string(), expected);
}

#[test]
fn places_that_cannot_be_met_in_time_are_told() {
    let meeting = |nodes: Vec<NodeId>, every_s| TimeModel {
        visits: Some(Visits { nodes, every_s }),
        ..TimeModel::default()
    };
    let message = refusal(&meeting(vec![NodeId(2)], 150.0), 3, 1e4);
    let every = "no way to a destination meets one of visits.nodes every 150 s";
    assert!(message.contains(every), "{message}");
    assert!(
        planned(&meeting(vec![NodeId(2)], 200.0), 3, 1e4)
            .unwrap()
            .violation
            <= 0.0
    );
    // Both places are on the way.
    let both = meeting(vec![NodeId(1), NodeId(2)], 101.0);
    assert!(planned(&both, 3, 1e4).unwrap().violation <= 0.0);
}

/// From 0 to 2 straight, 141 m, or over 1, 200 m, at 1 m/s.
fn triangle() -> Network {
    let places = [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0)];
    let waypoints = places.map(|(x, y)| Waypoint::at(Point3::new(x, y, 0.0)));
    let edges = [(0, 1), (1, 2), (0, 2)].map(|(a, b)| Edge::undirected(a, b, Task::TRANSIT));
    Network::new(&waypoints, &edges, 1.0).unwrap()
}

/// The nodes of the baseline's route over the triangle.
fn over_triangle(model: &TimeModel, incumbent: Option<&Route>, available_s: f64) -> Vec<NodeId> {
    let network = triangle();
    let problem = RouteProblem {
        time_model: Some(model),
        incumbent,
        ..RouteProblem::new(&network, NodeId(0), NodeId(2), available_s)
    };
    let run = &mut Run::new(Seed(1), Budget::to_the_cap());
    GreedyRoute
        .plan_route(run, &problem)
        .unwrap()
        .best
        .nodes()
        .to_vec()
}

#[test]
fn an_incumbent_is_kept_where_it_leads_to_a_destination_in_time() {
    let model = TimeModel::default();
    let route = |nodes: &[u32]| Route::new(nodes.iter().copied().map(NodeId).collect());
    let (straight, over) = ([0, 2].map(NodeId), [0, 1, 2].map(NodeId));
    assert_eq!(over_triangle(&model, Some(&route(&[0, 1, 2])), 200.0), over);
    assert_eq!(
        over_triangle(&model, Some(&route(&[0, 1, 2])), 199.0),
        straight
    );
    assert_eq!(over_triangle(&model, Some(&route(&[0, 1])), 1e4), straight);
    assert_eq!(over_triangle(&model, Some(&route(&[1, 2])), 1e4), straight);
}

#[test]
fn a_schedule_at_once_ends_at_infinity_where_no_edge_leads_on() {
    let (network, model) = (network(), TimeModel::default());
    let problem = RouteProblem::new(&network, NodeId(0), NodeId(3), 1e4);
    let end_s = |nodes: &[u32]| {
        let route = Route::new(nodes.iter().copied().map(NodeId).collect());
        schedule_at_once(&problem, &model, &route).end_s
    };
    assert!((end_s(&[0, 1, 2]) - 200.0).abs() < 1e-9);
    assert!(end_s(&[0, 2]).is_infinite());
}

#[test]
fn passing_a_node_does_its_tasks_where_the_problem_says_so() {
    let model = TimeModel {
        passing: Passing::DoesTasks,
        tasks: vec![TimedTask {
            mandatory: false,
            ..mandatory("cast", node(1), vec![])
        }],
        ..TimeModel::default()
    };
    assert_eq!(over_triangle(&model, None, 220.0), [0, 1, 2].map(NodeId));
    assert_eq!(over_triangle(&model, None, 219.0), [0, 2].map(NodeId));
    // A tour that the problem begins with does no tasks, so it passes none.
    let message = refusal(&model, 3, 1e4);
    assert!(
        message.starts_with("destination 3 cannot be reached"),
        "{message}"
    );
}
