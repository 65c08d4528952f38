//! How a vehicle with a turn radius or a pitch limit leaves a place: turns towards the target, and
//! circuits that change depth. Path planners begin their trajectories with these; [`LegTime`] counts
//! how long they take.
//!
//! [`LegTime`]: crate::LegTime

mod circuits;
mod manoeuvre;
mod turns;

pub use circuits::{circuits, is_too_steep};
pub use manoeuvre::DepartureManoeuvre;
pub use turns::turns;

use crate::PathProblem;

/// Departures in the order in which they are to be tried: the quick turns first, unless the target is too
/// steep for any of them.
#[must_use]
pub fn departures(problem: &PathProblem<'_>) -> Vec<DepartureManoeuvre> {
    let (turns, circuits) = (turns(problem), circuits(problem));
    if is_too_steep(problem, 1.0) {
        [circuits, turns].concat()
    } else {
        [turns, circuits].concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vehicle;
    use auv_types::{Point3, Vector3};

    #[test]
    fn circuits_are_tried_first_only_where_the_target_is_too_steep() {
        let vehicle = Vehicle::default();
        let problem = |depth_m: f64| PathProblem {
            start_velocity: Some(Vector3::new(1.5, 0.0, 0.0)),
            ..PathProblem::new(
                Point3::new(0.0, 0.0, 10.0),
                Point3::new(400.0, 0.0, depth_m),
                &vehicle,
            )
        };
        let level = |departure: &DepartureManoeuvre| departure.end.z == 10.0;
        let (flat, sloping, steep) = (
            departures(&problem(20.0)),
            departures(&problem(100.0)),
            departures(&problem(300.0)),
        );
        assert!(flat.iter().all(level));
        assert!(level(&sloping[0]) && !level(&sloping[sloping.len() - 1]));
        assert!(!level(&steep[0]) && level(&steep[steep.len() - 1]));
    }
}
