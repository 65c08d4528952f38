//! Questions for paths, stand-offs, and which answers are accepted.

use super::*;
use crate::fixture::{Fixture, place, way};
use crate::mode::LegMode;
use auv_graph::NodeId;
use auv_obstacles::Region;
use auv_planning::Stats;

/// A path with a claim.
fn planned(path: Trajectory, violation: f64) -> Planned<Trajectory> {
    let duration_s = path.duration_s();
    Planned::new(path, duration_s, violation, Stats::default())
}

/// Asks at 0 s at waypoint 0 for a path to the target, changes the fixture, and judges the
/// straight path.
fn judged(change: impl FnOnce(&mut Fixture)) -> Option<Accepted> {
    judged_claim(0.0, change)
}

fn judged_claim(violation: f64, change: impl FnOnce(&mut Fixture)) -> Option<Accepted> {
    let mut fixture = Fixture::new();
    let question = fixture.ask(|view, leg| ask(view, leg, None));
    change(&mut fixture);
    let path = way(&[(0.0, 0.0), (900.0, 300.0)]);
    fixture.ask(|view, leg| judge(view, leg, &question, &planned(path, violation)))
}

fn moved(time_s: f64, x: f64) -> impl FnOnce(&mut Fixture) {
    move |fixture| {
        fixture.state.beliefs.now_s = time_s;
        fixture.state.beliefs.position = place(x);
    }
}

#[test]
fn an_accepted_path_has_the_task_at_its_end() {
    let accepted = judged(|_| {}).unwrap();
    assert_eq!((accepted.arrives_s, accepted.stand_off), (300.0, None));
    let whole = accepted.in_force.whole;
    assert_eq!(whole.end(), TimedPoint::new(place(900.0), 360.0));
    let nothing_left = judged(|fixture| fixture.leg_mut().task_left_s = 0.0).unwrap();
    assert_eq!(nothing_left.in_force.whole.end().time_s, 300.0);
    assert_eq!(judged_claim(0.1, |_| {}), None);
}

#[test]
fn a_late_answer_holds_for_a_vehicle_that_is_on_the_path_already() {
    // 10 s late the path is at 30 m; 5 m off it is near enough.
    assert!(judged(moved(10.0, 30.0)).is_some());
    assert!(judged(moved(10.0, 35.0)).is_some());
    assert!(judged(moved(10.0, 35.1)).is_none());
    // It is not late at its departure.
    assert!(judged(moved(0.0, 35.1)).is_some());
}

#[test]
fn a_path_that_starts_later_must_start_on_the_trajectory_in_force() {
    let judged = |in_force: Option<Trajectory>| {
        let mut fixture = Fixture::new();
        fixture.settings.planning.planning_s = 10.0;
        let question = fixture.ask(|view, leg| ask(view, leg, None));
        assert_eq!((question.start, question.departure_s), (place(30.0), 10.0));
        fixture.state.in_force = in_force.map(Into::into);
        let path = planned(way(&[(30.0, 10.0), (900.0, 300.0)]), 0.0);
        let accepted = fixture.ask(|view, leg| judge(view, leg, &question, &path));
        accepted.is_some()
    };
    assert!(judged(Some(way(&[(0.0, 0.0), (900.0, 300.0)]))));
    assert!(!judged(Some(way(&[(0.0, 0.0), (300.0, 101.0)]))));
    // One that ends before does not lead elsewhere.
    assert!(judged(Some(way(&[(0.0, 0.0), (24.0, 9.0)]))) && judged(None));
}

#[test]
fn the_start_of_a_path_must_be_in_reach_until_its_departure() {
    // 30 m ahead in 10 s at 3 m/s; the vehicle may lag by `off_track_m`, 5 m.
    let accepts = |x: f64| {
        let mut fixture = Fixture::new();
        fixture.settings.planning.planning_s = 10.0;
        let question = fixture.ask(|view, leg| ask(view, leg, None));
        fixture.state.in_force = None;
        fixture.state.beliefs.position = place(x);
        let path = planned(way(&[(30.0, 10.0), (900.0, 300.0)]), 0.0);
        let accepted = fixture.ask(|view, leg| judge(view, leg, &question, &path));
        accepted.is_some()
    };
    assert!(accepts(0.0) && accepts(-4.9));
    assert!(!accepts(-5.1) && !accepts(65.1));
}

#[test]
fn what_is_flown_until_the_departure_must_be_clear() {
    let accepts = |gap_m: f64| {
        let mut fixture = Fixture::new();
        fixture.settings.planning.planning_s = 100.0;
        let question = fixture.ask(|view, leg| ask(view, leg, None));
        let beside = Region::ball(Point3::new(150.0, 30.0 + gap_m, 20.0), 30.0);
        let fixture = fixture.among(&[beside]);
        let path = planned(way(&[(300.0, 100.0), (900.0, 300.0)]), 0.0);
        let accepted = fixture.ask(|view, leg| judge(view, leg, &question, &path));
        accepted.is_some()
    };
    assert!(accepts(5.1) && !accepts(4.9));
}

#[test]
fn a_path_must_hold_among_the_regions_of_now() {
    let rock = |x, y| Region::ball(Point3::new(x, y, 20.0), 30.0);
    let among = |region| {
        judged(move |fixture: &mut Fixture| {
            fixture.state.beliefs.regions = [region].into();
        })
    };
    // New paths keep the clearance of 5 m and the hysteresis of 5 m.
    assert!(among(rock(450.0, 40.1)).is_some());
    assert!(among(rock(450.0, 39.9)).is_none());
}

#[test]
fn the_stay_must_be_clear_except_where_the_vehicle_docks() {
    // A ball covers the target from some time after the arrival on.
    let judged_at = |to: u32, task_left_s: f64, after_s: f64| {
        let mut fixture = Fixture::new().with_leg(|leg| {
            (leg.to, leg.task_left_s) = (NodeId(to), task_left_s);
        });
        let x = 900.0 * f64::from(to);
        let mut ball = Region::ball(place(x), 40.0);
        (ball.from_s, ball.until_s) = (300.0 * f64::from(to) + after_s, 1e9);
        fixture = fixture.among(&[ball]);
        let question = fixture.ask(|view, leg| ask(view, leg, None));
        let path = planned(way(&[(0.0, 0.0), (x, 300.0 * f64::from(to))]), 0.0);
        let accepted = fixture.ask(|view, leg| judge(view, leg, &question, &path));
        accepted.is_some()
    };
    assert!(!judged_at(1, 60.0, 20.0) && !judged_at(2, 60.0, 20.0));
    // After the stay there is time to leave, or there is not.
    assert!(judged_at(1, 15.0, 60.0) && !judged_at(1, 15.0, 20.0));
    assert!(judged_at(2, 0.0, 20.0));
}

#[test]
fn docking_alone_may_end_nearer_than_the_clearance() {
    // The ball is 3 m from the end of the path, and there was when the question was asked: 5 m wanted.
    let ends = |to: u32, task_left_s: f64| {
        let fixture = Fixture::new().with_leg(|leg| {
            (leg.to, leg.task_left_s) = (NodeId(to), task_left_s);
        });
        let mut question = fixture.ask(|view, leg| ask(view, leg, None));
        question.clearance_m = 1.0;
        let x = 900.0 * f64::from(to);
        let near = Region::ball(Point3::new(x, 43.0, 20.0), 40.0);
        question.regions = [near].into();
        let mut fixture = fixture;
        fixture.state.beliefs.regions = Arc::clone(&question.regions);
        let path = planned(way(&[(0.0, 0.0), (x, 300.0 * f64::from(to))]), 0.0);
        let accepted = fixture.ask(|view, leg| judge(view, leg, &question, &path));
        accepted.is_some()
    };
    assert!(ends(2, 0.0));
    assert!(!ends(1, 0.0) && !ends(2, 60.0));
}

#[test]
fn a_covered_target_is_waited_for_on_the_first_free_ring_on_this_side() {
    let reach_among = |radius_m| {
        let fixture = Fixture::new().among(&[Region::ball(place(900.0), radius_m)]);
        fixture.ask(reach)
    };
    assert_eq!(Fixture::new().ask(reach), Reach::Target);
    // 10 m are kept: the ring of 100 m is free up to a ball of 90 m.
    for (radius_m, ring_m) in [(30.0, 50.0), (89.9, 100.0), (90.1, 150.0), (789.0, 800.0)] {
        let Reach::StandOff(found) = reach_among(radius_m) else {
            panic!("no stand-off for {radius_m} m");
        };
        assert!(
            (found - place(900.0 - ring_m)).norm() < 1e-6,
            "{radius_m} m: {found}"
        );
    }
    // The next ring is not 100 m nearer than the vehicle.
    assert_eq!(reach_among(791.0), Reach::Nowhere);
}

#[test]
fn a_stand_off_stays_free_for_a_while_and_lies_in_the_box() {
    // The ball grows over the rings: what is free on arrival only does not count.
    let mut grows = Region::ball(place(900.0), 30.0);
    let stand_off = |fixture: &Fixture| match fixture.ask(reach) {
        Reach::StandOff(place) => place,
        found => panic!("{found:?}"),
    };
    let steady = stand_off(&Fixture::new().among(&[grows]));
    grows.growth_mps = 0.2;
    let fixture = Fixture::new().among(&[grows]);
    let found = stand_off(&fixture);
    assert!((steady - place(850.0)).norm() < 1e-6);
    // At 800 m the ball has 83 m on arrival after 267 s, and 107 m 120 s later; at 750 m 80 m and
    // 104 m. 10 m are kept.
    assert!((found - place(750.0)).norm() < 1e-6, "{found}");
    let mut walled = Fixture::new().among(&[Region::ball(place(900.0), 30.0)]);
    walled.mission.bounds = Some(auv_types::Bounds::new(
        Point3::new(0.0, -500.0, 0.0),
        Point3::new(2_000.0, -10.0, 100.0),
    ));
    assert!(stand_off(&walled).y <= -10.0);
}

#[test]
fn a_lead_follows_the_trajectory_in_force_where_that_leads_to_the_start() {
    let fixture = Fixture::new();
    let lead = |x, time_s| {
        let start = TimedPoint::new(place(x), time_s);
        fixture.view(|view| lead_to(view, start))
    };
    assert_eq!(lead(0.0, 0.0), None);
    assert_eq!(lead(900.0, 330.0).unwrap().points().len(), 3);
    let straight = lead(800.0, 330.0).unwrap();
    assert_eq!(straight.points().len(), 2);
    assert_eq!(straight.end(), TimedPoint::new(place(800.0), 330.0));
}

#[test]
fn a_question_keeps_its_stand_off_and_starts_from_the_rest_of_the_path() {
    let fixture = Fixture::new().on_track(100.0);
    let question = fixture.ask(|view, leg| ask(view, leg, Some(place(850.0))));
    assert_eq!(
        (question.target, question.stand_off),
        (place(850.0), Some(place(850.0)))
    );
    let warm_start = question.warm_start.unwrap();
    assert_eq!(warm_start.start(), TimedPoint::new(place(300.0), 100.0));
    // Without the stay at its end.
    assert_eq!(warm_start.end().time_s, 300.0);
    assert_eq!(question.clearance_m, 10.0);
    let evading = fixture.with_leg(|leg| leg.mode = LegMode::Evading);
    let question = evading.ask(|view, leg| ask(view, leg, None));
    assert_eq!((question.target, question.warm_start), (place(900.0), None));
}

#[test]
fn a_place_on_the_edge_of_a_region_is_not_covered() {
    let covered = |away_m| {
        let ball = Region::ball(Point3::new(900.0, away_m, 20.0), 32.0);
        let fixture = Fixture::new().among(&[ball]);
        fixture.view(|view| is_covered(view, &place(900.0)))
    };
    assert!(covered(31.9) && !covered(32.0) && !covered(32.1));
}

#[test]
fn a_stand_off_is_free_on_arrival() {
    // What covers the first ring on this side is gone soon after the arrival at 283 s.
    let mut gone = Region::ball(place(850.0), 20.0);
    gone.until_s = 290.0;
    let fixture = Fixture::new().among(&[Region::ball(place(900.0), 30.0), gone]);
    let Reach::StandOff(found) = fixture.ask(reach) else {
        panic!("no stand-off");
    };
    assert!((found - place(850.0)).norm() >= 30.0, "{found}");
}

#[test]
fn a_question_has_the_velocity_that_the_vehicle_cannot_give_up() {
    let asked = |radius_m, speed_mps| {
        let mut fixture = Fixture::new();
        fixture.mission.vehicle.turn_radius_m = radius_m;
        fixture.state.beliefs.velocity = Vector3::new(speed_mps, 0.0, 0.0);
        let question = fixture.ask(|view, leg| ask(view, leg, None));
        question.start_velocity.map(|velocity| velocity.x)
    };
    assert_eq!(asked(20.0, 3.0), Some(3.0));
    assert_eq!(asked(20.0, 0.06), Some(0.06));
    assert_eq!((asked(20.0, AT_REST_MPS), asked(20.0, 0.0)), (None, None));
    assert_eq!(asked(0.0, 3.0), None);
}

#[test]
fn a_vehicle_off_its_track_departs_where_its_velocity_takes_it() {
    let departs = |aside_m, planning_s| {
        let mut fixture = Fixture::new();
        fixture.settings.planning.planning_s = planning_s;
        fixture.state.beliefs.position.y = aside_m;
        fixture.state.beliefs.velocity = Vector3::new(0.0, 1.0, 0.0);
        let question = fixture.ask(|view, leg| ask(view, leg, None));
        assert_eq!(question.departure_s, planning_s);
        question.start
    };
    assert_eq!(departs(4.0, 10.0), place(30.0));
    assert_eq!(departs(20.0, 10.0), Point3::new(0.0, 30.0, 20.0));
    // After 400 s the trajectory in force is over.
    assert_eq!(departs(4.0, 400.0), Point3::new(0.0, 404.0, 20.0));
    assert_eq!(departs(4.0, 0.0), Point3::new(0.0, 4.0, 20.0));
}

#[test]
fn a_path_from_the_surface_does_not_rise() {
    let rises_mps = |depth_m| {
        let mut fixture = Fixture::new();
        fixture.mission.vehicle.turn_radius_m = 20.0;
        fixture.state.beliefs.position.z = depth_m;
        fixture.state.beliefs.velocity = Vector3::new(3.0, 0.0, -0.5);
        let question = fixture.ask(|view, leg| ask(view, leg, None));
        -question.start_velocity.unwrap().z
    };
    assert_eq!((rises_mps(0.0), rises_mps(0.1)), (0.0, 0.5));
}

#[test]
fn what_follows_a_path_is_checked_among_what_is_predicted_now() {
    // A ball that was not known when the path was asked for, from 5 s after the stay on.
    let accepts = |away_m: f64| {
        let ask_first = |fixture: &mut Fixture| {
            fixture.leg_mut().task_left_s = 15.0;
            let mut ball = Region::ball(Point3::new(900.0, away_m, 20.0), 40.0);
            (ball.from_s, ball.until_s) = (320.0, 1e9);
            fixture.state.beliefs.regions = [ball].into();
        };
        judged(ask_first).is_some()
    };
    assert!(!accepts(0.0));
    // The vehicle may wait at the mission's clearance, 5 m, without the hysteresis.
    assert!(accepts(47.0));
}

#[test]
fn a_vehicle_that_hovers_waits_for_an_answer_at_the_end_of_its_path() {
    let accepted = judged(moved(400.0, 900.0)).unwrap();
    assert_eq!(accepted.arrives_s, 300.0);
}

#[test]
fn a_stay_lasts_until_the_time_asked() {
    let fixture = Fixture::new().at(100.0, 300.0);
    let stay = fixture.view(|view| stay_until(view, 160.0)).unwrap();
    assert_eq!(stay.ends_s, 160.0);
    let ends = (stay.whole.start(), stay.whole.at(160.0).0);
    assert_eq!(ends, (TimedPoint::new(place(300.0), 100.0), place(300.0)));
}

#[test]
fn a_blocked_way_on_is_replaced_and_the_rest_of_the_path_kept() {
    let rock = Region::ball(place(1_100.0), 20.0);
    let mut fixture = Fixture::new().among(&[rock]);
    fixture.state.in_force = Some(InForce {
        whole: way(&[(0.0, 0.0), (900.0, 300.0), (1_200.0, 400.0)]),
        ends_s: 300.0,
    });
    let other = |fixture: &Fixture| fixture.view(with_other_way_on);
    let fixture = fixture.on_track(100.0);
    let found = other(&fixture).unwrap();
    assert_eq!(found.ends_s, 300.0);
    // The vehicle rests where the path ends.
    let places = [100.0, 300.0, 400.0].map(|time_s| found.whole.at(time_s).0);
    assert_eq!(places, [300.0, 900.0, 900.0].map(place));
    let covered = fixture.among(&[Region::ball(place(900.0), 400.0)]);
    assert_eq!(other(&covered), None);
}
