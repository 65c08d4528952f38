//! What the vehicle does at once, without a planner, when it must evade. An evasion once chosen is kept.

use crate::evade::{Lasting, evade};
use crate::mode::{LegMode, Mode};
use crate::path_question::own_problem;
use crate::shortfall::{Prospect, Shortfall};
use crate::state::InForce;
use crate::view::View;
use crate::way_on::way_on;
use auv_planning::{PathProblem, Trajectory};

/// How long a vehicle that cannot stop circles on one trajectory while it waits, seconds.
const CIRCLES_S: f64 = 150.0;
/// No evasion is planned for longer, seconds.
const LONGEST_S: f64 = 1e6;

/// What the vehicle does when it must evade now; `None` if nothing is better than to go on as it does.
///
/// An evasion gives way only to one that is clearly better ([`Shortfall::gives_way_to`]). What else is in
/// force is kept where every evasion leads deeper below the bed's least altitude, out of the box or into what
/// is charted.
pub(crate) fn evasion(view: View<'_>) -> Option<InForce> {
    let request = own_problem(view);
    let (problem, velocity) = (request.problem(), view.beliefs().velocity);
    let lookahead_s = view.settings.margins.lookahead_s.min(LONGEST_S);
    // Circles are planned for a shorter time: they are renewed at their end.
    let for_s = if view.mission.vehicle.can_hover() {
        lookahead_s
    } else {
        lookahead_s.min(CIRCLES_S)
    };
    let lasting = Lasting {
        for_s,
        way_on_s: view.way_on_s(),
    };
    let prospect = Prospect::new(&problem);
    let rest = rest_in_force(view);
    let kept = rest.as_ref().filter(|_| evades(view));
    let kept = kept.map(|rest| prospect.shortfall(rest));
    if kept.is_some_and(Shortfall::is_small) {
        return rest.and_then(|rest| renewed(view, rest));
    }
    let matters_below = kept.map_or(f64::INFINITY, |kept| kept.matters_below(chosen_ago_s(view)));
    let evasion = evade(&problem, velocity, lasting, matters_below);
    if let Some(found) = evasion.as_ref().map(|evasion| evasion.shortfall) {
        let lower = |way: &Trajectory| prospect.certain_shortfall_m(way) < found.certain_m;
        let stays = |rest: &Trajectory| match kept {
            Some(kept) => !kept.gives_way_to(found, chosen_ago_s(view)),
            None => found.first_m() > 0.0 && lower(rest),
        };
        if let Some(rest) = rest.filter(stays) {
            return renewed(view, rest);
        }
        if found.first_m() > 0.0 && view.is_on_track() {
            let again = held_again(view, &problem).filter(|again| lower(&again.whole));
            if again.is_some() {
                return again;
            }
        }
    }
    let at_rest = || Trajectory::hover(view.here(), view.settings.waiting.retry_s.min(LONGEST_S));
    match evasion {
        Some(evasion) => Some(evasion.in_force),
        None => view.is_flown().then(|| InForce::new(at_rest(), None)),
    }
}

/// What is left of the trajectory in force, if the vehicle is on it.
fn rest_in_force(view: View<'_>) -> Option<Trajectory> {
    let whole = view.in_force().filter(|_| view.is_on_track())?;
    (!view.is_flown()).then(|| whole.after(view.now_s()))
}

/// Time since the trajectory in force was chosen, seconds.
fn chosen_ago_s(view: View<'_>) -> f64 {
    let since_s = view.in_force().map(|whole| whole.start().time_s);
    since_s.map_or(f64::INFINITY, |since_s| view.now_s() - since_s)
}

/// The rest of the trajectory in force, to be followed on; `None` on a leg, where that needs no command.
fn renewed(view: View<'_>, rest: Trajectory) -> Option<InForce> {
    let in_force = view.state.in_force.as_ref()?;
    let renewed = InForce {
        whole: rest,
        ends_s: in_force.ends_s,
    };
    view.leg().is_none().then_some(renewed)
}

/// Whether the trajectory in force is an evasion, or what was followed as one.
fn evades(view: View<'_>) -> bool {
    match &view.state.mode {
        Mode::Leg(leg) => leg.mode == LegMode::Evading,
        Mode::Contingency(contingency) => contingency.flown.is_none() && contingency.sought > 0,
        _ => false,
    }
}

/// The circles at the end of the trajectory in force once more, from where it ends.
fn held_again(view: View<'_>, problem: &PathProblem<'_>) -> Option<InForce> {
    let whole = view.in_force()?;
    let (end, velocity) = (whole.end(), whole.end_velocity());
    let there = PathProblem {
        start: end.position,
        departure_s: end.time_s,
        ..*problem
    };
    let hold = way_on(&there, end, velocity, view.way_on_s())?;
    let again = whole.after(view.now_s()).then(&hold).ok()?;
    Some(InForce {
        whole: again,
        ends_s: end.time_s,
    })
}
