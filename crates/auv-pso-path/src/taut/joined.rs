//! A string that is joined farther along: the shortest connection from the direction flown to a place on the
//! string, in the direction of the string there.

use crate::taut::candidate::Candidate;
use crate::taut::flyable::flyable;
use auv_planning::PathProblem;
use auv_planning::motion::{Pose, connections, join};

/// How far along the string it is joined, in turn radii.
const CUTS: [f64; 4] = [2.0, 4.0, 8.0, 16.0];
/// Connections to each place.
const CONNECTIONS: usize = 2;

/// The first clear way that joins the string of a candidate. `None` without one, and for a vehicle that
/// leaves in any direction.
pub(crate) fn joined(problem: &PathProblem<'_>, candidate: &Candidate) -> Option<Candidate> {
    let radius_m = problem.vehicle.turn_radius_m;
    let direction = problem.start_velocity.filter(|_| radius_m > 0.0)?;
    let string = &candidate.string;
    let corners: Vec<_> = string.points.iter().map(|p| p.position).collect();
    let places = flyable(problem, &corners);
    let from = Pose {
        place: problem.start,
        direction,
    };
    CUTS.into_iter().find_map(|cut| {
        let (at, direction) = join(&places, cut * radius_m)?;
        let to = Pose {
            place: places[at],
            direction,
        };
        let ways = connections(problem.vehicle, from, to).into_iter();
        let mut ways = ways.take(CONNECTIONS).filter_map(|way| {
            let points = [&way, &places[at + 1..]].concat();
            Candidate::along(problem, string.clone(), &points)
        });
        ways.find(Candidate::is_clear)
    })
}
