//! The basis functions at many parameters at once, as a matrix.

use crate::knots::Knots;
use auv_types::Violations;

/// The matrix that turns control points into samples of a curve. It is computed once for a number of
/// control points, an order, and samples at equal steps of the parameter.
///
/// Row `j` belongs to sample `j`. Only `order` neighbouring entries of a row differ from zero, and
/// only these are stored: entry `k` of [`Basis::row`] multiplies control point
/// [`Basis::first`]` + k`. One coordinate of a sample is a sum of `order` products. With the control
/// points of many curves side by side, the same products serve all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    knots: Knots,
    firsts: Vec<usize>,
    weights: Vec<f64>,
}

impl Basis {
    /// The basis at `samples` parameters, uniform over the domain `[0, N - K + 1]`, both ends
    /// included.
    ///
    /// # Errors
    /// An order below 2, fewer control points than the order, fewer than two samples.
    pub fn new(
        num_control_points: usize,
        order: usize,
        samples: usize,
    ) -> Result<Self, Violations> {
        Self::of_derivative(num_control_points, order, samples, 0)
    }

    /// As [`Basis::new`] for a derivative of the curve with respect to its parameter (0: the curve
    /// itself).
    ///
    /// # Errors
    /// As [`Basis::new`].
    pub fn of_derivative(
        num_control_points: usize,
        order: usize,
        samples: usize,
        derivative: usize,
    ) -> Result<Self, Violations> {
        let mut violations = check(num_control_points, order);
        violations.require(samples >= 2, "samples", || {
            format!("is {samples}; give at least 2")
        });
        violations.into_result()?;
        let knots = Knots {
            num_control_points,
            order,
        };
        let step = knots.num_spans() as f64 / (samples - 1) as f64;
        let mut weights = vec![0.0; samples * order];
        let firsts = weights
            .chunks_exact_mut(order)
            .enumerate()
            .map(|(j, row)| {
                let is_last = j + 1 == samples;
                let u = if is_last {
                    knots.num_spans() as f64
                } else {
                    j as f64 * step
                };
                knots.weights(derivative, u, row)
            })
            .collect();
        Ok(Self {
            knots,
            firsts,
            weights,
        })
    }

    /// Number of samples (rows).
    #[must_use]
    pub fn num_samples(&self) -> usize {
        self.firsts.len()
    }

    /// Number of control points (columns).
    #[must_use]
    pub fn num_control_points(&self) -> usize {
        self.knots.num_control_points
    }

    /// The order: entries stored in each row.
    #[must_use]
    pub fn order(&self) -> usize {
        self.knots.order
    }

    /// The control point that the first entry of a row multiplies.
    #[must_use]
    pub fn first(&self, sample: usize) -> usize {
        self.firsts[sample]
    }

    /// The `order` entries of a row, for control points [`Basis::first`] and following.
    #[must_use]
    pub fn row(&self, sample: usize) -> &[f64] {
        &self.weights[sample * self.order()..][..self.order()]
    }

    /// All rows in order, each with the control point that its first entry multiplies.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = (usize, &[f64])> + '_ {
        self.firsts
            .iter()
            .copied()
            .zip(self.weights.chunks_exact(self.order()))
    }

    /// The entries of all rows in single precision, row after row, `order` each.
    #[must_use]
    pub fn banded_f32(&self) -> Vec<f32> {
        self.weights.iter().map(|&w| w as f32).collect()
    }

    /// Computes one coordinate of all samples from the same coordinate of all control points:
    /// `samples[j] = sum of row[k] * control[first + k]`, summed in this order. If a slice is too
    /// short, only the samples that both slices reach are written.
    pub fn apply(&self, control: &[f64], samples: &mut [f64]) {
        for (sample, (first, row)) in samples.iter_mut().zip(self.rows()) {
            let Some(active) = control.get(first..first + row.len()) else {
                return;
            };
            *sample = row.iter().zip(active).map(|(w, x)| w * x).sum();
        }
    }
}

/// Everything wrong with a number of control points and an order.
pub(crate) fn check(num_control_points: usize, order: usize) -> Violations {
    let mut violations = Violations::new();
    violations.require(order >= 2, "order", || {
        format!("is {order}; give at least 2 (4: cubic)")
    });
    violations.require(num_control_points >= order, "control_points", || {
        format!("has {num_control_points} entries; a curve of order {order} needs at least {order}")
    });
    violations
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_apply_and_single_precision_agree() {
        let basis = Basis::new(8, 4, 101).unwrap();
        let control: Vec<f64> = (0..8).map(|i| f64::from(i * i) - 3.0).collect();
        let mut samples = vec![0.0; 101];
        basis.apply(&control, &mut samples);
        let single = basis.banded_f32();
        for (j, (first, row)) in basis.rows().enumerate() {
            let sum: f64 = (0..4).map(|k| row[k] * control[first + k]).sum();
            assert_eq!(sum, samples[j]);
            assert_eq!((basis.first(j), basis.row(j)), (first, row));
            assert!((0..4).all(|k| single[4 * j + k] == row[k] as f32));
        }
        assert_eq!((samples[0], samples[100]), (control[0], control[7]));
        assert_eq!(basis.num_samples(), 101);
    }

    #[test]
    fn names_all_that_is_wrong() {
        assert_eq!(Basis::new(1, 1, 1).unwrap_err().total(), 2);
        assert!(
            Basis::new(3, 4, 10)
                .unwrap_err()
                .to_string()
                .contains("control_points has 3")
        );
    }
}
