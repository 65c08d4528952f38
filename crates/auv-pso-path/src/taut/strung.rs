//! The first candidates: strings that start in the trajectory in force, the straight line and the lattice.

use crate::taut::candidate::{Candidate, keep_better};
use crate::taut::joined::joined;
use crate::taut::regions::GrownRegions;
use crate::taut::sources::{CandidateMaker, CandidateSource};
use crate::taut::string::TautString;
use auv_obstacles::TimedPoint;
use auv_planning::departure::{DepartureManoeuvre, connections_to_target, departures};
use auv_planning::{PathProblem, Run};

/// With so many regions the lattice comes first: too many at once would push a straight string
/// about.
const DENSE: usize = 100;
/// A new path must be quicker by this share to replace the trajectory in force.
pub(crate) const HABIT: f64 = 1e-3;
/// Metres added to the clearance while a string is tightened, one after the other: rounding a corner
/// cuts it.
const SLACKS_M: [f64; 3] = [0.0, 0.5, 5.0];

/// A candidate with what it was made from.
pub(crate) struct Start {
    pub(crate) regions: GrownRegions,
    pub(crate) departure: DepartureManoeuvre,
    pub(crate) candidate: Candidate,
}

/// The best candidate of all departures, each with the least slack that gives a clear one. A departure
/// that takes longer than the best without any region is passed over.
pub(crate) fn first_clear(run: &mut Run<'_>, problem: &PathProblem<'_>) -> Option<Start> {
    let vehicle = problem.vehicle;
    let limited = vehicle.turn_radius_m > 0.0
        || vehicle.max_pitch_rad < std::f64::consts::FRAC_PI_2
        || problem.current.is_some();
    let slacks_m = if limited { &SLACKS_M[..] } else { &[0.0] };
    let mut best = turning(run, problem);
    for departure in departures(problem) {
        if best
            .as_ref()
            .is_some_and(|best| ends(problem, best, &departure))
        {
            return best;
        }
        for &slack_m in slacks_m {
            let regions = GrownRegions::new(problem, slack_m, slack_m > 0.0);
            let Some(candidate) = first_candidate(run, problem, &regions, &departure) else {
                continue;
            };
            let clear = candidate.is_clear();
            let beats = |best: &Start| candidate.is_better(&best.candidate);
            if best.as_ref().is_none_or(beats) {
                let departure = departure.clone();
                best = Some(Start {
                    regions,
                    departure,
                    candidate,
                });
            }
            if run.should_stop() {
                return best;
            }
            if clear {
                break;
            }
        }
    }
    let start = best?;
    let mended = if start.candidate.is_clear() {
        None
    } else {
        joined(problem, &start.candidate)
    };
    Some(match mended {
        Some(candidate) => Start { candidate, ..start },
        None => start,
    })
}

/// The shortest connection to the target, if it ends with a turn: no string follows its departure.
fn turning(run: &mut Run<'_>, problem: &PathProblem<'_>) -> Option<Start> {
    let mut connections = connections_to_target(problem).into_iter();
    let shortest = connections.next()?;
    if shortest.straight_from.is_some() {
        return None;
    }
    run.grant(1);
    let ends = [problem.start, problem.target];
    let string = TautString {
        points: ends
            .map(|end| TimedPoint::new(end, problem.departure_s))
            .to_vec(),
        contacts: Vec::new(),
    };
    let candidate = Candidate::along(problem, string, &shortest.points)?;
    candidate.is_clear().then(|| Start {
        regions: GrownRegions::new(problem, 0.0, false),
        departure: DepartureManoeuvre::none(problem),
        candidate,
    })
}

/// Whether a departure and all longer ones can be passed over.
fn ends(problem: &PathProblem<'_>, best: &Start, departure: &DepartureManoeuvre) -> bool {
    let least_s = departure
        .whole()
        .map_or(0.0, |whole| whole.length_m / problem.vehicle.speed_mps);
    let hopeless = problem.current.is_some() || least_s >= best.candidate.duration_s();
    best.candidate.is_clear() && hopeless
}

/// The best candidate of one departure and slack.
///
/// A clear trajectory in force stays unless the straight line gives one that is quicker by
/// [`HABIT`]. Otherwise the straight line and the lattice are tried, in dense waters the lattice
/// first; the second only if the first left something to improve.
pub(crate) fn first_candidate(
    run: &mut Run<'_>,
    problem: &PathProblem<'_>,
    regions: &GrownRegions,
    departure: &DepartureManoeuvre,
) -> Option<Candidate> {
    let mut maker = CandidateMaker::new(problem, regions, departure);
    let in_force = maker.make(run, CandidateSource::InForce);
    if let Some(in_force) = in_force.filter(Candidate::is_clear) {
        let straight = maker.make(run, CandidateSource::StraightLine);
        let quick_s = in_force.duration_s() * (1.0 - HABIT);
        let quicker = |other: &Candidate| other.is_clear() && other.duration_s() < quick_s;
        return Some(straight.filter(quicker).unwrap_or(in_force));
    }
    let order = if problem.regions.len() >= DENSE && !run.should_stop() {
        [CandidateSource::Lattice, CandidateSource::StraightLine]
    } else {
        [CandidateSource::StraightLine, CandidateSource::Lattice]
    };
    let mut best = None;
    for source in order {
        if best
            .as_ref()
            .is_none_or(|best| !source.is_needless_after(best))
        {
            keep_better(&mut best, maker.make(run, source));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_obstacles::Region;
    use auv_planning::{Budget, StopReason, Vehicle};
    use auv_types::{Point3, Seed};

    fn first(problem: &PathProblem<'_>, evaluations: u64) -> (Option<Candidate>, u64) {
        let mut run = Run::new(Seed(1), Budget::evaluations(evaluations));
        let regions = GrownRegions::new(problem, 0.0, false);
        let departure = DepartureManoeuvre::none(problem);
        let candidate = first_candidate(&mut run, problem, &regions, &departure);
        (candidate, run.stats(StopReason::Finished).evaluations)
    }

    fn leg<'a>(vehicle: &'a Vehicle, regions: &'a [Region]) -> PathProblem<'a> {
        PathProblem {
            regions,
            ..PathProblem::new(
                Point3::new(0.0, 0.0, 50.0),
                Point3::new(900.0, 0.0, 50.0),
                vehicle,
            )
        }
    }

    #[test]
    fn a_clear_straight_line_is_the_only_candidate_made() {
        let vehicle = Vehicle::paper();
        let (candidate, evaluations) = first(&leg(&vehicle, &[]), 100);
        assert!(candidate.unwrap().is_clear());
        assert_eq!(evaluations, 1);
    }

    #[test]
    fn many_regions_are_answered_by_the_lattice_without_the_straight_line() {
        let vehicle = Vehicle::paper();
        let ball = |k: u32| {
            let (x, y) = (
                f64::from(k % 15) * 50.0 + 100.0,
                f64::from(k / 15) * 60.0 - 200.0,
            );
            Region::ball(Point3::new(x, y, 50.0), 20.0)
        };
        let dense: Vec<_> = (0..DENSE as u32).map(ball).collect();
        let (candidate, evaluations) = first(&leg(&vehicle, &dense), 100);
        assert!(candidate.unwrap().is_clear());
        // One region fewer, and the straight line is tightened first.
        let (_, with_straight) = first(&leg(&vehicle, &dense[1..]), 100);
        assert!(evaluations < with_straight, "{evaluations} {with_straight}");
    }

    #[test]
    fn the_trajectory_in_force_yields_only_to_a_path_quicker_by_its_habit() {
        let vehicle = Vehicle::paper();
        let regions = [Region::ball(Point3::new(450.0, 0.0, 50.0), 30.0)];
        let problem = leg(&vehicle, &regions);
        // On the other side of the ball a path takes as long.
        for side in [1.0, -1.0] {
            let middle = Point3::new(450.0, 40.0 * side, 50.0);
            let warm = problem.timed(&[problem.start, middle, problem.target]);
            let warm = warm.unwrap();
            let problem = PathProblem {
                warm_start: Some(&warm),
                ..problem
            };
            let candidate = first(&problem, 200).0.unwrap();
            let half_s = 0.5 * candidate.duration_s();
            assert!(candidate.examined.trajectory.at(half_s).0.y * side > 29.0);
        }
    }
}
