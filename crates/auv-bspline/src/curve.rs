//! The curve.

use crate::basis::check;
use crate::knots::Knots;
use auv_types::{Point3, Vector3, Violations};

/// A clamped uniform B-spline curve of order K (degree K - 1) over N control points (Eq. 11).
///
/// Its knots are `0` (K times), `1, 2, .. N - K`, `N - K + 1` (K times); its domain is
/// `[0, N - K + 1]`. It starts at the first control point, ends at the last, and is K - 2 times
/// continuously differentiable. Each point lies in the convex hull of K neighbouring control points.
/// Coordinates are in metres.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "UncheckedCurve")
)]
pub struct BSpline {
    order: usize,
    control_points: Vec<Point3<f64>>,
}

/// The curve of a file, before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct UncheckedCurve {
    order: usize,
    control_points: Vec<Point3<f64>>,
}

#[cfg(feature = "serde")]
impl TryFrom<UncheckedCurve> for BSpline {
    type Error = Violations;

    fn try_from(unchecked: UncheckedCurve) -> Result<Self, Violations> {
        Self::new(unchecked.order, unchecked.control_points)
    }
}

impl BSpline {
    /// A curve of the given order (4: cubic) over control points in metres.
    ///
    /// # Errors
    /// An order below 2, fewer control points than the order, or a coordinate that is not finite or
    /// beyond 1e9 m. All of them are listed.
    pub fn new(order: usize, control_points: Vec<Point3<f64>>) -> Result<Self, Violations> {
        let mut violations = check(control_points.len(), order);
        for (i, point) in control_points.iter().enumerate() {
            // NaN fails the comparison.
            violations.require(
                point.iter().all(|x| x.abs() <= 1e9),
                &format!("control_points[{i}]"),
                || {
                    format!(
                        "is ({}, {}, {}); give finite metres within 1e9",
                        point.x, point.y, point.z
                    )
                },
            );
        }
        violations.into_result()?;
        Ok(Self {
            order,
            control_points,
        })
    }

    /// The order K; the degree is one less.
    #[must_use]
    pub fn order(&self) -> usize {
        self.order
    }

    /// The control points, metres.
    #[must_use]
    pub fn control_points(&self) -> &[Point3<f64>] {
        &self.control_points
    }

    /// The end of the domain `[0, N - K + 1]`; also the number of polynomial pieces.
    #[must_use]
    pub fn parameter_end(&self) -> f64 {
        self.knots().num_spans() as f64
    }

    /// The point at a parameter, metres. A parameter outside the domain gives the nearer end, NaN the
    /// start.
    #[must_use]
    pub fn point_at(&self, u: f64) -> Point3<f64> {
        Point3::from(self.combined(0, u))
    }

    /// The first derivative with respect to the parameter, metres. At a knot of a curve of order 2 it
    /// is that of the piece that starts there.
    #[must_use]
    pub fn first_derivative_at(&self, u: f64) -> Vector3<f64> {
        self.combined(1, u)
    }

    /// The second derivative with respect to the parameter, metres (zero for order 2). At a knot of a
    /// curve of order 3 it is that of the piece that starts there.
    #[must_use]
    pub fn second_derivative_at(&self, u: f64) -> Vector3<f64> {
        self.combined(2, u)
    }

    /// The curvature, 1/m: one over the turn radius. It is `+inf` where the first derivative vanishes,
    /// because the curve may have a cusp there.
    #[must_use]
    pub fn curvature_at(&self, u: f64) -> f64 {
        let along = self.first_derivative_at(u);
        let speed = along.norm();
        let square = speed * speed;
        if square > 0.0 {
            (along / speed).cross(&self.second_derivative_at(u)).norm() / square
        } else {
            f64::INFINITY
        }
    }

    pub(crate) fn knots(&self) -> Knots {
        Knots {
            num_control_points: self.control_points.len(),
            order: self.order,
        }
    }

    fn combined(&self, derivative: usize, u: f64) -> Vector3<f64> {
        let mut stack = [0.0; 16];
        match stack.get_mut(..self.order) {
            Some(weights) => self.combined_with(weights, derivative, u),
            None => self.combined_with(&mut vec![0.0; self.order], derivative, u),
        }
    }

    fn combined_with(&self, weights: &mut [f64], derivative: usize, u: f64) -> Vector3<f64> {
        let first = self.knots().weights(derivative, u, weights);
        let active = &self.control_points[first..first + self.order];
        weights
            .iter()
            .zip(active)
            .map(|(&weight, point)| point.coords * weight)
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_every_wrong_control_point() {
        let points = [0.0, f64::NAN, f64::INFINITY, 2e9].map(|x| Point3::new(x, 0.0, 0.0));
        let error = BSpline::new(5, points.to_vec()).unwrap_err();
        assert_eq!(error.total(), 4);
        assert!(error.to_string().contains("control_points[1]"));
    }

    #[test]
    fn curvature_of_a_straight_curve_vanishes_and_of_a_point_infinite() {
        let line = (0..6)
            .map(|i| Point3::new(f64::from(i), 0.0, 1.0))
            .collect();
        assert!(BSpline::new(4, line).unwrap().curvature_at(1.3) < 1e-15);
        let point = BSpline::new(3, vec![Point3::origin(); 3]).unwrap();
        assert!(point.curvature_at(0.5).is_infinite());
    }

    #[test]
    fn outside_the_domain_it_stays_at_its_ends() {
        let points: Vec<_> = (0..5)
            .map(|i| Point3::new(f64::from(i * i), 1.0, 2.0))
            .collect();
        let curve = BSpline::new(3, points.clone()).unwrap();
        assert_eq!(curve.point_at(-4.0), points[0]);
        assert_eq!(curve.point_at(f64::NAN), points[0]);
        assert_eq!(curve.point_at(f64::INFINITY), points[4]);
        assert_eq!(curve.parameter_end(), 3.0);
    }
}
