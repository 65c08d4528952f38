//! How long a leg takes, compared with the time expected and with the time left for the way home.

use crate::mode::{Duty, Leg, LegMode, NextRoute};
use crate::view::View;
use crate::{ComputeCharge, ExpectedTime, ReplanPolicy, path_question, route_question};
use auv_graph::NodeId;

/// A leg that exceeds its expected time by no more than this is not late: rounding may do that, seconds.
const ROUNDING_S: f64 = 1e-6;
/// Leaving a leg must bring the vehicle home earlier by this, seconds.
const LEAST_GAIN_S: f64 = 1.0;

/// The time expected of the next leg with a travel time and a task time, seconds.
pub(crate) fn expected_s(view: View<'_>, travel_s: f64, task_s: f64) -> f64 {
    let rows = &view.state.ledger.path_calls;
    let charge_s = match view.settings.planning.compute {
        ComputeCharge::None => 0.0,
        ComputeCharge::Fixed { path_s, .. } => path_s,
        ComputeCharge::Measured => {
            rows.iter().map(|call| call.compute_s).sum::<f64>() / rows.len().max(1) as f64
        }
    };
    match &view.settings.replan.expected_time {
        ExpectedTime::Strict | ExpectedTime::TravelVsEstimate => travel_s + task_s,
        ExpectedTime::Slack { kappa } => (1.0 + kappa) * travel_s + task_s + charge_s,
        ExpectedTime::Given(list) => list.get(rows.len()).copied().unwrap_or(f64::INFINITY),
    }
}

/// Time of a leg so far by Eq. 12, seconds.
pub(crate) fn leg_s(view: View<'_>, leg: &Leg) -> f64 {
    view.now_s() - leg.started_s + leg.charged_s
}

/// Whether the leg has taken longer than expected.
pub(crate) fn is_late(view: View<'_>, leg: &Leg) -> bool {
    exceeds_expected(view, leg, leg_s(view, leg))
}

fn exceeds_expected(view: View<'_>, leg: &Leg, leg_s: f64) -> bool {
    let task_s = match (&view.settings.replan.expected_time, leg.duty) {
        (ExpectedTime::TravelVsEstimate, Duty::Task(edge)) => {
            view.mission.network.task(edge).completion_time_s
        }
        _ => 0.0,
    };
    leg_s - task_s > leg.expected_s + ROUNDING_S
}

/// Whether the policy `projected` asks for a route now: the leg will be late, and no route was asked for
/// during this leg.
pub(crate) fn is_projected_late(view: View<'_>, leg: &Leg) -> bool {
    let asks = view.settings.replan.policy == ReplanPolicy::Projected
        && leg.next_route == NextRoute::AtTarget
        && leg.mode.leads_to_target()
        && !view.state.route.is_homeward()
        && !view.mission.is_dock(leg.to);
    let ahead_s = view.ends_s() - view.now_s();
    asks && exceeds_expected(
        view,
        leg,
        view.now_s() - leg.started_s + (leg.charged_s + ahead_s),
    )
}

/// Whether the rest of the way to the target takes much longer than a straight line would.
pub(crate) fn makes_a_detour(view: View<'_>, leg: &Leg) -> bool {
    let straight_s = view.straight_s(&view.mission.position_of(leg.to));
    let arrives_s = leg.mode.arrives_s();
    let rest_s = arrives_s.map_or(0.0, |arrives_s| arrives_s - view.now_s());
    rest_s > (1.0 + view.settings.replan.long_way) * straight_s + 1.0
}

/// Whether finishing the leg would leave less time than the quickest way home needs, and leaving it
/// now would leave more.
pub(crate) fn is_short_of_time(view: View<'_>, leg: &Leg) -> bool {
    if view.state.in_force.is_none() || view.state.route.is_homeward() {
        return false;
    }
    let rest_s = if leg.mode.waits() {
        let target = view.mission.position_of(leg.to);
        view.leg_to(target, leg.task_left_s).total_s()
    } else if matches!(leg.mode, LegMode::Holding) {
        leg.started_s + leg.expected_s - view.now_s()
    } else {
        view.ends_s() - view.now_s()
    };
    let onward_s = onward_s(view, leg.to, rest_s);
    let home_s = rest_s + onward_s + view.settings.planning.planning_s;
    let nothing_to_drop = view.mission.is_dock(leg.to) && leg.task_left_s <= 0.0;
    !nothing_to_drop
        && home_s > view.mission.plannable_s(view.available_s())
        && home_from_here_s(view, leg) < home_s - LEAST_GAIN_S
}

/// Time of the quickest way home from a waypoint that is reached in so many seconds, with the margins.
fn onward_s(view: View<'_>, node: NodeId, reached_in_s: f64) -> f64 {
    match view.tide {
        Some(tide) => tide.home_s(node, view.now_s() + reached_in_s),
        None => view.home_s[node.index()] * (1.0 + view.settings.margins.detour_margin),
    }
}

/// Time of the quickest way home from the vehicle's place, seconds.
fn home_from_here_s(view: View<'_>, leg: &Leg) -> f64 {
    let here = view.beliefs().position;
    let anchors = route_question::anchors(view, Some(leg)).into_iter();
    let places = anchors.map(|node| (node, view.mission.position_of(node)));
    let home_s = match view.tide {
        Some(tide) => {
            let by_tide = places.map(|(node, place)| {
                let there_s = tide.straight_s(view.mission, [here, place], view.now_s());
                there_s + onward_s(view, node, there_s)
            });
            by_tide.fold(f64::INFINITY, f64::min)
        }
        None => {
            let still = places.map(|(node, place)| {
                view.leg_to(place, 0.0).under_way_s() + view.home_s[node.index()]
            });
            let least_s = still.fold(f64::INFINITY, f64::min);
            least_s * (1.0 + view.settings.margins.detour_margin)
        }
    };
    home_s + view.settings.planning.planning_s
}

/// Whether a region covers the target at the earliest arrival: no path can end there then.
pub(crate) fn target_is_covered(view: View<'_>, leg: &Leg) -> bool {
    path_question::is_covered(view, &view.mission.position_of(leg.to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{Fixture, path_row, way};
    use crate::mode::LegMode;
    use crate::state::RouteInForce;
    use auv_graph::NodeId;

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
        // Straight to the target and on is 600 s; a second must be gained by leaving out the rest.
        let stays_s = |stay_s: f64| {
            move |fixture: &mut Fixture| {
                let ends = [(0.0, 0.0), (900.0, 300.0), (900.0, 300.0 + stay_s)];
                fixture.state.in_force = Some(way(&ends).into());
            }
        };
        assert!(short(&stays_s(1.1)));
        assert!(!short(&stays_s(0.9)));
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
}
