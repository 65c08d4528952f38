//! Which plans are accepted.

use super::*;
use crate::fixture::{Fixture, place, way};
use crate::question::RouteFrom;
use crate::{PathRequest, RouteReason, RouteRequest, path_question, route_question};
use auv_graph::{ArcId, NodeId, Profiles};
use auv_obstacles::Region;
use auv_ocean::AnalyticBed;
use auv_planning::Stats;
use auv_types::{Bounds, Point3};
use std::collections::BTreeMap;
use std::sync::Arc;

#[test]
fn an_answer_holds_numbers_only() {
    let takes = |cost, violation| {
        let planned = Planned::new((), cost, violation, Stats::default());
        in_numbers(Ok(planned), 0.0).0.is_ok()
    };
    assert!(takes(1.0, 2.0) && takes(f64::INFINITY, f64::INFINITY));
    assert!(!takes(f64::NAN, 2.0) && !takes(1.0, f64::NAN));
    for (told_s, taken_s) in [
        (3.0, 3.0),
        (-3.0, -3.0),
        (1e7, 1e6),
        (-1e7, -1e6),
        (f64::INFINITY, 0.0),
        (f64::NAN, 0.0),
    ] {
        let planned = Planned::new((), 0.0, 0.0, Stats::default());
        assert_eq!(in_numbers(Ok(planned), told_s).1, taken_s);
    }
}

fn route(nodes: &[u32]) -> Route {
    Route::new(nodes.iter().map(|&node| NodeId(node)).collect())
}

/// The question for a route from waypoint 0.
fn asked(fixture: &Fixture) -> RouteRequest {
    fixture.view(|view| {
        let question = route_question::ask(view, RouteReason::Start, RouteFrom::Waypoint);
        question.request(view.mission, view.tide, view.seed)
    })
}

fn is_valid(request: &RouteRequest, nodes: &[u32]) -> bool {
    let planned = Planned::new(route(nodes), 0.0, 0.0, Stats::default());
    route_is_valid(&request.problem(), &planned)
}

/// Arc 0-1 takes 400 s at any time instead of 300 s.
fn slow_first_arc(fixture: &Fixture) -> TimeModel {
    let arc = fixture.mission.network.arc_between(NodeId(0), NodeId(1));
    let travel_s: BTreeMap<ArcId, Vec<f64>> = [(arc.unwrap(), vec![400.0])].into();
    TimeModel {
        profiles: Profiles::new(vec![0.0], travel_s, |arc| format!("{arc:?}")).unwrap(),
        ..TimeModel::default()
    }
}

#[test]
fn a_route_is_verified_with_or_without_travel_times_by_departure() {
    let fixture = Fixture::new();
    let mut request = asked(&fixture);
    for model in [None, Some(slow_first_arc(&fixture))] {
        let timed = model.is_some();
        request.time_model = model.map(Arc::new);
        assert!(is_valid(&request, &[0, 1, 2]) && is_valid(&request, &[0, 2]));
        // It ends elsewhere, or passes what is not there.
        assert!(!is_valid(&request, &[0, 1]) && !is_valid(&request, &[0, 7, 2]));
        // 300 s and 60 s of work an edge; the first takes 100 s more.
        let totals = route_totals(&request.problem(), &route(&[0, 1, 2])).unwrap();
        let time_s = if timed { 820.0 } else { 720.0 };
        assert_eq!((totals.time_s, totals.weight), (time_s, 6.0));
        assert!(route_totals(&request.problem(), &route(&[0, 1])).is_none());
        request.time_available_s = time_s - 1.0;
        assert!(!is_valid(&request, &[0, 1, 2]));
        request.time_available_s = 2_000.0;
    }
}

#[test]
fn a_route_with_tasks_in_time_is_refused_without_its_schedule() {
    let request = asked(&Fixture::with_timed_tasks());
    assert!(!request.time_model.as_ref().unwrap().tasks.is_empty());
    assert!(!is_valid(&request, &[0, 1, 2]));
    let mut planned = Planned::new(route(&[0, 1, 2]), 0.0, 0.0, Stats::default());
    // It leaves waypoint 1 after the work there, or before.
    for (leaves_s, valid) in [(360.0, true), (350.0, false)] {
        planned.schedule = Some(Schedule {
            departures_s: vec![0.0, leaves_s],
            end_s: leaves_s + 360.0,
            ..Schedule::default()
        });
        assert_eq!(route_is_valid(&request.problem(), &planned), valid);
    }
}

/// The question for a path from waypoint 0 to waypoint 1, among a region half way.
fn own_problem(regions: &[Region]) -> PathRequest {
    let fixture = Fixture::new().among(regions);
    let mut request = fixture.view(path_question::own_problem);
    request.target = place(900.0);
    request
}

#[test]
fn a_trajectory_is_accepted_by_what_is_asked_of_it() {
    let level = way(&[(0.0, 0.0), (900.0, 300.0)]);
    let fast = way(&[(0.0, 0.0), (900.0, 100.0)]);
    let short = way(&[(0.0, 0.0), (600.0, 200.0)]);
    let in_the_way = [Region::ball(place(450.0), 20.0)];
    let verdicts = |problem: &PathProblem<'_>, path: &Trajectory| {
        [
            path_is_valid(problem, path),
            is_free(problem, path),
            leads_on(problem, Vector3::zeros(), path),
            is_flyable(problem, path),
            can_be_steered(problem, path),
        ]
    };
    let (open, blocked) = (own_problem(&[]), own_problem(&in_the_way));
    assert_eq!(verdicts(&open.problem(), &level), [true; 5]);
    assert_eq!(verdicts(&open.problem(), &fast), [false; 5]);
    // All but the first let it end elsewhere; the last two let it pass obstacles.
    let elsewhere = [false, true, true, true, true];
    assert_eq!(verdicts(&open.problem(), &short), elsewhere);
    let collides = [false, false, false, true, true];
    assert_eq!(verdicts(&blocked.problem(), &level), collides);
    // The last lets it leave the box and run aground.
    let low = Point3::new(-10.0, -10.0, 0.0);
    let boxed = PathProblem {
        bounds: Some(Bounds::new(low, Point3::new(700.0, 10.0, 50.0))),
        ..open.problem()
    };
    let leaves = [false, false, false, false, true];
    assert_eq!(verdicts(&boxed, &level), leaves);
    let bed = AnalyticBed::new(15.0);
    let aground = PathProblem {
        sea_bed: Some(&bed),
        ..open.problem()
    };
    assert_eq!(verdicts(&aground, &level), leaves);
}

#[test]
fn a_way_on_keeps_clear_and_begins_before_the_trajectory_ends() {
    let whole = way(&[(0.0, 0.0), (900.0, 300.0), (900.0, 420.0)]);
    let on = |request: &PathRequest, ends_s| {
        let times_s = (ends_s, 120.0);
        has_way_on(&request.problem(), &whole, times_s, EndState::UnderWay)
    };
    let open = own_problem(&[]);
    assert!(on(&open, 300.0) && !on(&open, 421.0));
    let covered = own_problem(&[Region::ball(place(900.0), 20.0)]);
    assert!(!on(&covered, 300.0));
}
