//! Arc length: the exact length that Eq. 16 approximates by a polygon.

use crate::BSpline;

/// Nodes and weights of the 8-point Gauss-Legendre rule on [-1, 1], the positive half.
const RULE: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_27),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Most halvings of a piece. Only a cusp needs more than a few.
const MAX_HALVINGS: u32 = 40;

impl BSpline {
    /// The length of the curve in metres, accurate to about `accuracy_m` or to 1e-12 of the control
    /// polygon's length, whichever is larger.
    ///
    /// Adaptive quadrature: each polynomial piece is halved until the halves agree with the whole.
    #[must_use]
    pub fn arc_length_m(&self, accuracy_m: f64) -> f64 {
        let polygon_m: f64 = self
            .control_points()
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm())
            .sum();
        let pieces = self.knots().num_spans();
        let accuracy_m = accuracy_m.max(1e-12 * polygon_m) / pieces as f64;
        (0..pieces)
            .map(|piece| {
                let (from, to) = (piece as f64, (piece + 1) as f64);
                let whole_m = self.quadrature(from, to);
                self.refined(from, to, whole_m, accuracy_m, MAX_HALVINGS)
            })
            .sum()
    }

    fn refined(&self, from: f64, to: f64, whole_m: f64, accuracy_m: f64, halvings: u32) -> f64 {
        let middle = 0.5 * (from + to);
        let (first_m, second_m) = (self.quadrature(from, middle), self.quadrature(middle, to));
        let both_m = first_m + second_m;
        if (both_m - whole_m).abs() <= accuracy_m || halvings == 0 {
            return both_m;
        }
        let half_m = 0.5 * accuracy_m;
        self.refined(from, middle, first_m, half_m, halvings - 1)
            + self.refined(middle, to, second_m, half_m, halvings - 1)
    }

    /// The integral of the speed within one piece.
    fn quadrature(&self, from: f64, to: f64) -> f64 {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let speed = |u: f64| self.first_derivative_at(u).norm();
        RULE.iter()
            .map(|&(node, weight)| {
                weight * half * (speed(middle - half * node) + speed(middle + half * node))
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::{Point3, libm};

    #[test]
    fn length_of_a_parabola_is_exact() {
        // (0,0), (1,0), (2,4): x = 2u, y = 4u^2, so y = x^2 from 0 to 2.
        let control = [(0.0, 0.0), (1.0, 0.0), (2.0, 4.0)].map(|(x, y)| Point3::new(x, y, 7.0));
        let curve = BSpline::new(3, control.to_vec()).unwrap();
        let root = 17.0_f64.sqrt();
        let exact_m = root + 0.25 * libm::log(4.0 + root);
        assert!((curve.arc_length_m(1e-9) - exact_m).abs() < 1e-9);
    }

    #[test]
    fn goes_there_and_back_through_a_cusp() {
        let control = [0.0, 1.0, 0.0].map(|x| Point3::new(x, 0.0, 0.0));
        let curve = BSpline::new(3, control.to_vec()).unwrap();
        assert!((curve.arc_length_m(1e-9) - 1.0).abs() < 1e-8);
        let still = BSpline::new(3, vec![Point3::origin(); 4]).unwrap();
        assert_eq!(still.arc_length_m(0.0), 0.0);
    }
}
