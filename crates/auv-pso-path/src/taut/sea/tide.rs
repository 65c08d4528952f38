//! The current along a lattice of a leg, tabulated over the time of a flight.

use auv_planning::front::{Lattice, Tide};
use auv_planning::{Deadline, PathProblem};

/// Times tabulated where the current changes.
const TIMES: usize = 13;
/// Span of the table, in times that the leg takes in still water.
const SPAN: f64 = 2.5;
/// Places and changes by which a current is judged steady: m/s.
const PROBES: usize = 9;
const STEADY_MPS: f64 = 1e-6;

/// The current at the nodes of a lattice from a departure on. `None` when the deadline passes first.
pub(crate) fn tide(
    problem: &PathProblem<'_>,
    lattice: &Lattice,
    departure_s: f64,
    deadline: Deadline<'_>,
) -> Option<Tide> {
    let Some(field) = problem.current else {
        return Some(Tide::still());
    };
    let line_m = (problem.target - problem.start).norm();
    let step_s = SPAN * line_m / problem.vehicle.speed_mps / (TIMES - 1) as f64;
    let times = if is_steady(problem, departure_s, step_s) {
        1
    } else {
        TIMES
    };
    Tide::new(field, lattice, (departure_s, step_s, times), deadline)
}

/// Whether the current is the same at all times at some places along the leg.
fn is_steady(problem: &PathProblem<'_>, departure_s: f64, step_s: f64) -> bool {
    let Some(field) = problem.current else {
        return true;
    };
    let line = problem.target - problem.start;
    (0..PROBES).all(|p| {
        let place = problem.start + line * (p as f64 / (PROBES - 1) as f64);
        let first = field.velocity_at(&place, departure_s);
        (1..TIMES).all(|k| {
            let later = field.velocity_at(&place, departure_s + step_s * k as f64);
            (later - first).norm() < STEADY_MPS
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::taut::sea::chart::{Chart, Extent};
    use auv_ocean::{AnalyticCurrent, TidalConstituent};
    use auv_planning::Vehicle;
    use auv_types::Point3;

    #[test]
    fn a_tide_is_tabulated_and_a_steady_current_once() {
        let vehicle = Vehicle::paper();
        let tidal = AnalyticCurrent {
            tide: vec![TidalConstituent::turning_at(9e3, [0.5, 0.1])],
            ..AnalyticCurrent::default()
        };
        let steady = AnalyticCurrent {
            mean_mps: [0.3, 0.0],
            ..AnalyticCurrent::default()
        };
        let (start, target) = (Point3::new(0.0, 0.0, 20.0), Point3::new(9e3, 0.0, 20.0));
        for (field, times) in [(&tidal, TIMES), (&steady, 1)] {
            let problem = PathProblem {
                current: Some(field),
                ..PathProblem::new(start, target, &vehicle)
            };
            let deadline = Deadline::default();
            let chart = Chart::new(&problem, start, 8, Extent::Level, deadline).unwrap();
            let table = tide(&problem, &chart.lattice, 0.0, deadline).unwrap();
            assert_eq!(table.entries(), times * chart.lattice.nodes());
        }
    }
}
