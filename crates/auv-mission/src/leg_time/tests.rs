//! Hand-made legs of 300 s and 60 s of work.

use super::*;
use crate::fixture::{Fixture, path_row, place, way};
use crate::mode::LegMode;
use crate::state::RouteInForce;
use crate::tide::{Stretch, Tide};
use auv_graph::NodeId;
use auv_ocean::{AnalyticCurrent, TidalConstituent};
use std::sync::Arc;

#[test]
fn the_expected_time_follows_its_setting_and_the_charge() {
    let mut fixture = Fixture::new();
    let mut rows = [path_row(true, 0.0, 100.0), path_row(true, 0.0, 100.0)];
    (rows[0].compute_s, rows[1].compute_s) = (4.0, 8.0);
    fixture.state.ledger.path_calls = rows.to_vec();
    let fixed = ComputeCharge::Fixed {
        route_s: 50.0,
        path_s: 7.0,
    };
    let given = ExpectedTime::Given(vec![1.0, 2.0, 33.0]);
    let slack = ExpectedTime::Slack { kappa: 0.5 };
    for (expected, charge, wanted_s) in [
        (ExpectedTime::Strict, fixed, 160.0),
        (ExpectedTime::TravelVsEstimate, fixed, 160.0),
        (slack.clone(), ComputeCharge::None, 210.0),
        (slack.clone(), fixed, 217.0),
        (slack, ComputeCharge::Measured, 216.0),
        (given, ComputeCharge::None, 33.0),
        (ExpectedTime::Given(vec![1.0]), fixed, f64::INFINITY),
    ] {
        fixture.settings.replan.expected_time = expected.clone();
        fixture.settings.planning.compute = charge;
        let found_s = fixture.view(|view| expected_s(view, 100.0, 60.0));
        assert_eq!(found_s, wanted_s, "{expected:?}, {charge:?}");
    }
}

#[test]
fn a_leg_is_late_beyond_its_expected_time_charges_included() {
    let late = |now_s, charged_s, expected_time| {
        let mut fixture = Fixture::new().on_track(now_s);
        fixture.settings.replan.expected_time = expected_time;
        fixture.leg_mut().charged_s = charged_s;
        fixture.ask(is_late)
    };
    let strict = || ExpectedTime::Strict;
    assert!(!late(360.0, 0.0, strict()) && late(360.1, 0.0, strict()));
    assert!(!late(350.0, 10.0, strict()) && late(350.0, 10.1, strict()));
    // The flight alone counts: 60 s of the task are taken off.
    let flight = || ExpectedTime::TravelVsEstimate;
    assert!(!late(420.0, 0.0, flight()) && late(420.1, 0.0, flight()));
    // What rounding may do is not late.
    assert!(!late(0.0, 360.0 + ROUNDING_S, strict()));
}

#[test]
fn the_time_of_a_leg_counts_from_its_start() {
    let started_at_50 = |leg: &mut Leg| leg.started_s = 50.0;
    let fixture = |now_s| Fixture::new().with_leg(started_at_50).at(now_s, 900.0);
    assert_eq!(fixture(110.0).ask(leg_s), 60.0);
    assert!(!fixture(410.0).ask(is_late) && fixture(410.1).ask(is_late));
    for (ends_s, late) in [(410.0, false), (410.1, true)] {
        let mut fixture = fixture(110.0);
        fixture.settings.replan.policy = ReplanPolicy::Projected;
        fixture.state.in_force = Some(way(&[(0.0, 50.0), (900.0, ends_s)]).into());
        assert_eq!(fixture.ask(is_projected_late), late);
    }
}

#[test]
fn lateness_is_projected_to_the_end_of_the_trajectory_once() {
    let mut fixture = Fixture::new().on_track(100.0);
    fixture.settings.replan.policy = ReplanPolicy::Projected;
    assert!(!fixture.ask(is_projected_late));
    fixture.state.in_force = Some(way(&[(0.0, 0.0), (900.0, 301.0), (900.0, 361.0)]).into());
    assert!(fixture.ask(is_projected_late));
    let not = |change: &dyn Fn(&mut Fixture)| {
        let mut fixture = Fixture::new().on_track(100.0);
        fixture.settings.replan.policy = ReplanPolicy::Projected;
        fixture.leg_mut().charged_s = 1.0;
        assert!(fixture.ask(is_projected_late));
        change(&mut fixture);
        assert!(!fixture.ask(is_projected_late));
    };
    not(&|fixture| fixture.settings.replan.policy = ReplanPolicy::Late);
    not(&|fixture| fixture.leg_mut().next_route = NextRoute::Decided);
    not(&|fixture| fixture.leg_mut().mode = LegMode::Evading);
    not(&|fixture| fixture.leg_mut().to = NodeId(2));
    not(&|fixture| fixture.state.route = RouteInForce::QuickestHome(vec![]));
}

#[test]
fn a_detour_is_longer_than_the_straight_line_by_a_share_and_a_second() {
    // 300 s straight, 5 % more, and 1 s.
    for (arrives_s, detour) in [(316.0, false), (316.1, true)] {
        let leg = |leg: &mut Leg| leg.mode = LegMode::Underway { arrives_s };
        assert_eq!(Fixture::new().with_leg(leg).ask(makes_a_detour), detour);
    }
    // 30 s later and 90 m nearer: 270 s straight, 13.5 s more, and 1 s.
    for (arrives_s, detour) in [(314.4, false), (314.6, true)] {
        let leg = |leg: &mut Leg| leg.mode = LegMode::Underway { arrives_s };
        let later = Fixture::new().with_leg(leg).at(30.0, 90.0);
        assert_eq!(later.ask(makes_a_detour), detour);
    }
    let nowhere = Fixture::new().with_leg(|leg| leg.mode = LegMode::Evading);
    assert!(!nowhere.ask(makes_a_detour));
}

/// The least budget with which the leg is not short of time, by bisection.
fn least_budget_s(change: impl Fn(&mut Fixture)) -> f64 {
    let (mut short_s, mut enough_s) = (1.0, 100_000.0);
    for _ in 0..60 {
        let mut fixture = Fixture::new();
        change(&mut fixture);
        fixture.mission.budget_s = 0.5 * (short_s + enough_s);
        let short = fixture.ask(is_short_of_time);
        *if short { &mut short_s } else { &mut enough_s } = fixture.mission.budget_s;
    }
    (enough_s * 1e6).round() / 1e6
}

#[test]
fn time_is_short_when_the_way_home_after_the_leg_takes_what_is_left() {
    // 360 s for the leg, 300 s home from its target.
    assert_eq!(least_budget_s(|_| {}), 660.0);
    assert_eq!(
        least_budget_s(|fixture| fixture.mission.reserve_s = 10.0),
        670.0
    );
    let margin = |fixture: &mut Fixture| fixture.settings.margins.detour_margin = 0.1;
    assert_eq!(least_budget_s(margin), 690.0);
    let planning = |fixture: &mut Fixture| fixture.settings.planning.planning_s = 5.0;
    assert_eq!(least_budget_s(planning), 665.0);
    let charged = |fixture: &mut Fixture| fixture.state.ledger.charged_s = 3.0;
    assert_eq!(least_budget_s(charged), 663.0);
    // Evading, the straight line and the task count, not the evasion: 300 s and 60 s.
    let evading = |fixture: &mut Fixture| {
        fixture.leg_mut().mode = LegMode::Evading;
        fixture.state.in_force = Some(way(&[(0.0, 0.0), (0.0, 20.0)]).into());
    };
    assert_eq!(least_budget_s(evading), 660.0);
    // Waiting for slack water at the start of the leg, what is left of the time expected counts: 400 s since 30 s ago.
    let holding = |fixture: &mut Fixture| {
        let leg = fixture.leg_mut();
        (leg.mode, leg.expected_s, leg.started_s) = (LegMode::Holding, 400.0, -30.0);
    };
    assert_eq!(least_budget_s(holding), 670.0);
    // The same 20 s later.
    let later = |fixture: &mut Fixture| fixture.state.beliefs.now_s = 20.0;
    assert_eq!(least_budget_s(later), 660.0);
    let holding_later = |fixture: &mut Fixture| {
        holding(fixture);
        later(fixture);
    };
    assert_eq!(least_budget_s(holding_later), 670.0);
}

#[test]
fn a_leg_is_given_up_for_time_only_if_that_brings_the_vehicle_home_earlier() {
    let short = |change: &dyn Fn(&mut Fixture)| {
        let mut fixture = Fixture::new();
        fixture.mission.budget_s = 500.0;
        change(&mut fixture);
        fixture.ask(is_short_of_time)
    };
    assert!(short(&|_| {}));
    // What is left is enough if all of it is needed.
    assert!(!short(&|fixture| fixture.mission.budget_s = 660.0));
    // Straight to the target and on is 600 s; a second must be gained by leaving out the rest.
    let stays_s = |stay_s: f64| {
        move |fixture: &mut Fixture| {
            let ends = [(0.0, 0.0), (900.0, 300.0), (900.0, 300.0 + stay_s)];
            fixture.state.in_force = Some(way(&ends).into());
        }
    };
    assert!(short(&stays_s(1.1)));
    assert!(!short(&stays_s(1.0)) && !short(&stays_s(0.9)));
    // Whether the leg is given up or not, planning takes as long.
    assert!(!short(&|fixture| {
        fixture.settings.planning.planning_s = 5.0;
        stays_s(0.9)(fixture);
    }));
    // The margin stretches the way home from here too: 660 s against 300.9 s and 330 s.
    assert!(!short(&|fixture| {
        fixture.settings.margins.detour_margin = 0.1;
        stays_s(0.9)(fixture);
    }));
    assert!(!short(&|fixture| fixture.state.in_force = None));
    assert!(!short(
        &|fixture| fixture.state.route = RouteInForce::QuickestHome(vec![])
    ));
    let to_destination = |task_left_s| {
        move |fixture: &mut Fixture| {
            fixture.state.in_force = Some(way(&[(0.0, 0.0), (1800.0, 700.0)]).into());
            let leg = fixture.leg_mut();
            (leg.to, leg.task_left_s) = (NodeId(2), task_left_s);
        }
    };
    assert!(short(&to_destination(60.0)));
    assert!(!short(&to_destination(0.0)));
}

/// Half way along the leg, 600 s after launch, in a tide that turns from 1.2 m/s north to as much south.
fn in_a_tide() -> Fixture {
    let mut fixture = Fixture::new().at(600.0, 450.0);
    fixture.mission.budget_s = 6_000.0;
    fixture.mission.open_water = false;
    fixture.mission.current = Some(Arc::new(AnalyticCurrent {
        tide: vec![TidalConstituent {
            major_mps: [1.2, 0.0],
            minor_mps: [0.0, 0.0],
            period_s: 12_000.0,
            strongest_s: 0.0,
        }],
        ..AnalyticCurrent::default()
    }));
    fixture.tide = Tide::of(&fixture.mission, Stretch::default());
    fixture
}

#[test]
fn in_a_tide_the_way_home_takes_as_long_as_when_its_waypoint_is_reached() {
    let mut fixture = in_a_tide();
    fixture.settings.planning.planning_s = 5.0;
    let tide = fixture.tide.clone().unwrap();
    let home_s = |time_s| tide.home_s(NodeId(1), time_s);
    let onward = |view: View<'_>| onward_s(view, NodeId(1), 300.0);
    assert_eq!(fixture.view(onward), home_s(900.0));
    // The current that helps grows weaker: who is there later needs longer.
    assert!(home_s(600.0) < home_s(900.0) && home_s(900.0) < home_s(1_200.0));
    // Back over waypoint 0 is farther than on over waypoint 1.
    let ends = [place(450.0), place(900.0)];
    let there_s = tide.straight_s(&fixture.mission, ends, 600.0);
    let found_s = fixture.ask(home_from_here_s);
    assert_eq!(found_s, there_s + home_s(600.0 + there_s) + 5.0);
}
