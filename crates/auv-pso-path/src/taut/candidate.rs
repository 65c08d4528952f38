//! A finished trajectory with the string behind it.

use crate::examine::Examined;
use crate::taut::flyable::flyable;
use crate::taut::string::TautString;
use crate::taut::work::LOOK_UP;
use auv_planning::departure::DepartureManoeuvre;
use auv_planning::{PathProblem, Score};
use auv_types::Point3;

/// Regions that are compared with a point in one unit of work.
const REGIONS_PER_UNIT: u64 = 16;
/// Look-ups for each point of a trajectory, with a sea bed and without.
const LOOK_UPS_WITH_BED: u64 = 16;
const LOOK_UPS: u64 = 4;

/// A trajectory that could be the answer.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    pub(crate) string: TautString,
    pub(crate) examined: Examined,
}

impl Candidate {
    /// Makes a string flyable and examines it. `None` where the current is too strong.
    pub(crate) fn new(
        problem: &PathProblem<'_>,
        departure: &DepartureManoeuvre,
        string: TautString,
    ) -> Option<Self> {
        let points = polyline(problem, departure, &string);
        Self::along(problem, string, &points)
    }

    /// Examines a polyline that is made from a string. `None` where the current is too strong.
    pub(crate) fn along(
        problem: &PathProblem<'_>,
        string: TautString,
        points: &[Point3<f64>],
    ) -> Option<Self> {
        let trajectory = problem.timed(points).ok()?;
        Some(Self {
            string,
            examined: Examined::new(problem, trajectory),
        })
    }

    /// Units of work that making and examining it took.
    pub(crate) fn work(&self, problem: &PathProblem<'_>) -> u64 {
        let points = self.examined.trajectory.points().len() as u64;
        let look_ups = if problem.sea_bed.is_some() {
            LOOK_UPS_WITH_BED
        } else {
            LOOK_UPS
        };
        points * (problem.regions.len() as u64 / REGIONS_PER_UNIT + look_ups * LOOK_UP)
    }

    pub(crate) fn is_clear(&self) -> bool {
        self.examined.is_clear()
    }

    pub(crate) fn duration_s(&self) -> f64 {
        self.examined.trajectory.duration_s()
    }

    /// By how many metres it falls short, and how many seconds it takes.
    pub(crate) fn score(&self) -> Score {
        Score::new(self.examined.shortfall.metres, self.duration_s())
    }

    pub(crate) fn is_better(&self, other: &Self) -> bool {
        self.score() < other.score()
    }
}

/// A string with its departure, as the vehicle can fly it. The departure leads to the first vertex of the
/// string, wherever it led when the string was tightened.
fn polyline(
    problem: &PathProblem<'_>,
    departure: &DepartureManoeuvre,
    string: &TautString,
) -> Vec<Point3<f64>> {
    let straight = string.points.len() == 2;
    if let Some(whole) = departure.whole().filter(|_| straight) {
        return whole.points.clone();
    }
    let first = string.points[1].position;
    let aimed = departure.towards(problem, first);
    let departure = aimed.as_ref().unwrap_or(departure);
    let mut corners = vec![departure.end];
    corners.extend(string.points[1..].iter().map(|p| p.position));
    // The departure is flyable as it is.
    [&departure.corners, flyable(problem, &corners).as_slice()].concat()
}

/// Keeps the better of two.
pub(crate) fn keep_better(best: &mut Option<Candidate>, candidate: Option<Candidate>) {
    if let Some(candidate) = candidate
        && best.as_ref().is_none_or(|best| candidate.is_better(best))
    {
        *best = Some(candidate);
    }
}
