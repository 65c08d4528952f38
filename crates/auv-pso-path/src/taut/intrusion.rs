//! The path of least intrusion where none is clear.

use crate::taut::candidate::{Candidate, keep_better};
use crate::taut::regions::GrownRegions;
use crate::taut::strung::first_candidate;
use auv_planning::departure::DepartureManoeuvre;
use auv_planning::{PathProblem, Run};

/// The least intrusion is found to within these metres, or this share of it.
const INTRUSION_M: f64 = 0.01;
const INTRUSION_SHARE: f64 = 1e-3;

/// A candidate that intrudes less upon regions, where none is clear: the least metres by which the regions
/// have to be smaller for a string to be clear are found by bisection.
pub(crate) fn least_intruding(
    run: &mut Run<'_>,
    problem: &PathProblem<'_>,
    departure: &DepartureManoeuvre,
    best: Candidate,
) -> Candidate {
    if best.examined.shortfall.region.is_none() {
        return best;
    }
    let (mut low_m, mut high_m) = (0.0, best.examined.shortfall.metres);
    let mut kept = Some(best.clone());
    while high_m - low_m > INTRUSION_M.max(INTRUSION_SHARE * high_m) && !run.should_stop() {
        let middle_m = 0.5 * (low_m + high_m);
        let regions = GrownRegions::new(problem, -middle_m, false);
        let candidate = first_candidate(run, problem, &regions, departure);
        let short_m = candidate
            .as_ref()
            .map_or(f64::INFINITY, |c| c.examined.shortfall.metres);
        keep_better(&mut kept, candidate);
        if short_m <= middle_m + INTRUSION_M {
            high_m = short_m.min(middle_m);
        } else {
            low_m = middle_m;
        }
    }
    kept.unwrap_or(best)
}
