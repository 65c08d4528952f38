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
mod tests;
