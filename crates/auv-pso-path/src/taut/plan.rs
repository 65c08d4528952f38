//! The time-optimal search: which candidates are tried, in which order, and what is kept.

use crate::taut::candidate::Candidate;
use crate::taut::detours::DetourSearch;
use crate::taut::intrusion::least_intruding;
use crate::taut::search_context::SearchContext;
use crate::taut::settings::TautSettings;
use crate::taut::strung::{Start, first_clear};
use crate::taut::through_sea::{has_depths, has_plenty, is_calm, through_sea};
use crate::taut::work::WorkRate;
use auv_planning::departure::DepartureManoeuvre;
use auv_planning::{PathProblem, Planned, Run, StopReason, Trajectory};
use auv_population::{Workers, search};

/// A duration this close to the bound is the bound, as a share.
const BOUND_ROUNDING: f64 = 1e-12;
/// Patience of the search for detours, with a deadline and without: a deadline is time to be used.
const PATIENCE_UNTIL_DEADLINE: u64 = 4;
const PATIENCE: u64 = 1;

/// Plans one leg. `None` where the current is too strong on every path tried.
///
/// 1. In still water, and among regions with room above and below, the string: for each departure (turns, circles
///    that change depth) and each slack, until a candidate is clear, its sources are tried in order;
///    without one, the least intrusion into regions is found. Then detours of the best are searched, unless
///    it is straight or touches one region alone.
/// 2. In moving water, and over a bed that is in the way, the sources through the sea. With few evaluations
///    a current that is calm counts as still water, unless the string is not clear.
pub(crate) fn plan(
    run: &mut Run<'_>,
    problem: &PathProblem<'_>,
    settings: &TautSettings,
    workers: &Workers,
) -> Option<Planned<Trajectory>> {
    let moving = problem.current.is_some() && (has_plenty(run) || !is_calm(problem));
    let mut best: Option<(Candidate, DepartureManoeuvre)> = None;
    let mut reason = StopReason::Finished;
    if !moving || !problem.regions.is_empty() && has_depths(problem) {
        let start = first_clear(run, problem);
        if let Some(start) = start {
            (best, reason) = detoured(run, problem, start, settings, workers);
        }
    }
    let is_done = |(candidate, _): &(Candidate, DepartureManoeuvre)| {
        let straight = candidate.string.points.len() == 2;
        let optional = problem.sea_bed.is_none() || straight || !run.has_deadline();
        candidate.is_clear() && !moving && optional
    };
    let needs_sea = problem.current.is_some() || problem.sea_bed.is_some();
    let best = if needs_sea && !best.as_ref().is_some_and(is_done) {
        through_sea(run, problem, best)?
    } else {
        best?.0
    };
    Some(answer(run, problem, best, reason))
}

/// The best candidate after a search for detours, with its departure, and why the search ended.
fn detoured(
    run: &mut Run<'_>,
    problem: &PathProblem<'_>,
    start: Start,
    settings: &TautSettings,
    workers: &Workers,
) -> (Option<(Candidate, DepartureManoeuvre)>, StopReason) {
    let Start {
        regions,
        departure,
        candidate,
    } = start;
    let candidate = least_intruding(run, problem, &departure, candidate);
    let score = candidate.score();
    let straight = candidate.string.points.len() == 2;
    // Round one region alone there is no better side.
    if candidate.is_clear() && (straight || candidate.string.contacts.len() == 1) {
        run.end_generation(score, &[], &[]);
        let limit_s = bound_s(problem).map(|bound_s| bound_s * (1.0 + BOUND_ROUNDING));
        let reason = if limit_s.is_some_and(|limit_s| score.cost <= limit_s) {
            StopReason::Optimal
        } else {
            StopReason::Finished
        };
        return (Some((candidate, departure)), reason);
    }
    let context = SearchContext {
        problem,
        regions: &regions,
        departure: &departure,
        rate: WorkRate::new(problem),
        deadline: run.deadline(),
    };
    let patience = if run.has_deadline() {
        PATIENCE_UNTIL_DEADLINE
    } else {
        PATIENCE
    };
    let size = settings.detours;
    let mut detours = DetourSearch::new(context, run.seed(), candidate, size, patience);
    let reason = search(run, workers, &mut detours);
    (Some((detours.into_best(), departure)), reason)
}

/// The straight line in still water: nothing is quicker.
fn bound_s(problem: &PathProblem<'_>) -> Option<f64> {
    let line_m = (problem.target - problem.start).norm();
    let still = problem.current.is_none();
    still.then(|| line_m / problem.vehicle.speed_mps)
}

/// The answer, with its duration as cost.
fn answer(
    run: &Run<'_>,
    problem: &PathProblem<'_>,
    best: Candidate,
    reason: StopReason,
) -> Planned<Trajectory> {
    let duration_s = best.duration_s();
    let mut planned = best
        .examined
        .planned(problem, duration_s, run.stats(reason));
    planned.bound = bound_s(problem);
    planned
}
