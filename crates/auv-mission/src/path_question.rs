//! Asking for paths and judging the answers.

use crate::mode::Leg;
use crate::question::PathQuestion;
use crate::view::{AT_REST_MPS, View};
use crate::{PathRequest, check, reflex, station_keeping};
use auv_obstacles::TimedPoint;
use auv_planning::motion::{distance_to_regions_m, least_clearance};
use auv_planning::{Planned, Trajectory};
use auv_types::{Point3, Vector3};
use std::sync::Arc;

/// A path starts on the trajectory in force if it lies no farther from it than this, metres.
const SAME_PLACE_M: f64 = 1e-6;

/// How long a place to wait must stay clear, seconds.
const STAY_CLEAR_S: f64 = 120.0;
/// Distance between the rings of places round a covered target, metres, and their number.
const RING_M: f64 = 50.0;
const RINGS: u32 = 20;
/// A place to wait must be nearer to the target than the vehicle is by this, metres.
const LEAST_GAIN_M: f64 = 100.0;

/// Where the next path of a leg may lead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reach {
    /// To the target.
    Target,
    /// The target is covered: to a place near it.
    StandOff(Point3<f64>),
    /// The target is covered, and there is no place near it to wait.
    Nowhere,
}

/// Where the next path of a leg may lead.
pub(crate) fn reach(view: View<'_>, leg: &Leg) -> Reach {
    let target = view.mission.position_of(leg.to);
    if is_covered(view, &target) {
        stand_off(view, target).map_or(Reach::Nowhere, Reach::StandOff)
    } else {
        Reach::Target
    }
}

/// Whether a region covers a place at the earliest arrival: no path can end there then.
pub(crate) fn is_covered(view: View<'_>, place: &Point3<f64>) -> bool {
    let arrival = TimedPoint::new(*place, view.now_s() + view.straight_s(place));
    distance_to_regions_m(&arrival, &view.beliefs().regions, 1.0) < 0.0
}

/// The place nearest to a covered target where the vehicle can wait. It must be nearer to the target
/// than the vehicle is by [`LEAST_GAIN_M`], and clear on arrival and for [`STAY_CLEAR_S`] after.
fn stand_off(view: View<'_>, target: Point3<f64>) -> Option<Point3<f64>> {
    let here = view.beliefs().position;
    let wanted_m = view.wanted_clearance_m();
    let clear = |place: &Point3<f64>| {
        let arrival_s = view.now_s() + view.straight_s(place);
        [0.0, 0.5, 1.0].iter().all(|share| {
            let then = TimedPoint::new(*place, arrival_s + share * STAY_CLEAR_S);
            distance_to_regions_m(&then, &view.beliefs().regions, wanted_m) >= wanted_m
        })
    };
    let farthest_m = (target - here).norm() - LEAST_GAIN_M;
    let rings = (1..=RINGS)
        .map(|k| RING_M * f64::from(k))
        .take_while(|&ring_m| ring_m <= farthest_m);
    rings.into_iter().find_map(|ring_m| {
        reflex::directions()
            .map(|direction| target + direction * ring_m)
            .filter(|place| view.mission.is_open(place) && clear(place))
            .min_by(|a, b| (a - here).norm().total_cmp(&(b - here).norm()))
    })
}

/// A question for a path from the vehicle's place to the leg's target, or to a place near it.
pub(crate) fn ask(view: View<'_>, leg: &Leg, stand_off: Option<Point3<f64>>) -> PathQuestion {
    let (place, velocity) = departure(view);
    let steers = view.mission.vehicle.turn_radius_m > 0.0 && velocity.norm() > AT_REST_MPS;
    let (min_altitude_m, altitude_sigmas) = view.mission.altitude_to_ask(&place.position);
    PathQuestion {
        id: view.state.next_question,
        stand_off,
        bounds: Some(view.bounds()),
        min_altitude_m: min_altitude_m.max(0.0),
        altitude_sigmas,
        start: place.position,
        start_velocity: steers.then_some(velocity),
        target: stand_off.unwrap_or_else(|| view.mission.position_of(leg.to)),
        departure_s: place.time_s,
        regions: Arc::clone(&view.beliefs().regions),
        clearance_m: view.clearance_to_ask_m(place),
        warm_start: warm_start(view, leg, place, stand_off).map(Arc::new),
        budget: view.settings.planning.path_budget,
    }
}

/// Where the vehicle is when the path is ready, and its velocity: here and now or, where planning is
/// given time, where the trajectory in force (else its velocity) takes it until then.
fn departure(view: View<'_>) -> (TimedPoint, Vector3<f64>) {
    let (now_s, velocity) = (view.now_s(), view.beliefs().velocity);
    let ahead_s = view.settings.planning.planning_s;
    let then_s = now_s + ahead_s;
    let in_force = view.state.in_force.as_ref();
    let followed = in_force.filter(|way| then_s < way.end().time_s && view.is_on_track());
    let (position, velocity) = match followed {
        Some(in_force) if ahead_s > 0.0 => in_force.at(then_s),
        _ => (view.beliefs().position + velocity * ahead_s, velocity),
    };
    (TimedPoint::new(position, then_s), velocity)
}

/// A trajectory to start the search from: the rest of the one in force, or the arc's guide round land.
fn warm_start(
    view: View<'_>,
    leg: &Leg,
    from: TimedPoint,
    stand_off: Option<Point3<f64>>,
) -> Option<Trajectory> {
    if let (Some(in_force), Some(arrives_s)) = (&view.state.in_force, leg.mode.arrives_s()) {
        let rest = in_force.until(arrives_s).after(from.time_s);
        return (rest.points().len() > 1).then_some(rest);
    }
    let arc = view.mission.network.arc_between(leg.from, leg.to)?;
    let guide = view.mission.guides.get(&arc)?;
    let mut points: Vec<Point3<f64>> = vec![from.position];
    points.extend(guide[..guide.len().saturating_sub(1)].iter().skip(1));
    points.push(stand_off.unwrap_or_else(|| view.mission.position_of(leg.to)));
    own_problem(view).problem().timed(&points).ok()
}

/// A path request without search data, for timing and checking the synchroniser's own manoeuvres.
pub(crate) fn own_problem(view: View<'_>) -> PathRequest {
    let here = view.beliefs().position;
    let (min_altitude_m, altitude_sigmas) = view.mission.altitude_to_ask(&here);
    PathRequest {
        id: 0,
        mission: Arc::clone(view.mission),
        bounds: Some(view.bounds()),
        min_altitude_m,
        altitude_sigmas,
        start: here,
        start_velocity: None,
        target: here,
        departure_s: view.now_s(),
        regions: Arc::clone(&view.beliefs().regions),
        clearance_m: view.mission.clearance_m,
        warm_start: None,
        seed: view.seed,
        budget: view.settings.planning.path_budget,
    }
}

/// A trajectory that may go into force.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Accepted {
    /// The path and the stay at its end.
    pub(crate) whole: Trajectory,
    /// When the path ends and the stay starts.
    pub(crate) arrives_s: f64,
    /// The place near the covered target where it ends; `None` for the target.
    pub(crate) stand_off: Option<Point3<f64>>,
}

/// Judges a plan against the question that was asked, and against what is predicted now.
pub(crate) fn judge(
    view: View<'_>,
    leg: &Leg,
    question: &PathQuestion,
    planned: &Planned<Trajectory>,
) -> Option<Accepted> {
    let path = &planned.best;
    if !starts_on_track(view, question, path) {
        return None;
    }
    let arrives_s = path.end().time_s;
    let accepted = |whole| Accepted {
        whole,
        arrives_s,
        stand_off: question.stand_off,
    };
    let stay_s = match question.stand_off {
        Some(_) => view.settings.waiting.retry_s,
        None => leg.task_left_s,
    };
    if view.acceptor.takes_unverified() {
        let stay = Trajectory::hover(path.end(), stay_s);
        return path.clone().then(&stay).ok().map(accepted);
    }
    let request = question.request(view.mission, view.seed);
    let asked = request.problem();
    let lead = lead_to(view, path.start());
    let leads_there = lead.is_none_or(|lead| view.is_clear(&lead, lead.end().time_s, 0.0));
    let valid = planned.violation <= 0.0
        && leads_there
        && check::path_is_valid(&asked, path)
        && holds_now(view, &request, path);
    if !valid {
        return None;
    }
    let docks = question.stand_off.is_none() && leg.to == view.mission.destination && stay_s <= 0.0;
    let (regions, clearance_m) = (&view.beliefs().regions, view.mission.clearance_m);
    let stays = station_keeping::stays(&asked, path.end(), path.end_velocity(), stay_s);
    stays.into_iter().find_map(|stay| {
        let until_s = stay.end().time_s;
        let nearest = least_clearance(&stay, regions, (arrives_s, until_s), clearance_m);
        let free = docks || nearest.clearance_m >= clearance_m;
        let whole = path.clone().then(&stay).ok()?;
        let flyable = stay.points().len() < 2 || check::is_flyable(&asked, &whole);
        (free && flyable).then(|| accepted(whole))
    })
}

/// Whether the vehicle can follow a path: it is near the path if the departure is past; if the
/// departure is to come, the trajectory in force still leads to the path's start, and the vehicle can
/// be there in time.
fn starts_on_track(view: View<'_>, question: &PathQuestion, path: &Trajectory) -> bool {
    let now_s = view.now_s();
    let departure_s = question.departure_s;
    let off_m = (view.beliefs().position - path.at(now_s).0).norm();
    let too_late = departure_s < now_s && off_m > view.settings.margins.off_track_m;
    let elsewhere = view.state.in_force.as_ref().is_some_and(|in_force| {
        departure_s > now_s
            && departure_s <= in_force.end().time_s
            && (in_force.at(departure_s).0 - question.start).norm() > SAME_PLACE_M
    });
    let ahead_s = (departure_s - now_s).max(0.0);
    let reach_m = view.mission.vehicle.max_speed_mps * ahead_s;
    let to_start_m = (view.beliefs().position - question.start).norm();
    let out_of_reach =
        departure_s > now_s && to_start_m > reach_m + view.settings.margins.off_track_m;
    !too_late && !elsewhere && !out_of_reach
}

/// Whether a path that was valid when asked for is valid among what is predicted now.
fn holds_now(view: View<'_>, asked: &PathRequest, path: &Trajectory) -> bool {
    let regions = &view.beliefs().regions;
    if asked.regions == *regions {
        return true;
    }
    let start = TimedPoint::new(asked.start, asked.departure_s);
    let now = PathRequest {
        regions: Arc::clone(regions),
        clearance_m: view.clearance_to_ask_m(start),
        ..asked.clone()
    };
    check::path_is_valid(&now.problem(), path)
}

/// What is flown until a trajectory that starts later does: along the trajectory in force where that
/// leads there, else straight.
pub(crate) fn lead_to(view: View<'_>, start: TimedPoint) -> Option<Trajectory> {
    let now_s = view.now_s();
    if start.time_s <= now_s {
        return None;
    }
    let leads_there = |in_force: &&Trajectory| {
        start.time_s <= in_force.end().time_s && in_force.at(start.time_s).0 == start.position
    };
    match view.state.in_force.as_ref().filter(leads_there) {
        Some(in_force) => Some(in_force.until(start.time_s).after(now_s)),
        None => Trajectory::new(vec![view.here(), start]).ok(),
    }
}

#[cfg(test)]
mod tests;
