//! Paths through moving water and over a sea bed that is in the way.

use crate::taut::candidate::{Candidate, keep_better};
use crate::taut::regions::GrownRegions;
use crate::taut::sea::{SeaSource, SeaWays};
use crate::taut::strung::{HABIT, first_clear};
use auv_planning::departure::{DepartureManoeuvre, departures};
use auv_planning::{PathProblem, Run};
use auv_types::Bounds;

/// Metres kept beyond the clearance and the altitude, one after the other: the path is flown a little earlier
/// or later than it was pulled tight for, and rounding a corner cuts it.
const SEA_SLACKS_M: [f64; 3] = [0.02, 0.5, 5.0];
/// A box thinner than this leaves no room above and below a leg, metres.
const LEAST_DEPTHS_M: f64 = 4.0;
/// The current is calm where it is slower than this share of the vehicle's speed.
const CALM: f64 = 0.4;
/// With more evaluations than these the sea is searched until the sources end.
const PLENTY: u64 = 5_000;

/// Plans one leg through moving water or over a sea bed, better than a candidate that is known.
///
/// For each departure and slack, until a candidate is clear, the sources through the sea are tried in
/// order. Without a clear one the string is tried as in still water.
pub(crate) fn through_sea(
    run: &mut Run<'_>,
    problem: &PathProblem<'_>,
    known: Option<(Candidate, DepartureManoeuvre)>,
) -> Option<Candidate> {
    let (mut best, known_departure) = known.unzip();
    let strung = best.is_some();
    let others = departures(problem).into_iter();
    for departure in known_departure.clone().into_iter().chain(others) {
        for slack_m in SEA_SLACKS_M {
            let regions = GrownRegions::new(problem, slack_m, slack_m > SEA_SLACKS_M[0]);
            let ways = SeaWays::new(problem, &regions, &departure, slack_m);
            // A string begins at the end of its own departure.
            let mut own = best
                .clone()
                .filter(|_| known_departure.as_ref() == Some(&departure));
            try_sources(run, problem, &ways, &mut own);
            keep_better(&mut best, own);
            let clear = best.as_ref().is_some_and(Candidate::is_clear);
            if clear || run.should_stop() && best.is_some() {
                return best;
            }
        }
    }
    if !strung {
        keep_better(
            &mut best,
            first_clear(run, problem).map(|start| start.candidate),
        );
    }
    best
}

/// Whether there is time to search the sea until the sources end.
pub(crate) fn has_plenty(run: &Run<'_>) -> bool {
    run.has_deadline() || run.evaluations_left().is_none_or(|left| left > PLENTY)
}

/// Whether the current is so slow that a way that is clear in still water has no much better beside it.
pub(crate) fn is_calm(problem: &PathProblem<'_>) -> bool {
    let most_mps = problem.current.map_or(0.0, |field| field.max_speed_mps());
    most_mps <= CALM * problem.vehicle.speed_mps
}

/// Whether the box leaves room above and below the leg.
pub(crate) fn has_depths(problem: &PathProblem<'_>) -> bool {
    let depths_m = |bounds: Bounds| bounds.high.z - bounds.low.z;
    problem.bounds.map_or(f64::INFINITY, depths_m) > LEAST_DEPTHS_M
}

/// Tries the sources through the sea in order. Without a deadline and with few evaluations only the first
/// ones are tried, and in calm water none after a clear one.
///
/// The trajectory in force stays unless another is quicker by [`HABIT`].
fn try_sources(
    run: &mut Run<'_>,
    problem: &PathProblem<'_>,
    ways: &SeaWays<'_>,
    best: &mut Option<Candidate>,
) {
    let anytime = has_plenty(run);
    let few = if anytime {
        SeaSource::ALL.len()
    } else {
        SeaSource::FEW
    };
    let calm = is_calm(problem);
    let mut in_force = false;
    for &source in &SeaSource::ALL[..few] {
        let candidate = ways.make(run, source, best.as_ref());
        let same = source.is_like_best();
        let habit = if in_force && !same { HABIT } else { 0.0 };
        let clear = best.as_ref().filter(|best| best.is_clear());
        let limit_s = clear.map_or(f64::INFINITY, |best| best.duration_s() * (1.0 - habit));
        if let Some(candidate) = candidate.filter(|candidate| candidate.duration_s() < limit_s) {
            in_force = source == SeaSource::InForce || in_force && same;
            keep_better(best, Some(candidate));
        }
        let clear = best.as_ref().is_some_and(Candidate::is_clear);
        if run.should_stop() || clear && !anytime && calm {
            return;
        }
    }
}
