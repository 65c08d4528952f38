//! Up to the surface: for a fix, or because the mission is aborted.

use crate::climb::ascent;
use crate::fixes::SPARE_S;
use crate::mode::{Leg, LegMode};
use crate::path_question::own_problem;
use crate::state::InForce;
use crate::station_keeping::stays;
use crate::view::View;
use crate::way_on::way_on;
use crate::{Mission, Navigation, PathRequest, check};
use auv_graph::NodeId;
use auv_planning::Trajectory;
use auv_types::Point3;

/// Sides and radii of the helices that are tried, in usual radii.
const SIDES: [f64; 4] = [1.0, -1.0, 2.0, -2.0];
/// A vehicle is near a waypoint for fixes within this distance, or two turn radii, metres.
const NEAR_M: f64 = 50.0;
/// Near a waypoint for fixes none is taken within this share of the time between two.
pub(crate) const AGAIN_SHARE: f64 = 0.1;
/// Legs are longer than straight by this.
const DETOUR: f64 = 1.2;
/// Attempts of one leg to get a fix.
pub(crate) const MOST_FIXES: u32 = 30;
/// A fix for the dock is taken where the rest of the way uses up no more than this share of the tolerance.
const REST_SHARE: f64 = 0.5;

/// The synchroniser's own problem, with the box open to the surface: surfacing means depth 0 wherever the box
/// begins.
fn open_problem(view: View<'_>) -> PathRequest {
    let mut request = own_problem(view);
    if let Some(bounds) = &mut request.bounds {
        bounds.low.z = bounds.low.z.min(0.0);
    }
    request
}

/// A trajectory to depth 0 that the vehicle can fly and that stays clear over the look-ahead time of everything
/// predicted, ships included.
pub(crate) fn surface(view: View<'_>) -> Option<Trajectory> {
    let request = open_problem(view);
    let problem = request.problem();
    let velocity = view.beliefs().velocity;
    let until_s = view.now_s() + view.settings.margins.lookahead_s;
    SIDES.iter().find_map(|side| {
        let up = ascent(&problem, velocity, 0.0, *side);
        let up = problem.timed(&up).ok()?;
        let free = view.is_clear(&up, until_s, 0.0) && check::is_flyable(&problem, &up);
        free.then_some(up)
    })
}

/// Up to the surface and as long there as a fix takes, with a way on from there.
pub(crate) fn surface_for_fix(view: View<'_>) -> Option<InForce> {
    let up = surface(view)?;
    let request = open_problem(view);
    let problem = request.problem();
    let takes_s = view.mission.at_surface_s() + SPARE_S;
    let until_s = up.end().time_s + takes_s;
    let mut stays = stays(&problem, up.end(), up.end_velocity(), takes_s);
    stays.find_map(|stay| {
        let whole = up.clone().then(&stay).ok()?;
        let free = view.is_clear(&whole, until_s, 0.0) && check::is_flyable(&problem, &whole);
        let on = way_on(&problem, whole.end(), whole.end_velocity(), view.way_on_s());
        free.then(|| InForce::new(whole, on.as_ref()))
    })
}

/// Whether the vehicle should surface for a fix now.
pub(crate) fn is_due(view: View<'_>, leg: &Leg) -> bool {
    let mission = view.mission;
    // Once the dock is missed it is tried again from the surface.
    let retries = leg.misses > 0 && view.beliefs().fix_s < leg.missed_s;
    if leg.fixes < MOST_FIXES && (retries || misses_dock(view, leg)) {
        return true;
    }
    if mission.navigation.is_none() && mission.surfacing.is_none() {
        return false;
    }
    let navigation = &mission.navigation.unwrap_or_default();
    let most_m = navigation.most_error_m.unwrap_or(f64::INFINITY);
    let lost = view.beliefs().sigma_m > most_m || is_time(view, leg);
    let docks = blocks_docking(view, leg);
    if leg.fixes >= MOST_FIXES || !(lost || docks) {
        return false;
    }
    let waited_s = view.now_s() - leg.fix_asked_s;
    leg.mode == LegMode::Surfacing
        || (leg.fixes == 0 || waited_s >= view.settings.waiting.retry_s)
            && (lost || a_fix_here_will_do(view, navigation))
}

/// Whether the vehicle is at the dock by its own belief, without contact with it, and may try again.
pub(crate) fn misses_dock(view: View<'_>, leg: &Leg) -> bool {
    leg.dock_contact == Some(false)
        && leg.misses + 1 < view.mission.docking.tries
        && leg.mode.leads_to_target()
        && view.mission.is_dock(leg.to)
        && view.state.in_force.is_some()
        && view.is_over()
        && view.is_on_track()
}

/// Whether the next fix must be under way to be there in time. Where fixes are taken near some waypoints only, the
/// vehicle must be near one, and the next on its route must come too late.
fn is_time(view: View<'_>, leg: &Leg) -> bool {
    let Some(told) = view.mission.surfacing else {
        return false;
    };
    let by_place = !view.mission.fix_places.is_empty();
    if leg.mode == LegMode::Surfacing {
        // It is taken where the vehicle comes up.
        return view.beliefs().fix_s < leg.fix_asked_s;
    }
    let here = view.beliefs().position;
    let up_m = view.mission.ascent_from_m(here.z);
    let up_s = up_m / view.mission.vehicle.speed_mps;
    let takes_s = up_s + view.mission.at_surface_s() + view.mission.fix_earlier_s(here.z);
    let since_s = view.now_s() - view.beliefs().fix_s;
    let next_s = match near_place(view, &here) {
        _ if !by_place => 0.0,
        // One fix at a place is enough, wherever the next is.
        Some(place) if since_s > takes_s.max(AGAIN_SHARE * told.every_s) => {
            next_fix_s(view, leg, place)
        }
        _ => return false,
    };
    let next_due_s = view.beliefs().fix_s + told.every_s;
    view.now_s() + takes_s + next_s > next_due_s
        || is_last_before_work(view, leg, (takes_s, since_s))
}

/// How long a fix at a waypoint for fixes could wait until there is another chance, seconds: after the work there, or
/// at the next of them.
fn next_fix_s(view: View<'_>, leg: &Leg, place: NodeId) -> f64 {
    if leg.to == place && leg.task_left_s > 0.0 {
        let depth_m = view.beliefs().position.z;
        return view.mission.fix_waits_s(depth_m, leg.task_left_s);
    }
    next_place_s(view.mission, view.state.route.nodes(), place)
}

/// Whether the vehicle comes to its work, and the next fix would interrupt it where one taken now would not.
fn is_last_before_work(view: View<'_>, leg: &Leg, (takes_s, since_s): (f64, f64)) -> bool {
    let (LegMode::Underway { arrives_s }, Some(told)) = (leg.mode, view.mission.surfacing) else {
        return false;
    };
    let depth_m = view.beliefs().position.z;
    // The vehicle comes back down to its work on the rest of its way.
    let down_s = takes_s + SPARE_S - view.mission.fix_earlier_s(depth_m);
    let is_near = arrives_s - view.now_s() <= down_s;
    let ends_s = arrives_s + leg.task_left_s;
    let interrupts = ends_s + takes_s > view.beliefs().fix_s + told.every_s;
    let free_s = view.mission.between_fixes_s(depth_m);
    is_near
        && interrupts
        && leg.task_left_s > 0.0
        && since_s > takes_s.max(AGAIN_SHARE * told.every_s)
        && free_s.is_some_and(|free_s| leg.task_left_s <= free_s)
}

/// The waypoint for fixes that a place is near.
fn near_place(view: View<'_>, here: &Point3<f64>) -> Option<NodeId> {
    let near_m = 2.0 * view.mission.vehicle.turn_radius_m;
    let mut places = view.mission.fix_places.iter().copied();
    places.find(|&place| {
        let offset = view.mission.position_of(place) - here;
        offset.xy().norm() <= near_m.max(NEAR_M)
    })
}

/// How long it takes to the next waypoint for fixes on a route after one, seconds: straight legs and their work.
pub(crate) fn next_place_s(mission: &Mission, route: &[NodeId], place: NodeId) -> f64 {
    let first = route.iter().position(|&node| node == place).unwrap_or(0);
    let mut after = route[first.min(route.len())..].windows(2);
    let mut way_s = 0.0;
    for pair in after.by_ref() {
        let ends = [pair[0], pair[1]].map(|node| mission.position_of(node));
        let arc = mission.network.arc_between(pair[0], pair[1]);
        let work_s = arc.map_or(0.0, |arc| {
            let edge = mission.network.arcs()[arc.index()].edge;
            mission.network.task(edge).completion_time_s
        });
        way_s += DETOUR * (ends[1] - ends[0]).norm() / mission.vehicle.speed_mps + work_s;
        if mission.fix_places.contains(&pair[1]) {
            break;
        }
    }
    way_s
}

/// Whether the vehicle must not dock yet: it does not know its place well enough, and may still get a fix.
pub(crate) fn blocks_docking(view: View<'_>, leg: &Leg) -> bool {
    view.mission.navigation.is_some()
        && view.mission.is_dock(leg.to)
        && leg.fixes < MOST_FIXES
        && !view.mission.may_dock(view.beliefs().sigma_m)
}

/// Whether a fix taken here still holds at the dock, or the vehicle is there.
fn a_fix_here_will_do(view: View<'_>, navigation: &Navigation) -> bool {
    let leads_to = view.leg().map(|leg| leg.to);
    let dock = leads_to.filter(|&to| view.mission.is_dock(to));
    let dock = view
        .mission
        .position_of(dock.unwrap_or(view.mission.destination));
    let offset = dock - view.beliefs().position;
    let away_m = offset.norm();
    let down_m = view.mission.ascent_m();
    let error_m = Navigation::SIGMAS * navigation.sigma_m(away_m + down_m, away_m);
    let there = offset.xy().norm() <= 2.0 * view.mission.vehicle.turn_radius_m;
    there || error_m <= REST_SHARE * view.mission.docking.tolerance_m
}
