//! The current at the nodes of a lattice, tabulated over time.

use super::lattice::Lattice;
use crate::Deadline;
use auv_ocean::CurrentField;
use auv_types::Vector3;

/// Entries between two looks at the deadline.
const BETWEEN_LOOKS: usize = 500;

/// Velocities by node and time. Between times they are linear, beyond them constant.
#[derive(Clone, Debug)]
pub struct Tide {
    begin_s: f64,
    step_s: f64,
    times: usize,
    last: f64,
    velocities_mps: Vec<Vector3<f32>>,
    most_mps: f64,
}

impl Tide {
    /// Still water.
    #[must_use]
    pub fn still() -> Self {
        Self {
            begin_s: 0.0,
            step_s: 1.0,
            times: 1,
            last: 0.0,
            velocities_mps: Vec::new(),
            most_mps: 0.0,
        }
    }

    /// The current at the nodes of a lattice at so many times (at least 1) from `begin_s` on, `step_s` apart.
    /// `None` when the deadline passes first.
    #[must_use]
    pub fn new(
        field: &dyn CurrentField,
        lattice: &Lattice,
        (begin_s, step_s, times): (f64, f64, usize),
        deadline: Deadline<'_>,
    ) -> Option<Self> {
        let nodes = lattice.nodes();
        let mut velocities_mps = Vec::with_capacity(times * nodes);
        for node in 0..nodes {
            if (node * times) % BETWEEN_LOOKS < times && deadline.passed() {
                return None;
            }
            let place = lattice.place(node);
            velocities_mps.extend((0..times).map(|k| {
                let time_s = begin_s + step_s * k as f64;
                place.map_or_else(Vector3::zeros, |place| {
                    field.velocity_at(&place, time_s).cast::<f32>()
                })
            }));
        }
        Some(Self {
            begin_s,
            step_s,
            times,
            last: times.saturating_sub(1) as f64,
            velocities_mps,
            most_mps: field.max_speed_mps(),
        })
    }

    /// Whether the water rests everywhere.
    #[must_use]
    pub fn is_still(&self) -> bool {
        self.velocities_mps.is_empty()
    }

    /// The greatest speed of the water anywhere, m/s.
    #[must_use]
    pub fn most_mps(&self) -> f64 {
        self.most_mps
    }

    /// Entries of the table.
    #[must_use]
    pub fn entries(&self) -> usize {
        self.velocities_mps.len()
    }

    /// The velocity at a node at a time, m/s.
    #[must_use]
    pub fn at(&self, node: usize, time_s: f64) -> Vector3<f64> {
        if self.is_still() {
            return Vector3::zeros();
        }
        let at = ((time_s - self.begin_s) / self.step_s).clamp(0.0, self.last);
        let (early, share) = (at as usize, at.fract());
        let first = node * self.times;
        let velocity = |k: usize| self.velocities_mps[first + k].cast::<f64>();
        if share > 0.0 {
            velocity(early) * (1.0 - share) + velocity(early + 1) * share
        } else {
            velocity(early)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::front::{Depths, Frame};
    use auv_ocean::{AnalyticCurrent, TidalConstituent};
    use auv_types::Point3;

    #[test]
    fn between_times_it_is_linear_and_beyond_constant() {
        let field = AnalyticCurrent {
            tide: vec![TidalConstituent::turning_at(9e3, [0.5, 0.1])],
            ..AnalyticCurrent::default()
        };
        let frame = Frame {
            anchor: Point3::new(0.0, 0.0, 20.0),
            anchor_node: [0, 0],
            ahead: Vector3::x(),
            side: Vector3::y(),
            cell_m: 100.0,
            counts: [3, 4],
        };
        let depths = Depths::ByRow(vec![20.0; 3]);
        let lattice = Lattice::new(&frame, &depths, None, None, Deadline::default()).unwrap();
        let tide = Tide::new(&field, &lattice, (0.0, 600.0, 13), Deadline::default()).unwrap();
        assert_eq!(tide.entries(), 13 * 12);
        let exact = |time_s: f64| field.velocity_at(&frame.anchor, time_s);
        for time_s in [0.0, 1_000.0, 5_300.0, 7_000.0] {
            assert!((tide.at(0, time_s) - exact(time_s)).norm() < 0.01);
        }
        assert!((tide.at(0, 9e9) - exact(7_200.0)).norm() < 1e-6);
        assert_eq!(Tide::still().at(3, 5.0), Vector3::zeros());
    }
}
