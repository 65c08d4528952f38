//! What single events change in a hand-made state.

use super::*;
use crate::fixture::{Fixture, way};
use crate::question::RouteFrom;
use crate::{Battery, RouteReason};
use auv_ocean::FlatBed;
use auv_planning::Stats;
use std::sync::Arc;

#[test]
fn a_measured_battery_sets_what_is_used() {
    let mut fixture = Fixture::new();
    fixture.mission.battery = Some(Battery {
        usable_j: 1_000.0,
        hotel_w: 1.0,
        propulsion_j_per_m: 1.0,
    });
    let mut synchroniser = fixture.into_synchroniser();
    for (left_j, used_j) in [(400.0, 600.0), (f64::NAN, 600.0), (1_100.0, -100.0)] {
        synchroniser.step(Event::BatteryMeasured { left_j });
        assert_eq!(synchroniser.state.ledger.used_j, used_j);
    }
}

#[test]
fn an_altitude_below_half_the_least_is_too_near_and_a_false_one_is_none() {
    for (altitude_m, taken, near) in [
        (f64::NAN, false, false),
        (-0.1, false, false),
        (0.0, true, true),
        (1.9, true, true),
        (2.0, true, false),
        (9.0, true, false),
    ] {
        let mut fixture = Fixture::new();
        fixture.mission.min_altitude_m = 4.0;
        let mut synchroniser = fixture.into_synchroniser();
        let before = synchroniser.state.beliefs.altimeter;
        let told = synchroniser.apply_event(Event::AltitudeMeasured { altitude_m });
        let trigger = told.map(|(trigger, _)| trigger);
        assert_eq!(trigger, near.then_some(Trigger::BedTooNear), "{altitude_m}");
        let after = synchroniser.state.beliefs.altimeter;
        let wanted = if taken {
            Altimeter::Fresh(altitude_m)
        } else {
            before
        };
        assert_eq!(after, wanted, "{altitude_m}");
    }
}

#[test]
fn a_sounding_counts_where_the_vehicle_has_a_fix() {
    for (fixed_s, counts) in [(50.0, true), (40.0, false)] {
        let mut fixture = Fixture::new().at(50.0, 150.0);
        fixture.mission.sea_bed = Some(Arc::new(FlatBed::new(40.0)));
        fixture.mission.min_altitude_m = 10.0;
        fixture.state.beliefs.fixed_s = fixed_s;
        let mut synchroniser = fixture.into_synchroniser();
        // Two that agree on a bed at 28 m.
        synchroniser.take_sounding(8.0);
        synchroniser.take_sounding(8.0);
        assert_eq!(!synchroniser.shoals().is_empty(), counts);
    }
}

/// Books the time from 10 s to 30 s, where the vehicle waited for 5 s before and 60 s of work are left, with a
/// change of the fixture: waiting, work left, the mode and up to when time is booked.
fn booked(mode: LegMode, change: impl FnOnce(&mut Fixture)) -> (f64, f64, LegMode, f64) {
    let mut fixture = Fixture::new().on_track(30.0).with_leg(|leg| {
        (leg.mode, leg.booked_s, leg.waited_s) = (mode, 10.0, 5.0);
    });
    change(&mut fixture);
    let mut synchroniser = fixture.into_synchroniser();
    synchroniser.book_leg_time();
    let leg = synchroniser.view().leg().unwrap();
    (leg.waited_s, leg.task_left_s, leg.mode, leg.booked_s)
}

#[test]
fn time_is_booked_as_waiting_where_the_leg_makes_no_way() {
    for mode in [LegMode::Evading, LegMode::Climbing] {
        assert_eq!(booked(mode, |_| {}), (25.0, 60.0, mode, 30.0));
    }
    for mode in [
        LegMode::AwaitFirstPath,
        LegMode::Holding,
        LegMode::Surfacing,
    ] {
        assert_eq!(booked(mode, |_| {}), (5.0, 60.0, mode, 30.0));
    }
    // Near a covered target from the arrival on.
    let to = |arrives_s| LegMode::ToStandOff { arrives_s };
    let there = LegMode::AtStandOff { since_s: 20.0 };
    assert_eq!(booked(to(20.0), |_| {}), (25.0, 60.0, there, 30.0));
    assert_eq!(booked(to(30.0), |_| {}), (5.0, 60.0, to(30.0), 30.0));
    assert_eq!(booked(to(40.0), |_| {}), (5.0, 60.0, to(40.0), 30.0));
}

#[test]
fn time_is_booked_as_work_where_the_vehicle_is_at_the_target() {
    let to = |arrives_s| LegMode::Underway { arrives_s };
    let there = LegMode::AtTarget { booked_s: 30.0 };
    let working = LegMode::AtTarget { booked_s: 10.0 };
    assert_eq!(booked(to(20.0), |_| {}), (5.0, 50.0, there, 30.0));
    assert_eq!(booked(to(30.0), |_| {}), (5.0, 60.0, to(30.0), 30.0));
    assert_eq!(booked(working, |_| {}), (5.0, 40.0, there, 30.0));
    let short = |fixture: &mut Fixture| fixture.leg_mut().task_left_s = 7.0;
    assert_eq!(booked(working, short), (5.0, 0.0, there, 30.0));
    let off = |fixture: &mut Fixture| fixture.state.beliefs.position.y = 6.0;
    assert_eq!(booked(working, off), (5.0, 60.0, working, 30.0));
}

#[test]
fn nothing_is_booked_while_an_answer_is_awaited() {
    let evading = LegMode::Evading;
    let nothing = (5.0, 60.0, evading, 10.0);
    let path = |fixture: &mut Fixture| {
        let question = fixture.ask(|view, leg| path_question::ask(view, leg, None));
        fixture.leg_mut().awaited = Awaited::Path(question);
    };
    assert_eq!(booked(evading, path), nothing);
    let route = |fixture: &mut Fixture| {
        let (reason, from) = (RouteReason::Projected, RouteFrom::Target);
        let question = fixture.view(|view| route_question::ask(view, reason, from));
        fixture.leg_mut().next_route = NextRoute::Asked(Box::new(question));
    };
    assert_eq!(booked(evading, route), nothing);
}

#[test]
fn a_path_answer_is_charged_and_its_claims_are_kept_for_the_first_call() {
    for (calls, claims) in [(1, (0.5, 300.0)), (2, (0.0, 0.0))] {
        let mut fixture = Fixture::new();
        fixture.settings.planning.compute = ComputeCharge::Fixed {
            route_s: 50.0,
            path_s: 7.0,
        };
        let question = fixture.ask(|view, leg| path_question::ask(view, leg, None));
        let leg = fixture.leg_mut();
        (leg.charged_s, leg.compute_s, leg.calls) = (3.0, 1.0, calls);
        let id = question.id;
        leg.awaited = Awaited::Path(question);
        let mut synchroniser = fixture.into_synchroniser();
        let path = way(&[(0.0, 0.0), (900.0, 300.0)]);
        let planned = Ok(Planned::new(path, 300.0, 0.5, Stats::default()));
        let other = synchroniser.take_path_answer(id + 1, &planned, 2.0);
        assert!(other.is_none());
        let told = synchroniser.take_path_answer(id, &planned, 2.0).unwrap();
        assert_eq!(told.0, Trigger::PathAnswered);
        assert_eq!(synchroniser.state.ledger.charged_s, 7.0);
        let leg = synchroniser.view().leg().unwrap();
        assert_eq!((leg.charged_s, leg.compute_s), (10.0, 3.0));
        assert_eq!((leg.violation, leg.cost), claims);
    }
}
