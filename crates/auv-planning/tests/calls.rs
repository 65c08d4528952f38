//! What planners are asked and what they answer: refusals with their remedy, runs, plans, trajectories.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_obstacles::TimedPoint;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{
    Budget, Generation, PathPlanner, PathProblem, Planned, RoutePlanner, RouteProblem, Run,
    StopReason, Trajectory, Vehicle,
};
use auv_types::{Point3, Seed, Vector3};
use std::sync::Arc;

fn network() -> Network {
    let waypoints = [0.0, 100.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 0.0)));
    let edges = [Edge::undirected(0, 1, Task::TRANSIT)];
    Network::new(&waypoints, &edges, 1.0).unwrap()
}

fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "{part}: {message}");
    }
}

#[test]
fn a_route_problem_names_every_wrong_value_and_its_remedy() {
    let network = network();
    let times = [-1.0, f64::NAN, 3.0];
    let problem = RouteProblem {
        times: Some(&times),
        ..RouteProblem::new(&network, NodeId(7), NodeId(1), f64::NAN)
    };
    let remedies = [
        "start is node 7; nodes are 0 to 1",
        "time_available_s is NaN; give seconds of at least 0 (infinite for no limit)",
        "times has 3 entries; give one for each of the 2 arcs",
        "times[0] is -1; give seconds of at least 0 (infinite to block the arc)",
        "times[1] is NaN",
    ];
    assert_says(&problem.validate().to_string(), &remedies);
}

#[test]
fn a_path_problem_names_every_wrong_value_and_its_remedy() {
    let vehicle = Vehicle {
        min_speed_mps: 5.0,
        ..Vehicle::default()
    };
    let problem = PathProblem {
        departure_s: f64::INFINITY,
        start_velocity: Some(Vector3::new(0.0, 2e9, 0.0)),
        ..PathProblem::new(
            Point3::new(1e10, 0.0, 0.0),
            Point3::new(0.0, 2e7, 0.0),
            &vehicle,
        )
    };
    let remedies = [
        "start is (1e10, 0e0, 0e0); give finite coordinates within 10,000 km",
        "target is (0.0, 20000000.0, 0.0); give finite coordinates within 10,000 km",
        "start_velocity is not finite or beyond 1e9; give m/s or none",
        "departure_s is not finite or beyond 1e10; give seconds of mission time",
        "vehicle.max_speed_mps is 2; speeds must be ordered: min 5 <= cruise 1.5 <= max",
    ];
    assert_says(&problem.validate().to_string(), &remedies);
}

#[test]
fn a_run_tells_its_observer_each_generation_and_what_it_has_left() {
    let network = network();
    let problem = RouteProblem::new(&network, NodeId(0), NodeId(1), 100.0);
    let mut seen = Vec::new();
    let mut observer = |g: &Generation<'_>| seen.push((g.index, g.evaluations, g.best.cost));
    let mut run = Run::new(Seed(5), Budget::evaluations(3)).with_observer(&mut observer);
    assert_eq!((run.seed(), run.evaluations_left()), (Seed(5), Some(3)));
    assert!(run.is_observed() && !run.has_deadline() && !run.deadline().passed());
    let shown = format!("{run:?}");
    assert_says(
        &shown,
        &["evaluations_left: Some(3)", "generations: 0", "stop: None"],
    );
    let _ = GreedyRoute.plan_route(&mut run, &problem).unwrap();
    assert_eq!(run.evaluations_left(), Some(2));
    assert_eq!(seen.len(), 1);
    assert_eq!((seen[0].0, seen[0].1), (0, 1));
}

#[test]
fn planners_behind_pointers_plan_as_they_do() {
    fn route(planner: impl RoutePlanner, problem: &RouteProblem<'_>) -> (String, usize) {
        let run = &mut Run::new(Seed(1), Budget::to_the_cap());
        let nodes = planner.plan_route(run, problem).unwrap().best.nodes().len();
        (planner.name().into(), nodes)
    }
    let network = network();
    let problem = RouteProblem::new(&network, NodeId(0), NodeId(1), 100.0);
    let expected = route(GreedyRoute, &problem);
    assert_eq!(expected, ("greedy".into(), 2));
    let lent: &dyn RoutePlanner = &GreedyRoute;
    assert_eq!(route(lent, &problem), expected);
    assert_eq!(route(Box::new(GreedyRoute), &problem), expected);
    assert_eq!(
        route(Arc::new(GreedyRoute) as Arc<dyn RoutePlanner>, &problem),
        expected
    );
    let path: Box<dyn PathPlanner> = Box::new(StraightPath);
    assert_eq!(path.name(), "straight");
}

#[test]
fn a_plan_says_its_cost_whether_it_is_feasible_and_why_it_ended() {
    let vehicle = Vehicle::paper();
    let (start, target) = (Point3::origin(), Point3::new(300.0, 0.0, 0.0));
    let problem = PathProblem::new(start, target, &vehicle);
    let planned = |violation| {
        let mut run = Run::new(Seed(1), Budget::to_the_cap());
        let plan = StraightPath.plan_path(&mut run, &problem).unwrap();
        Planned { violation, ..plan }
    };
    let line = "2 points, 300.0 m in 100.0 s; cost 100.000, ";
    let end = "; 1 evaluations, finished";
    assert_eq!(planned(0.0).to_string(), format!("{line}feasible{end}"));
    assert_eq!(
        planned(1.5).to_string(),
        format!("{line}infeasible: violation 1.500{end}")
    );
    assert!(planned(0.0).feasible().is_ok());
    assert!(planned(1.5).feasible().unwrap_err().violation > 1.0);
}

#[test]
fn only_time_and_cancelling_are_not_reproducible() {
    for (stop, word, is_reproducible) in [
        (StopReason::Finished, "finished", true),
        (StopReason::Optimal, "optimal", true),
        (StopReason::Stalled, "stalled", true),
        (StopReason::TargetReached, "target_reached", true),
        (StopReason::EvaluationsSpent, "evaluations_spent", true),
        (StopReason::DeadlinePassed, "deadline_passed", false),
        (StopReason::Cancelled, "cancelled", false),
    ] {
        assert_eq!(
            (stop.as_str(), stop.is_reproducible()),
            (word, is_reproducible)
        );
    }
}

#[test]
fn a_vehicle_rests_before_and_after_its_trajectory() {
    let vehicle = Vehicle::paper();
    let (start, target) = (Point3::origin(), Point3::new(300.0, 0.0, 0.0));
    let problem = PathProblem {
        departure_s: 50.0,
        ..PathProblem::new(start, target, &vehicle)
    };
    let path = problem.timed(&[start, target]).unwrap();
    let still = Vector3::zeros();
    let ahead = Vector3::new(3.0, 0.0, 0.0);
    assert_eq!(path.at(0.0), (start, still));
    assert_eq!(path.at(1e3), (target, still));
    let (place, velocity) = path.at(100.0);
    assert!((place.x - 150.0).abs() < 1e-9 && (velocity - ahead).norm() < 1e-9);
    assert!((path.end_velocity() - ahead).norm() < 1e-9);
    assert!(path.curve().is_none());
    let place = TimedPoint::new(target, 9.0);
    let hover = Trajectory::hover(place, 60.0);
    assert_eq!(hover.points().len(), 2);
    assert!((hover.duration_s() - 60.0).abs() < 1e-12);
    assert_eq!(hover.end_velocity(), still);
    // Without a time it is a point.
    for duration_s in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        let point = Trajectory::hover(place, duration_s);
        assert_eq!((point.points().len(), point.end_velocity()), (1, still));
    }
}
