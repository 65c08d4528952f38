//! An answer is judged against the question that was asked, not against later observations.

use auv_graph::{Edge, Network, NodeId, Route, Task, Waypoint};
use auv_mission::{
    Command, Event, Mission, Observation, PathRequest, RouteRequest, SyncSettings, Synchroniser,
};
use auv_obstacles::Region;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{PathPlanner, Planned, RoutePlanner, Run, Stats, Vehicle};
use auv_types::{Point3, Seed, Vector3};
use std::sync::Arc;

fn seen(time_s: f64, x: f64, regions: &[Region]) -> Event {
    Event::Tick(Observation {
        position_sigma_m: 0.0,
        time_s,
        position: Point3::new(x, 0.0, 50.0),
        velocity: Vector3::new(3.0, 0.0, 0.0),
        regions: regions.into(),
    })
}

fn route_request(commands: &[Command]) -> Option<&RouteRequest> {
    commands.iter().find_map(|command| match command {
        Command::PlanRoute(request) => Some(request),
        _ => None,
    })
}

fn path_request(commands: &[Command]) -> Option<&PathRequest> {
    commands.iter().find_map(|command| match command {
        Command::PlanPath(request) => Some(request),
        _ => None,
    })
}

fn path_answer(request: &PathRequest) -> Event {
    let mut run = Run::new(request.seed, request.budget);
    Event::PathPlanned {
        request: request.id,
        result: StraightPath.plan_path(&mut run, &request.problem()),
        compute_s: 0.0,
    }
}

/// Asked for its first path, 3 km of open water ahead, one waypoint half-way.
fn asked_for_a_path(max_path_calls: u32) -> (Synchroniser, PathRequest) {
    let places = [0.0, 1500.0, 3000.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 50.0)));
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
    let network = Arc::new(Network::new(&places, &edges, 3.0).unwrap());
    let mission = Mission::new(network, NodeId(0), NodeId(2), 9000.0, Vehicle::paper());
    let mut settings = SyncSettings::default();
    settings.waiting.max_path_calls = max_path_calls;
    let mut synchroniser = Synchroniser::new(Arc::new(mission), settings, Seed(1)).unwrap();
    let commands = synchroniser.step(seen(0.0, 0.0, &[]));
    let request = route_request(&commands).unwrap();
    let mut run = Run::new(request.seed, request.budget);
    let answer = Event::RoutePlanned {
        request: request.id,
        result: GreedyRoute.plan_route(&mut run, &request.problem()),
        compute_s: 0.0,
    };
    let commands = synchroniser.step(answer);
    let request = path_request(&commands).unwrap().clone();
    (synchroniser, request)
}

fn rock(x: f64) -> Region {
    Region {
        from_s: 10.0,
        ..Region::ball(Point3::new(x, 0.0, 50.0), 80.0)
    }
}

#[test]
fn a_route_has_the_same_verdict_with_and_without_a_tick_between() {
    let (mut synchroniser, request) = asked_for_a_path(1);
    synchroniser.step(path_answer(&request));
    // The leg's only path call is spent and its path is not clear any more: the leg is dropped.
    let commands = synchroniser.step(seen(20.0, 60.0, &[rock(500.0)]));
    let asked = route_request(&commands).unwrap();
    let route = Route::new(vec![asked.start, NodeId(1), NodeId(2)]);
    assert!(auv_verify::verify_route(&asked.problem(), &route).is_valid());
    for ticks in 0..4 {
        let mut synchroniser = synchroniser.clone();
        for tick in 1..=ticks {
            let time_s = 20.0 + f64::from(tick);
            synchroniser.step(seen(time_s, 3.0 * time_s, &[rock(500.0)]));
        }
        let planned = Planned::new(route.clone(), -1.0, 0.0, Stats::default());
        synchroniser.step(Event::RoutePlanned {
            request: asked.id,
            result: Ok(planned),
            compute_s: 0.0,
        });
        let call = synchroniser.route_calls().last().unwrap();
        assert!(call.valid && call.adopted, "{ticks} ticks between");
        assert_eq!(call.route, route.nodes());
    }
}

#[test]
fn a_path_through_what_has_appeared_since_is_not_followed() {
    for (x, follows) in [(900.0, false), (-900.0, true)] {
        let (mut synchroniser, request) = asked_for_a_path(10);
        synchroniser.step(seen(0.5, 0.0, &[rock(x)]));
        let commands = synchroniser.step(path_answer(&request));
        let to_target = synchroniser
            .trajectory()
            .is_some_and(|way| (way.end().position.x - 1500.0).abs() < 1.0);
        assert_eq!(to_target, follows, "{x} m: {commands:?}");
    }
}

#[test]
fn an_answer_told_twice_or_to_no_open_question_changes_nothing() {
    let (mut synchroniser, request) = asked_for_a_path(10);
    let answer = path_answer(&request);
    assert!(!synchroniser.step(answer.clone()).is_empty());
    let way = synchroniser.trajectory().cloned();
    assert!(synchroniser.step(answer).is_empty());
    let unknown = Event::RoutePlanned {
        request: 999,
        result: Err(auv_planning::PlanError::Failed {
            planner: "none".into(),
            reason: "never asked".into(),
        }),
        compute_s: 5.0,
    };
    assert!(synchroniser.step(unknown).is_empty());
    assert_eq!(synchroniser.trajectory().cloned(), way);
}
