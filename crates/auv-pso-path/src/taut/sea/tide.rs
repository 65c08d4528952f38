//! The current at the nodes of a lattice, tabulated over the time of a flight.

use crate::taut::sea::chart::Chart;
use auv_planning::{Deadline, PathProblem};
use auv_types::{Point3, Vector3};

/// Nodes between two looks at the deadline.
const BETWEEN_LOOKS: usize = 500;
/// Times tabulated where the current changes.
const TIMES: usize = 13;
/// Span of the table, in times that the leg takes in still water.
const SPAN: f64 = 2.5;
/// Places and changes by which a current is judged steady: m/s.
const PROBES: usize = 9;
const STEADY_MPS: f64 = 1e-6;

/// Velocities by time and node. Between times they are linear, beyond them constant.
#[derive(Clone, Debug)]
pub(crate) struct Tide {
    begin_s: f64,
    step_s: f64,
    nodes: usize,
    velocities_mps: Vec<Vector3<f32>>,
    most_mps: f64,
}

impl Tide {
    /// The current at the nodes of a lattice from a departure on. `None` when the deadline passes first.
    pub(crate) fn new(
        problem: &PathProblem<'_>,
        chart: &Chart<'_>,
        departure_s: f64,
        deadline: Deadline<'_>,
    ) -> Option<Self> {
        let nodes = chart.nodes();
        let line_m = (problem.target - problem.start).norm();
        let step_s = SPAN * line_m / problem.vehicle.speed_mps / (TIMES - 1) as f64;
        let mut table = Self {
            begin_s: departure_s,
            step_s,
            nodes,
            velocities_mps: Vec::new(),
            most_mps: 0.0,
        };
        let Some(field) = problem.current else {
            return Some(table);
        };
        table.most_mps = field.max_speed_mps();
        let times = if is_steady(problem, departure_s, step_s) {
            1
        } else {
            TIMES
        };
        for k in 0..times {
            let time_s = departure_s + step_s * k as f64;
            let at = |place: Point3<f64>| field.velocity_at(&place, time_s).cast::<f32>();
            for node in 0..nodes {
                if node % BETWEEN_LOOKS == 0 && deadline.passed() {
                    return None;
                }
                let velocity = chart.place(node).map_or_else(Vector3::zeros, at);
                table.velocities_mps.push(velocity);
            }
        }
        Some(table)
    }

    /// The greatest speed of the water anywhere, m/s.
    pub(crate) fn most_mps(&self) -> f64 {
        self.most_mps
    }

    /// Entries of the table.
    pub(crate) fn len(&self) -> usize {
        self.velocities_mps.len()
    }

    /// The velocity at a node at a time.
    pub(crate) fn at(&self, node: usize, time_s: f64) -> Vector3<f64> {
        let last = (self.velocities_mps.len() / self.nodes).saturating_sub(1);
        let at = ((time_s - self.begin_s) / self.step_s).clamp(0.0, last as f64);
        let (early, share) = (at as usize, at.fract());
        let velocity = |k: usize| self.velocities_mps[k * self.nodes + node].cast::<f64>();
        if share > 0.0 {
            velocity(early) * (1.0 - share) + velocity(early + 1) * share
        } else {
            velocity(early)
        }
    }
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
    use crate::taut::sea::chart::Extent;
    use auv_ocean::{AnalyticCurrent, CurrentField, TidalConstituent};
    use auv_planning::{Budget, Run, Vehicle};
    use auv_types::Seed;

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
        for (field, times) in [(&tidal, TIMES), (&steady, 1)] {
            let problem = PathProblem {
                current: Some(field),
                ..PathProblem::new(
                    Point3::new(0.0, 0.0, 20.0),
                    Point3::new(9e3, 0.0, 20.0),
                    &vehicle,
                )
            };
            let run = Run::new(Seed(0), Budget::to_the_cap());
            let chart = Chart::new(&problem, problem.start, 8, Extent::Level, run.deadline());
            let chart = chart.unwrap();
            let tide = Tide::new(&problem, &chart, 0.0, run.deadline()).unwrap();
            assert_eq!(tide.len(), times * chart.nodes());
            for time_s in [0.0, 1_000.0, 5_300.0, 7_000.0] {
                let exact = field.velocity_at(&problem.start, time_s);
                assert!((tide.at(chart.start_node(), time_s) - exact).norm() < 0.01);
            }
        }
    }
}
