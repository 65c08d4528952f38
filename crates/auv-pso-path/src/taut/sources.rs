//! Where candidates come from: named polylines, each tightened and made flyable.

use crate::taut::candidate::Candidate;
use crate::taut::lattice;
use crate::taut::regions::GrownRegions;
use crate::taut::string::{StringSolver, Tightening};
use crate::taut::work::WorkRate;
use auv_planning::departure::DepartureManoeuvre;
use auv_planning::{PathProblem, Run};
use auv_types::Point3;

/// Most rounds and evaluations of one candidate.
const ROUNDS: u64 = 40;
const MOST_EVALUATIONS: u64 = 150;
/// Gain of a round below which a string is taut, as a share of the straight line.
const TOLERANCE: f64 = 1e-6;
/// Farthest first move of a vertex, metres: less than the band in which regions are seen, so that the
/// string keeps its sides. A lattice path is off by up to half a cell and may move farther.
const IN_FORCE_TRUST_M: f64 = 20.0;
const LATTICE_TRUST_M: f64 = 25.0;
/// With so few contacts the straight line has found the right sides.
const FEW_CONTACTS: usize = 2;

/// Where a candidate comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CandidateSource {
    /// The trajectory in force, if the problem has one.
    InForce,
    /// The straight line to the target.
    StraightLine,
    /// The cheapest path over a lattice.
    Lattice,
}

impl CandidateSource {
    /// Whether the best candidate so far makes this source needless.
    pub(crate) fn is_needless_after(self, best: &Candidate) -> bool {
        match self {
            Self::InForce | Self::StraightLine => best.is_clear(),
            Self::Lattice => best.is_clear() && best.string.contacts.len() <= FEW_CONTACTS,
        }
    }
}

/// Makes candidates of one departure.
pub(crate) struct CandidateMaker<'a> {
    problem: &'a PathProblem<'a>,
    regions: &'a GrownRegions,
    departure: &'a DepartureManoeuvre,
    rate: WorkRate,
    solver: StringSolver<'a>,
}

impl<'a> CandidateMaker<'a> {
    pub(crate) fn new(
        problem: &'a PathProblem<'a>,
        regions: &'a GrownRegions,
        departure: &'a DepartureManoeuvre,
    ) -> Self {
        Self {
            problem,
            regions,
            departure,
            rate: WorkRate::new(problem),
            solver: StringSolver::new(problem, regions),
        }
    }

    /// The candidate of a source. `None` if the source has no polyline, if the budget does not allow
    /// it, or if the current is too strong.
    pub(crate) fn make(&mut self, run: &mut Run<'_>, source: CandidateSource) -> Option<Candidate> {
        match source {
            CandidateSource::InForce => {
                let polyline = self.in_force()?;
                self.tightened(run, &polyline, IN_FORCE_TRUST_M)
            }
            CandidateSource::StraightLine => {
                let polyline = [self.departure.end, self.problem.target];
                self.tightened(run, &polyline, f64::INFINITY)
            }
            CandidateSource::Lattice => {
                let polyline = self.over_lattice(run)?;
                self.tightened(run, &polyline, LATTICE_TRUST_M)
            }
        }
    }

    /// The trajectory in force, from the end of the departure to the target.
    fn in_force(&self) -> Option<Vec<Point3<f64>>> {
        let points = self.problem.warm_start?.points();
        let inner = points.iter().map(|p| p.position).skip(1);
        let mut polyline = vec![self.departure.end];
        polyline.extend(inner.take(points.len().saturating_sub(2)));
        polyline.push(self.problem.target);
        Some(polyline)
    }

    fn over_lattice(&self, run: &mut Run<'_>) -> Option<Vec<Point3<f64>>> {
        let needed = self
            .rate
            .evaluations(lattice::work(self.problem, self.departure));
        if run.grant(needed) < needed {
            return None;
        }
        lattice::coarse_path(self.problem, self.regions, self.departure, run.deadline())
    }

    fn tightened(
        &mut self,
        run: &mut Run<'_>,
        polyline: &[Point3<f64>],
        trust_m: f64,
    ) -> Option<Candidate> {
        let left = run.evaluations_left().unwrap_or(u64::MAX);
        let limits = Tightening {
            rounds: ROUNDS,
            trust_m,
            tolerance: TOLERANCE,
            limit_s: f64::INFINITY,
            work: self.rate.units(left.min(MOST_EVALUATIONS)),
            deadline: run.deadline(),
        };
        let tightened = self.solver.tighten(polyline, self.departure.end_s, &limits);
        let string = self.solver.taut_string();
        let candidate = Candidate::new(self.problem, self.departure, string);
        let examined = candidate.as_ref().map_or(0, |c| c.work(self.problem));
        run.grant(self.rate.evaluations(tightened.work + examined));
        candidate
    }
}
