//! The knot vector and the basis functions over it (Eq. 11).

/// A clamped uniform knot vector in closed form: `0` (index < K), `index - K + 1`, `N - K + 1`
/// (index >= N). No knot is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Knots {
    pub(crate) num_control_points: usize,
    pub(crate) order: usize,
}

impl Knots {
    /// Number of spans, which is also the end of the domain.
    pub(crate) fn num_spans(self) -> usize {
        self.num_control_points + 1 - self.order
    }

    fn knot(self, index: usize) -> f64 {
        (index + 1).saturating_sub(self.order).min(self.num_spans()) as f64
    }

    /// The parameter clamped to the domain (NaN becomes 0) and its span. Spans are half-open; the last
    /// is closed.
    pub(crate) fn locate(self, u: f64) -> (f64, usize) {
        let u = u.max(0.0).min(self.num_spans() as f64);
        (u, (u as usize).min(self.num_spans() - 1))
    }

    /// Knots of the derivative: one control point and one order less, the same spans.
    pub(crate) fn of_derivative(self) -> Self {
        Self {
            num_control_points: self.num_control_points - 1,
            order: self.order - 1,
        }
    }

    /// The factor of `P[i + 1] - P[i]` in the i-th control point of the derivative.
    pub(crate) fn derivative_factor(self, i: usize) -> f64 {
        (self.order - 1) as f64 / (self.knot(i + self.order) - self.knot(i + 1))
    }

    /// The K values at `u` that multiply control points `span` to `span + K - 1` to give the curve
    /// (`derivative` 0) or its derivative with respect to `u`; returns `span`.
    pub(crate) fn weights(self, derivative: usize, u: f64, values: &mut [f64]) -> usize {
        let (u, span) = self.locate(u);
        self.weights_in(span, derivative, u, values);
        span
    }

    fn weights_in(self, span: usize, derivative: usize, u: f64, values: &mut [f64]) {
        if derivative == 0 {
            return self.values_in(span, u, values);
        }
        values.fill(0.0);
        if self.order == 1 {
            return;
        }
        let last = self.order - 1;
        self.of_derivative()
            .weights_in(span, derivative - 1, u, &mut values[..last]);
        // From weights of Q[i] = factor (P[i + 1] - P[i]) to weights of P, last first.
        for j in (0..last).rev() {
            let weight = values[j] * self.derivative_factor(span + j);
            values[j + 1] += weight;
            values[j] = -weight;
        }
    }

    /// Cox and de Boor's recursion, order by order, in place; every term is positive.
    fn values_in(self, span: usize, u: f64, values: &mut [f64]) {
        let at = span + self.order - 1;
        values[0] = 1.0;
        for degree in 1..self.order {
            let mut carried = 0.0;
            for (r, value) in values[..degree].iter_mut().enumerate() {
                let right = self.knot(at + r + 1) - u;
                let left = u - self.knot(at + 1 + r - degree);
                let share = *value / (right + left);
                *value = carried + right * share;
                carried = left * share;
            }
            values[degree] = carried;
        }
    }
}
