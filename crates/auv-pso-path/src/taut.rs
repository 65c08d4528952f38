//! The time-optimal planner: a taut string from a geometric seed, improved by a flock of bumps
//! while there is time and anything to gain.

use crate::certify::Verdict;
use crate::field::Field;
use crate::flock::{Flock, Setting};
use crate::flyable::{Candidate, Launch};
use crate::lattice;
use crate::settings::PsoSettings;
use crate::string::{Pull, Strand, StringMaker};
use crate::work::Rate;
use auv_planning::{PathProblem, Run, StopReason, Trajectory};
use auv_population::{Workers, search};
use auv_types::Point3;

/// The best trajectory found.
pub(crate) struct Found {
    pub(crate) trajectory: Trajectory,
    pub(crate) verdict: Verdict,
    pub(crate) bound_s: Option<f64>,
    pub(crate) reason: StopReason,
}

/// Rounds a seed is pulled for at most, and evaluations that may take.
const ROUNDS: u64 = 40;
const SEED: u64 = 150;
/// With so many regions the lattice comes first: a straight string would be pushed about by too
/// many at once.
const DENSE: usize = 100;
/// A new way must be quicker by this share to be taken instead of the trajectory in force.
const HABIT: f64 = 1e-3;

/// Plans one leg; `None` where no way can be flown against the current.
pub(crate) fn plan(
    run: &mut Run<'_>,
    problem: &PathProblem<'_>,
    settings: &PsoSettings,
    workers: &Workers,
) -> Option<Found> {
    let (field, launch, best) = first_clear(run, problem)?;
    let bound_s = bound_s(problem);
    let score = best.score();
    let proven = bound_s.is_some_and(|bound_s| score.cost <= bound_s * (1.0 + 1e-12));
    let straight = best.strand.points.len() == 2;
    // A string round one thing alone has no better side to go to.
    if best.is_clear() && (straight || best.strand.contacts.len() == 1) {
        run.end_generation(score, &[], &[]);
        let reason = if proven {
            StopReason::Optimal
        } else {
            StopReason::Finished
        };
        return Some(Found::new(best, bound_s, reason));
    }
    let setting = Setting {
        problem,
        field: &field,
        launch: &launch,
        rate: Rate::of(problem),
        deadline: run.deadline(),
    };
    let patience = if run.has_deadline() { 4 } else { 1 };
    let size = settings.particles.div_ceil(4);
    let mut flock = Flock::new(setting, run.seed(), best, (size, patience));
    let reason = search(run, workers, &mut flock);
    Some(Found::new(flock.into_best(), bound_s, reason))
}

/// The first way to leave the start, and the least slack to the regions, that give a clear
/// candidate; else the best of them.
fn first_clear(run: &mut Run<'_>, problem: &PathProblem<'_>) -> Option<(Field, Launch, Candidate)> {
    let vehicle = problem.vehicle;
    let limited = vehicle.turn_radius_m > 0.0
        || vehicle.max_pitch_rad < std::f64::consts::FRAC_PI_2
        || problem.current.is_some();
    // What rounding a corner costs in clearance is made up for by keeping farther away.
    let slacks_m: &[f64] = if limited { &[0.0, 0.5, 5.0] } else { &[0.0] };
    let mut best: Option<(Field, Launch, Candidate)> = None;
    for launch in Launch::ways(problem) {
        for &slack_m in slacks_m {
            let field = Field::new(problem, slack_m, slack_m > 0.0);
            let Some(candidate) = seeded(run, problem, &field, &launch) else {
                continue;
            };
            let clear = candidate.is_clear();
            if best
                .as_ref()
                .is_none_or(|best| candidate.is_better(&best.2))
            {
                best = Some((field, launch.clone(), candidate));
            }
            if clear || run.should_stop() {
                return best;
            }
        }
    }
    best
}

impl Found {
    fn new(best: Candidate, bound_s: Option<f64>, reason: StopReason) -> Self {
        Self {
            trajectory: best.trajectory,
            verdict: best.verdict,
            bound_s,
            reason,
        }
    }
}

/// The straight line in still water: nothing is quicker.
fn bound_s(problem: &PathProblem<'_>) -> Option<f64> {
    let line_m = (problem.target - problem.start).norm();
    let still = problem.current.is_none();
    still.then(|| line_m / problem.vehicle.speed_mps)
}

/// The best of the trajectory in force, the straight line and the coarse way, each pulled taut.
fn seeded(
    run: &mut Run<'_>,
    problem: &PathProblem<'_>,
    field: &Field,
    launch: &Launch,
) -> Option<Candidate> {
    let rate = Rate::of(problem);
    let mut maker = StringMaker::new(problem, field);
    let mut pulled = |run: &mut Run<'_>, seed: &[Point3<f64>], trust_m: f64| {
        let most = run.evaluations_left().unwrap_or(u64::MAX).min(SEED);
        let pull = Pull {
            rounds: ROUNDS,
            trust_m,
            tolerance: 1e-6,
            limit_s: f64::INFINITY,
            work: rate.units(most),
            deadline: run.deadline(),
        };
        let work = maker.pull(seed, launch.departure_s, &pull).work;
        let candidate = Candidate::new(problem, launch, Strand::of(&maker));
        let checked = candidate
            .as_ref()
            .map_or(0, |candidate| candidate.work(problem));
        run.grant(rate.evaluations(work + checked));
        candidate
    };
    let straight = [launch.from, problem.target];
    if let Some(warm) = problem.warm_start {
        let middle = warm.points().iter().map(|p| p.position);
        let mut seed = vec![launch.from];
        seed.extend(middle.skip(1).take(warm.points().len().saturating_sub(2)));
        seed.push(problem.target);
        let warm = pulled(run, &seed, 20.0).filter(Candidate::is_clear);
        if let Some(warm) = warm {
            let other = pulled(run, &straight, f64::INFINITY).filter(Candidate::is_clear);
            let quicker = |other: &Candidate| {
                other.trajectory.duration_s() < warm.trajectory.duration_s() * (1.0 - HABIT)
            };
            return Some(other.filter(quicker).unwrap_or(warm));
        }
    }
    let mut best: Option<Candidate> = None;
    let mut keep = |candidate: Option<Candidate>| {
        if let Some(candidate) = candidate
            && best.as_ref().is_none_or(|best| candidate.is_better(best))
        {
            best = Some(candidate);
        }
        best.as_ref()
            .map(|best| (best.is_clear(), best.strand.contacts.len()))
    };
    let dense = problem.regions.len() >= DENSE && !run.should_stop();
    let mut standing = None;
    if !dense {
        standing = keep(pulled(run, &straight, f64::INFINITY));
    }
    let hard = standing.is_none_or(|(clear, contacts)| !clear || contacts > 2);
    let needed = rate.evaluations(lattice::work(problem, launch));
    if hard
        && run.grant(needed) == needed
        && let Some(way) = lattice::coarse_way(problem, field, launch, run.deadline())
    {
        standing = keep(pulled(run, &way, 25.0));
    }
    if standing.is_none_or(|(clear, _)| !clear) && dense {
        keep(pulled(run, &straight, f64::INFINITY));
    }
    best
}
