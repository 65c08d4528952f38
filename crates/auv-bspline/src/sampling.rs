//! Sampling: uniformly in the parameter, or as sparsely as a chord error allows.

use crate::{BSpline, Basis};
use auv_types::{Point3, Vector3, Violations, libm};

/// How fast the parameter step may change along the curve. Neighbouring chords then differ by at most
/// a fifth of their length, so the turn radius at a vertex stays near the curve's.
const GRADING: f64 = 0.1;

/// Cells of one polynomial piece on which the second derivative is bounded.
const CELLS: usize = 16;

/// A step that changes by less than this per unit of the parameter is constant on its cell.
const CONSTANT: f64 = 1e-9;

impl BSpline {
    /// Most points that [`BSpline::polyline`] gives.
    pub const MAX_SAMPLES: usize = 1_000_000;

    /// The points at `count` parameters uniform over the domain, both ends included (at least 2).
    ///
    /// # Errors
    /// A count below 2.
    pub fn uniform_points(&self, count: usize) -> Result<Vec<Point3<f64>>, Violations> {
        let basis = Basis::new(self.control_points().len(), self.order(), count)?;
        let points = basis.rows().map(|(first, row)| {
            let active = row.iter().zip(&self.control_points()[first..]);
            Point3::from(active.map(|(&w, p)| p.coords * w).sum::<Vector3<f64>>())
        });
        Ok(points.collect())
    }

    /// Points on the curve, both ends included. No point of the curve is farther than `chord_error_m`
    /// from the chord of its two neighbours. The points are dense where the curve bends, sparse where
    /// it is straight, and the steps change gradually.
    ///
    /// # Errors
    /// As [`BSpline::polyline_parameters`].
    pub fn polyline(&self, chord_error_m: f64) -> Result<Vec<Point3<f64>>, Violations> {
        let parameters = self.polyline_parameters(chord_error_m)?;
        Ok(parameters.into_iter().map(|u| self.point_at(u)).collect())
    }

    /// The parameters of [`BSpline::polyline`], ascending.
    ///
    /// A chord over a parameter step `h` lies within `h^2 / 8` times the greatest second derivative of
    /// the curve. That bounds the step on each cell of a piece. The bounds are reduced until the step
    /// varies slowly along the curve, and the domain is divided into equal shares of that step.
    ///
    /// # Errors
    /// A chord error that is not positive, or so small that the polyline would need more than
    /// [`BSpline::MAX_SAMPLES`] points.
    pub fn polyline_parameters(&self, chord_error_m: f64) -> Result<Vec<f64>, Violations> {
        let mut violations = Violations::new();
        violations.require_positive(chord_error_m, "chord_error_m");
        violations.into_result()?;
        if self.order() == 2 {
            return Ok((0..self.control_points().len()).map(|i| i as f64).collect());
        }
        let cell = 1.0 / CELLS as f64;
        let steps = self.graded_steps(chord_error_m, cell);
        let mut shares = vec![0.0];
        let mut total = 0.0;
        for pair in steps.windows(2) {
            let change = (pair[1] - pair[0]) / cell;
            total += if change.abs() > CONSTANT {
                libm::log(pair[1] / pair[0]) / change
            } else {
                2.0 * cell / (pair[0] + pair[1])
            };
            shares.push(total);
        }
        // A step of one share is at most (e^GRADING - 1) / GRADING as long as its shortest graded
        // step. Dividing finer by about that factor keeps the error.
        let count = libm::ceil(total * GRADING / libm::log1p(GRADING)).max(1.0);
        let mut violations = Violations::new();
        violations.require(count < Self::MAX_SAMPLES as f64, "chord_error_m", || {
            format!(
                "is {chord_error_m}, which needs {count} points; give one that needs at most {}",
                Self::MAX_SAMPLES
            )
        });
        violations.into_result()?;
        let mut parameters = vec![0.0];
        let mut at = 0;
        for k in 1..count as usize {
            let share = total * k as f64 / count;
            while shares[at + 1] < share {
                at += 1;
            }
            let change = (steps[at + 1] - steps[at]) / cell;
            let into = share - shares[at];
            let within = if change.abs() > CONSTANT {
                steps[at] * libm::expm1(change * into) / change
            } else {
                into * cell / (shares[at + 1] - shares[at])
            };
            parameters.push(at as f64 * cell + within.min(cell));
        }
        parameters.push(self.parameter_end());
        Ok(parameters)
    }

    /// The parameter step allowed at each cell boundary, changing by at most `GRADING` per unit.
    fn graded_steps(&self, chord_error_m: f64, cell: f64) -> Vec<f64> {
        let pieces = self.knots().num_spans();
        let longest = pieces as f64;
        let jerks = self.third_derivative_bounds();
        let mut steps = vec![longest; pieces * CELLS + 1];
        for i in 0..pieces * CELLS {
            let middle = (i as f64 + 0.5) * cell;
            let bound = self.second_derivative_at(middle).norm() + 0.5 * cell * jerks[i / CELLS];
            let step = libm::sqrt(8.0 * chord_error_m / bound.max(f64::MIN_POSITIVE));
            steps[i] = steps[i].min(step);
            steps[i + 1] = steps[i + 1].min(step);
        }
        for i in 1..steps.len() {
            steps[i] = steps[i].min(steps[i - 1] + GRADING * cell);
        }
        for i in (1..steps.len()).rev() {
            steps[i - 1] = steps[i - 1].min(steps[i] + GRADING * cell);
        }
        steps
    }

    /// An upper bound of the third derivative's norm on each piece: the greatest norm among its control
    /// points.
    fn third_derivative_bounds(&self) -> Vec<f64> {
        let mut knots = self.knots();
        let pieces = knots.num_spans();
        if self.order() < 4 {
            return vec![0.0; pieces];
        }
        let mut control: Vec<_> = self.control_points().iter().map(|p| p.coords).collect();
        for _ in 0..3 {
            control = (1..control.len())
                .map(|i| (control[i] - control[i - 1]) * knots.derivative_factor(i - 1))
                .collect();
            knots = knots.of_derivative();
        }
        let norms: Vec<f64> = control.iter().map(Vector3::norm).collect();
        (0..pieces)
            .map(|piece| {
                norms[piece..piece + knots.order]
                    .iter()
                    .copied()
                    .fold(0.0, f64::max)
            })
            .collect()
    }
}
