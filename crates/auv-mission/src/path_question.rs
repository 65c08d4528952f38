//! Asking for paths and judging the answers.

use crate::approach::{Approaches, places_of};
use crate::course::{self, rest_of};
use crate::leads::directions;
use crate::mode::Leg;
use crate::question::PathQuestion;
use crate::state::InForce;
use crate::uncertainty::widened;
use crate::view::{AT_REST_MPS, View};
use crate::way_on::way_on;
use crate::{PathRequest, check, due, station_keeping, works};
use auv_obstacles::TimedPoint;
use auv_planning::motion::{distance_to_regions_m, least_clearance};
use auv_planning::polyline::rounded;
use auv_planning::{PathProblem, Planned, Trajectory};
use auv_types::{Point3, Vector3};
use auv_verify::EndState;
use std::sync::Arc;

/// A path starts on the trajectory in force if it lies no farther from it than this, metres.
const SAME_PLACE_M: f64 = 1e-6;

/// Other paths that are tried instead of a refused one, for each failure of the leg before.
const MENDED_A_FAILURE: usize = 100;
/// Guides are rounded by arcs that are wider than the vehicle must turn by this.
const TURN_SHARE: f64 = 1.05;
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
        directions()
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
    let target = stand_off.unwrap_or_else(|| view.raised(leg.to));
    let arc = view.mission.network.arc_between(leg.from, leg.to);
    PathQuestion {
        id: view.state.next_question,
        stand_off,
        bounds: Some(view.bounds()),
        min_altitude_m: min_altitude_m.max(0.0),
        altitude_sigmas,
        start: place.position,
        start_velocity: steers.then_some(velocity),
        target,
        departure_s: place.time_s,
        regions: widened(view, &place.position, &target),
        clearance_m: view.clearance_to_ask_m(place),
        warm_start: warm_start(view, leg, place, stand_off).map(Arc::new),
        budget: view.settings.planning.path_budget,
        speed_mps: arc.and_then(|arc| view.mission.courses.speeds_mps.get(&arc).copied()),
    }
}

/// Where the vehicle is when the path is ready, and its velocity: here and now or, where planning is
/// given time, where the trajectory in force (else its velocity) takes it until then.
fn departure(view: View<'_>) -> (TimedPoint, Vector3<f64>) {
    let (now_s, velocity) = (view.now_s(), view.beliefs().velocity);
    let ahead_s = view.settings.planning.planning_s;
    let then_s = now_s + ahead_s;
    let in_force = view.in_force();
    let followed = in_force.filter(|way| then_s < way.end().time_s && view.is_on_track());
    let (position, mut velocity) = match followed {
        Some(in_force) if ahead_s > 0.0 => in_force.at(then_s),
        _ => (view.beliefs().position + velocity * ahead_s, velocity),
    };
    // A vehicle that floats at the surface seems to rise: no path goes on like that.
    if position.z <= view.bounds().low.z {
        velocity.z = velocity.z.max(0.0);
    }
    (TimedPoint::new(position, then_s), velocity)
}

/// A trajectory to start the search from: the rest of the one in force, or the arc's guide round land.
fn warm_start(
    view: View<'_>,
    leg: &Leg,
    from: TimedPoint,
    stand_off: Option<Point3<f64>>,
) -> Option<Trajectory> {
    if let (Some(in_force), Some(arrives_s)) = (view.in_force(), leg.mode.arrives_s()) {
        let rest = in_force.until(arrives_s).after(from.time_s);
        return (rest.points().len() > 1).then_some(rest);
    }
    let arc = view.mission.network.arc_between(leg.from, leg.to)?;
    let guide = view.mission.guides.get(&arc)?;
    let mut points: Vec<Point3<f64>> = vec![from.position];
    points.extend(guide[..guide.len().saturating_sub(1)].iter().skip(1));
    points.push(stand_off.unwrap_or_else(|| view.raised(leg.to)));
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
    /// The path, the stay at its end, and the way on from there.
    pub(crate) in_force: InForce,
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
    let stay_s = match question.stand_off {
        Some(_) => view.settings.waiting.retry_s,
        None => due::stay_of(view, leg, path.end().time_s),
    };
    if view.acceptor.takes_unverified() {
        let stay = Trajectory::hover(path.end(), stay_s);
        let whole = path.clone().then(&stay).ok()?;
        return Some(Accepted {
            in_force: InForce::new(whole, None),
            arrives_s: path.end().time_s,
            stand_off: question.stand_off,
        });
    }
    let lead = lead_to(view, path.start());
    if lead.is_some_and(|lead| !view.is_clear(&lead, lead.end().time_s, 0.0)) {
        return None;
    }
    let request = question.request(view.mission, view.seed);
    let asked = request.problem();
    let ending = Ending {
        view,
        asked: &asked,
        stand_off: question.stand_off,
        leg: Some(leg),
        goes_on: question.stand_off.is_some() || !view.mission.is_dock(leg.to) || stay_s > 0.0,
    };
    let holds =
        |path: &Trajectory| check::path_is_valid(&asked, path) && holds_now(view, &request, path);
    let ways = course::ways(view, (leg, question), &asked, path).into_iter();
    if let Some(flown) = ways.filter(holds).find_map(|path| ending.of(&path)) {
        return Some(flown);
    }
    let approaches = Approaches::to(&asked);
    let path = if planned.violation <= 0.0 && holds(path) {
        path.clone()
    } else if !leg.failures.is_power_of_two() || is_free_of_bed(&asked, path) {
        // The planner is asked once more before its path is mended; then less and less often, because it takes
        // time. What obstacles alone refuse is not mended.
        return None;
    } else {
        let guide = guide_from(view, leg, &asked);
        let courses = std::iter::once(places_of(path)).chain(guide).collect();
        let tried = MENDED_A_FAILURE * leg.failures as usize;
        approaches.mended(courses).take(tried).find(holds)?
    };
    ending.of(&path).or_else(|| {
        let others = approaches.other_ends(&path).filter(holds);
        others.into_iter().find_map(|path| ending.of(&path))
    })
}

/// Whether a path meets everything of a problem but the clearance from regions.
fn is_free_of_bed(asked: &PathProblem<'_>, path: &Trajectory) -> bool {
    let open = PathProblem {
        regions: &[],
        ..*asked
    };
    check::path_is_valid(&open, path)
}

/// The rest of the leg's guide from where it comes nearest to the start of a path, as the vehicle turns.
fn guide_from(view: View<'_>, leg: &Leg, asked: &PathProblem<'_>) -> Option<Vec<Point3<f64>>> {
    let arc = view.mission.network.arc_between(leg.from, leg.to)?;
    let guide = view.mission.guides.get(&arc)?;
    let mut corners = [vec![asked.start], rest_of(guide, &asked.start)].concat();
    *corners.last_mut()? = asked.target;
    Some(rounded(&corners, TURN_SHARE * asked.vehicle.turn_radius_m))
}

/// What follows a path.
struct Ending<'a> {
    view: View<'a>,
    asked: &'a PathProblem<'a>,
    /// The place near the covered target where the path ends.
    stand_off: Option<Point3<f64>>,
    /// The leg that ends with the path.
    leg: Option<&'a Leg>,
    /// Whether there must be a way on from there: everywhere but at the dock.
    goes_on: bool,
}

impl Ending<'_> {
    /// A path with the stay at its end and the way on from there, if there are.
    fn of(&self, path: &Trajectory) -> Option<Accepted> {
        let (arrives_s, velocity) = (path.end().time_s, path.end_velocity());
        let leg = self.leg.filter(|_| self.stand_off.is_none());
        let flown = leg.and_then(|leg| works::flown(self.view, leg, self.asked, path));
        let in_force = match flown {
            Some(mut flown) => flown.find_map(|work| self.with(path, &work))?,
            None => {
                let retry_s = self.view.settings.waiting.retry_s;
                let stay_s = leg.map_or(retry_s, |leg| due::stay_of(self.view, leg, arrives_s));
                let mut stays = station_keeping::stays(self.asked, path.end(), velocity, stay_s);
                stays.find_map(|stay| self.with(path, &stay))?
            }
        };
        Some(Accepted {
            in_force,
            arrives_s,
            stand_off: self.stand_off,
        })
    }

    fn with(&self, path: &Trajectory, stay: &Trajectory) -> Option<InForce> {
        let window_s = (path.end().time_s, stay.end().time_s);
        let (regions, clearance_m) = (&self.view.beliefs().regions, self.view.mission.clearance_m);
        let nearest = least_clearance(stay, regions, window_s, clearance_m);
        let free = !self.goes_on || nearest.clearance_m >= clearance_m;
        let whole = path.clone().then(stay).ok()?;
        let stays = stay.points().len() > 1;
        if !free || stays && !check::is_flyable(self.asked, &whole) {
            return None;
        }
        if !self.goes_on {
            let in_force = InForce::new(whole, None);
            return self
                .is_safe(&in_force, EndState::Docked)
                .then_some(in_force);
        }
        let last = if stays { stay } else { path };
        let way_on = self.way_on(whole.end(), last.end_velocity())?;
        let in_force = InForce::new(whole, Some(&way_on));
        self.is_safe(&in_force, EndState::UnderWay)
            .then_some(in_force)
    }

    /// The verifier's verdict on the whole, among what is predicted now.
    fn is_safe(&self, in_force: &InForce, end: EndState) -> bool {
        let lasts_s = (in_force.ends_s, self.view.way_on_s());
        check::has_way_on(&self.now(), &in_force.whole, lasts_s, end)
    }

    /// The problem that was asked, among what is predicted now.
    fn now(&self) -> PathProblem<'_> {
        PathProblem {
            regions: &self.view.beliefs().regions,
            clearance_m: self.view.mission.clearance_m,
            ..*self.asked
        }
    }

    /// The way on from a place, clear of what is predicted now.
    fn way_on(&self, place: TimedPoint, velocity: Vector3<f64>) -> Option<Trajectory> {
        // An answer may come after the path's end. Only a vehicle that hovers is still there.
        let now_s = self.view.now_s();
        if now_s > place.time_s && !self.asked.vehicle.can_hover() {
            return None;
        }
        let place = TimedPoint::new(place.position, place.time_s.max(now_s));
        way_on(&self.now(), place, velocity, self.view.way_on_s())
    }
}

/// A stay here until a time, with the way on from its end, if there is a safe one.
pub(crate) fn stay_until(view: View<'_>, until_s: f64) -> Option<InForce> {
    let request = own_problem(view);
    let (asked, here) = (request.problem(), Trajectory::hover(view.here(), 0.0));
    let ending = Ending {
        view,
        asked: &asked,
        stand_off: None,
        leg: None,
        goes_on: true,
    };
    let (velocity, stay_s) = (view.beliefs().velocity, until_s - view.now_s());
    let mut stays = station_keeping::stays(&asked, here.end(), velocity, stay_s);
    stays.find_map(|stay| ending.with(&here, &stay))
}

/// The trajectory in force with another way on from its end, clear of what is predicted now.
pub(crate) fn with_other_way_on(view: View<'_>) -> Option<InForce> {
    let purpose = view.state.in_force.as_ref()?.purpose();
    let request = own_problem(view);
    let now = request.problem();
    let way_on = way_on(&now, purpose.end(), purpose.end_velocity(), view.way_on_s())?;
    let in_force = InForce::new(purpose.after(view.now_s()), Some(&way_on));
    let lasts_s = (in_force.ends_s, view.way_on_s());
    // What it is followed for is in force already.
    let way = in_force.whole.after(in_force.ends_s);
    check::has_way_on(&now, &way, lasts_s, EndState::UnderWay).then_some(in_force)
}

/// Whether the vehicle can follow a path: it is near the path if the departure is past; if the
/// departure is to come, the trajectory in force still leads to the path's start, and the vehicle can
/// be there in time.
fn starts_on_track(view: View<'_>, question: &PathQuestion, path: &Trajectory) -> bool {
    let now_s = view.now_s();
    let departure_s = question.departure_s;
    let off_m = (view.beliefs().position - path.at(now_s).0).norm();
    let too_late = departure_s < now_s && off_m > view.settings.margins.off_track_m;
    let elsewhere = view.in_force().is_some_and(|in_force| {
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
    match view.in_force().filter(leads_there) {
        Some(in_force) => Some(in_force.until(start.time_s).after(now_s)),
        None => Trajectory::new(vec![view.here(), start]).ok(),
    }
}

#[cfg(test)]
mod tests;
