//! What is told of a trajectory with a way on, and of heights over a shoal.

use super::*;
use crate::fixture::{Fixture, place, way};
use crate::state::InForce;
use auv_obstacles::Region;
use auv_ocean::{FlatBed, Shoal};
use auv_types::Vector3;

/// To waypoint 1 at 300 s, and 300 m on until 400 s.
fn goes_on(time_s: f64) -> Fixture {
    let mut fixture = Fixture::new();
    fixture.state.in_force = Some(InForce {
        whole: way(&[(0.0, 0.0), (900.0, 300.0), (1_200.0, 400.0)]),
        ends_s: 300.0,
    });
    fixture.settings.planning.planning_s = 0.0;
    fixture.settings.margins.escape_s = 80.0;
    fixture.on_track(time_s)
}

#[test]
fn the_way_on_begins_where_the_purpose_ends_and_ends_with_the_trajectory() {
    for (now_s, [over, on, flown], due_s) in [
        (0.0, [false, false, false], 300.0),
        (299.9, [false, false, false], 300.0),
        (300.0, [true, true, false], 400.0),
        (399.9, [true, true, false], 400.0),
        (400.0 - MOMENT_S, [true, false, true], 400.0),
        (400.0, [true, false, true], 400.0),
        (500.0, [true, false, true], 400.0),
    ] {
        let fixture = goes_on(now_s);
        let found = fixture.view(|view| [view.is_over(), view.goes_on(), view.is_flown()]);
        assert_eq!(found, [over, on, flown], "{now_s} s");
        assert_eq!(fixture.view(|view| view.due_s()), due_s, "{now_s} s");
    }
    let mut none = goes_on(50.0);
    none.state.in_force = None;
    let found = none.view(|view| [view.is_over(), view.goes_on(), view.is_flown()]);
    assert_eq!(found, [true, false, true]);
    assert_eq!(none.view(|view| view.due_s()), 50.0);
}

/// A ball of 20 m abreast of the track.
fn beside(x: f64, away_m: f64) -> Region {
    let mut centre = place(x);
    centre.y = 20.0 + away_m;
    Region::ball(centre, 20.0)
}

#[test]
fn the_way_on_is_blocked_by_what_comes_nearer_than_the_clearance_while_it_must_last() {
    let blocked = |fixture: Fixture| fixture.view(|view| view.way_on_is_blocked());
    // It must last 80 s: 900 to 1140 m.
    for (x, away_m, is_blocked) in [
        (1_000.0, 0.0, true),
        (1_000.0, 4.999, true),
        (1_000.0, 5.001, false),
        (700.0, 0.0, false),
        (1_150.0, 0.0, true),
        (1_170.0, 0.0, false),
    ] {
        let region = beside(x, away_m);
        let found = blocked(goes_on(0.0).among(&[region]));
        assert_eq!(found, is_blocked, "{x} m, {away_m} m");
        // While it is flown its own clearance counts.
        assert!(!blocked(goes_on(300.0).among(&[region])));
    }
    assert!(!blocked(goes_on(0.0)));
    let no_way_on = Fixture::new().among(&[beside(900.0, 0.0)]);
    assert!(!blocked(no_way_on));
}

#[test]
fn the_purpose_is_clear_by_itself_and_then_the_way_on() {
    let clear = |fixture: &Fixture| fixture.view(|view| view.in_force_is_clear());
    let ahead = beside(1_100.0, 0.0);
    assert!(clear(&goes_on(0.0).among(&[ahead])));
    assert!(!clear(&goes_on(300.0).among(&[ahead])) && clear(&goes_on(300.0)));
    // Off by no more than `off_track_m`, 5 m, the vehicle follows its track.
    for (off_m, is_clear) in [(5.0, true), (5.01, false)] {
        let mut fixture = goes_on(0.0).among(&[beside(450.0, 5.001)]);
        fixture.state.beliefs.position.y = -off_m;
        assert_eq!(clear(&fixture), is_clear);
    }
}

/// Over a bed charted at 40 m, with a least altitude of 10 m, and raised within 50 m of a place.
fn over_shoal(fixture: Fixture, north_m: f64, raised_m: f64) -> Fixture {
    let mut fixture = fixture;
    fixture.mission.sea_bed = Some(Arc::new(FlatBed::new(40.0)));
    (
        fixture.mission.min_altitude_m,
        fixture.mission.altitude_sigmas,
    ) = (10.0, 0.0);
    let shoal = Shoal {
        north_m,
        east_m: 0.0,
        raised_m,
        reach_m: 50.0,
    };
    fixture.state.soundings.shoals = vec![shoal];
    let known = fixture.state.soundings.over(&Arc::new(fixture.mission));
    fixture.mission = (*known).clone();
    fixture
}

/// A dip that is kept: a hundredth of `off_track_m`, and the error of chords on both sides.
const DIP_M: f64 = 0.05 + 2.0 * Trajectory::CHORD_ERROR_M;

#[test]
fn the_vehicle_is_too_low_by_more_than_a_dip_where_its_track_is() {
    // At 20 m over a shoal raised by 10 m it has its least altitude.
    let too_low = |raised_m, aside_m, depth_m| {
        let mut fixture = over_shoal(Fixture::new(), 0.0, raised_m);
        fixture.state.beliefs.position = Point3::new(0.0, aside_m, depth_m);
        fixture.view(|view| view.is_too_low())
    };
    assert!(!too_low(10.0 + DIP_M - 1e-3, 0.0, 20.0));
    assert!(too_low(10.0 + DIP_M + 1e-3, 0.0, 20.0));
    // On its track the track counts, off it the vehicle.
    assert!(too_low(11.0, 1.0, 17.0) && !too_low(11.0, 6.0, 17.0));
    assert!(!too_low(9.0, 1.0, 22.0) && too_low(9.0, 6.0, 22.0));
}

#[test]
fn a_trajectory_leads_nowhere_lower_over_a_shoal_than_the_vehicle_is() {
    let clear = |north_m, raised_m| {
        let fixture = over_shoal(Fixture::new(), north_m, raised_m);
        fixture.view(|view| view.in_force_is_clear())
    };
    assert!(clear(450.0, 10.0) && !clear(450.0, 12.0));
    // 2 m too low now, and no lower later.
    assert!(clear(0.0, 12.0));
    let blocked = |raised_m| {
        let fixture = over_shoal(goes_on(0.0), 1_050.0, raised_m);
        fixture.view(|view| view.way_on_is_blocked())
    };
    assert!(!blocked(10.0) && blocked(12.0));
}

#[test]
fn a_waypoint_over_a_shoal_is_reached_as_much_higher_as_it_is_too_low() {
    let target = NodeId(1);
    let raised_m = |raised_m| {
        let fixture = over_shoal(Fixture::new(), 900.0, raised_m);
        fixture.view(|view| view.raised_m(target))
    };
    assert_eq!(raised_m(9.0), 0.0);
    assert_eq!(raised_m(10.0), 0.0);
    assert!((raised_m(12.0) - (2.0 + DIP_M)).abs() < 1e-9);
    let mut fixture = over_shoal(Fixture::new(), 900.0, 12.0);
    let raised = |fixture: &Fixture| fixture.view(|view| view.raised(target));
    let lifted = place(900.0) - raised(&fixture);
    assert!((lifted - Vector3::new(0.0, 0.0, 2.0 + DIP_M)).norm() < 1e-9);
    // The box ends at 19 m.
    let (low, high) = ([-1e3, -1e3, 19.0], [3e3, 1e3, 99.0]);
    fixture.mission.bounds = Some(Bounds::new(low.into(), high.into()));
    assert_eq!(raised(&fixture), Point3::new(900.0, 0.0, 19.0));
}

#[test]
fn the_vehicle_is_over_a_shoal_that_keeps_it_off_the_target() {
    // 5 m off is near enough; a waypoint raised by less is reached.
    for (x, raised_m, over) in [
        (895.0, 16.0, true),
        (894.9, 16.0, false),
        (905.1, 16.0, false),
        (900.0, 14.9, false),
        (900.0, 15.0, true),
    ] {
        let fixture = over_shoal(Fixture::new(), 900.0, raised_m).at(300.0, x);
        let found = fixture.view(|view| view.is_over_shoal(NodeId(1)));
        assert_eq!(found, over, "{x} m, {raised_m} m");
    }
}

#[test]
fn a_path_is_asked_for_with_the_clearance_that_its_start_has() {
    // 5 m and 5 m of hysteresis; a metre of what is left at the start stays out of the question.
    let asked_m = |away_m| {
        let mut fixture = Fixture::new().among(&[beside(0.0, away_m)]);
        fixture.settings.margins.hysteresis_m = 5.0;
        fixture.view(|view| view.clearance_to_ask_m(view.here()))
    };
    for (away_m, wanted_m) in [
        (30.0, 10.0),
        (10.5, 9.5),
        (7.0, 6.0),
        (0.5, 0.0),
        (-3.0, 0.0),
    ] {
        let found_m = asked_m(away_m);
        assert!((found_m - wanted_m).abs() < 1e-9, "{away_m} m: {found_m} m");
    }
}

#[test]
fn a_vehicle_that_turns_in_circles_is_under_way_when_it_moves() {
    let turning = |radius_m, speed_mps| {
        let mut fixture = goes_on(30.0);
        fixture.mission.vehicle.turn_radius_m = radius_m;
        fixture.state.beliefs.velocity = Vector3::new(speed_mps, 0.0, 0.0);
        fixture
    };
    let now = |radius_m, speed_mps| {
        let fixture = turning(radius_m, speed_mps);
        fixture.view(|view| view.under_way().map(|way| (way.place, way.velocity)))
    };
    let north = |speed_mps| Vector3::new(speed_mps, 0.0, 0.0);
    assert_eq!(now(20.0, 3.0), Some((place(90.0), north(3.0))));
    assert_eq!(now(20.0, 0.06), Some((place(90.0), north(0.06))));
    assert_eq!((now(20.0, AT_REST_MPS), now(20.0, 0.0)), (None, None));
    assert_eq!(now(0.0, 3.0), None);
    // When the trajectory in force has done what it is followed for.
    let then = |fixture: &Fixture| {
        fixture.view(|view| {
            let then = view.under_way_then();
            then.map(|way| (way.place, way.velocity))
        })
    };
    assert_eq!(then(&turning(20.0, 0.0)), Some((place(900.0), north(3.0))));
    assert_eq!(then(&turning(0.0, 3.0)), None);
    let ends_at = |speed_mps: f64| {
        let mut fixture = turning(20.0, 3.0);
        let path = way(&[(0.0, 0.0), (100.0 * speed_mps, 100.0)]);
        fixture.state.in_force = Some(path.into());
        then(&fixture).is_some()
    };
    assert!(ends_at(0.06) && !ends_at(AT_REST_MPS) && !ends_at(0.0));
}

#[test]
fn a_vehicle_that_turns_in_circles_takes_longer_to_what_lies_behind() {
    let mut fixture = Fixture::new().at(0.0, 450.0);
    fixture.mission.vehicle.turn_radius_m = 20.0;
    fixture.state.beliefs.velocity = Vector3::new(3.0, 0.0, 0.0);
    let to = |x| fixture.view(|view| view.leg_to(place(x), 0.0).under_way_s());
    assert!((to(900.0) - 150.0).abs() < 1e-9);
    // Half a circle of 20 m at 3 m/s at least.
    assert!(to(0.0) > 150.0 + 20.0);
}
