//! A string that is joined farther along: the shortest connection from the direction flown to a place on the
//! string, in the direction of the string there.

use crate::taut::candidate::Candidate;
use crate::taut::flyable::flyable;
use auv_planning::PathProblem;
use auv_planning::motion::{Pose, connections};
use auv_types::{Point3, Vector3};

/// How far along the string it is joined, in turn radii.
const CUTS: [f64; 4] = [2.0, 4.0, 8.0, 16.0];
/// A string is joined along a piece that is at least this long, metres.
const LEAST_PIECE_M: f64 = 0.5;
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

/// The first vertex at least `cut_m` along a path, and the direction of the piece that leads on from it.
fn join(places: &[Point3<f64>], cut_m: f64) -> Option<(usize, Vector3<f64>)> {
    let mut gone_m = 0.0;
    places.windows(2).enumerate().find_map(|(k, pair)| {
        let piece = pair[1] - pair[0];
        let far_enough = gone_m >= cut_m && piece.norm() >= LEAST_PIECE_M;
        gone_m += piece.norm();
        far_enough.then_some((k, piece))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_joined_along_its_next_long_piece() {
        let places = [0.0, 5.0, 10.0, 10.2, 30.0].map(|x| Point3::new(x, 0.0, 0.0));
        let joined = |cut_m: f64| join(&places, cut_m).map(|(at, piece)| (at, piece.x));
        assert_eq!(joined(0.0), Some((0, 5.0)));
        assert_eq!(joined(3.0), Some((1, 5.0)));
        assert_eq!(joined(10.0).map(|(at, _)| at), Some(3));
        assert_eq!(joined(30.0), None);
    }
}
