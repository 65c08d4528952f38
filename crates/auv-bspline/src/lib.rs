//! Clamped uniform B-spline curves of any order in three dimensions (Eq. 11).

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

use auv_types::Point3;

/// A clamped uniform B-spline curve.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BSpline {
    order: usize,
    control_points: Vec<Point3<f64>>,
}
