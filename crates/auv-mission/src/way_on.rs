//! The way on from the end of a trajectory: what is flown there if nothing better is known by then.
//!
//! It ends in a state that can be kept: at rest, or on whole circles that can be repeated. So the vehicle
//! always has a verified trajectory in hand, whatever the planners answer.

use crate::check;
use crate::leads::leads;
use crate::station_keeping::holds;
use auv_obstacles::{Region, TimedPoint};
use auv_planning::{PathProblem, Trajectory};
use auv_types::Vector3;

/// The longest straight piece that is tried, metres.
const LONGEST_M: f64 = 100.0;

/// The first way on from a place with a velocity that the vehicle can fly within box and bed and clear
/// of the problem's regions, and that lasts at least `lasts_s`: staying there, or a short way to a place
/// where it can stay.
pub(crate) fn way_on(
    problem: &PathProblem<'_>,
    place: TimedPoint,
    velocity: Vector3<f64>,
    lasts_s: f64,
) -> Option<Trajectory> {
    let from = from(problem, place);
    let holds = |at: TimedPoint, velocity| holds(&from, at, velocity, lasts_s);
    let fits = |way: &Trajectory| check::leads_on(&from, velocity, way);
    let mut stay = holds(place, velocity);
    stay.find(fits).or_else(|| {
        leads(&from, LONGEST_M).find_map(|lead| {
            let lead = from.timed(&lead.points(&from, velocity)).ok()?;
            if !fits(&lead) {
                return None;
            }
            let whole = |hold| lead.clone().then(&hold).ok();
            holds(lead.end(), lead.end_velocity())
                .filter_map(whole)
                .find(fits)
        })
    })
}

/// The problem of going on from a place.
fn from<'p>(problem: &PathProblem<'p>, place: TimedPoint) -> PathProblem<'p> {
    PathProblem {
        start: place.position,
        departure_s: place.time_s,
        ..*problem
    }
}

/// The regions that are always there: what is charted. The prediction of a contact at rest lasts for ever too,
/// but begins now.
pub(crate) fn permanent(regions: &[Region]) -> Vec<Region> {
    let always = |region: &&Region| region.is_permanent() && region.from_s == f64::NEG_INFINITY;
    let charted = regions.iter().filter(always);
    charted.copied().collect()
}
