//! Up to the surface: for a fix, or because the mission is aborted.

use crate::climb::ascent;
use crate::mode::{Leg, LegMode};
use crate::path_question::own_problem;
use crate::state::InForce;
use crate::station_keeping::stays;
use crate::view::View;
use crate::way_on::way_on;
use crate::{Navigation, PathRequest, check};
use auv_planning::Trajectory;

/// Sides and radii of the helices that are tried, in usual radii.
const SIDES: [f64; 4] = [1.0, -1.0, 2.0, -2.0];
/// A fix is given this much more time than it takes, seconds.
const SPARE_S: f64 = 5.0;
/// A fix from time to time is sought this much earlier, because it may not be free at once, seconds.
const RETRIES_S: f64 = 120.0;
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
    if mission.navigation.is_none() && mission.surfacing.is_none() {
        return false;
    }
    let navigation = &mission.navigation.unwrap_or_default();
    let most_m = navigation.most_error_m.unwrap_or(f64::INFINITY);
    let lost = view.beliefs().sigma_m > most_m || is_time(view);
    let docks = blocks_docking(view, leg);
    if leg.fixes >= MOST_FIXES || !(lost || docks) {
        return false;
    }
    let waited_s = view.now_s() - leg.fix_asked_s;
    leg.mode == LegMode::Surfacing
        || (leg.fixes == 0 || waited_s >= view.settings.waiting.retry_s)
            && (lost || a_fix_here_will_do(view, navigation))
}

/// Whether the next fix must be under way to be there in time.
fn is_time(view: View<'_>) -> bool {
    view.mission.surfacing.is_some_and(|told| {
        let up_m = view.mission.ascent_from_m(view.beliefs().position.z);
        let up_s = up_m / view.mission.vehicle.speed_mps;
        let takes_s = up_s + view.mission.at_surface_s() + SPARE_S + RETRIES_S;
        view.now_s() + takes_s > view.beliefs().fix_s + told.every_s
    })
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
