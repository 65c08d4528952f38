//! Points and lengths of fixed curves, compared with committed files.

#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_bspline::{BSpline, Basis};
use auv_types::{Point3, libm};
use serde_json::{Value, json};

/// A winding curve of `count` control points.
fn winding(order: usize, count: usize) -> BSpline {
    let control = (0..count).map(|i| {
        let t = i as f64;
        Point3::new(
            120.0 * t,
            80.0 * libm::sin(1.7 * t),
            40.0 + 15.0 * libm::cos(0.9 * t),
        )
    });
    BSpline::new(order, control.collect()).unwrap()
}

fn summary(curve: &BSpline) -> Value {
    let at = |share: f64| share * curve.parameter_end();
    let sampled: Vec<_> = [0.0, 0.13, 0.5, 0.77, 1.0]
        .iter()
        .map(|&share| {
            let point = curve.point_at(at(share));
            json!([point.x, point.y, point.z])
        })
        .collect();
    let (first, second) = (
        curve.first_derivative_at(at(0.31)),
        curve.second_derivative_at(at(0.31)),
    );
    let polyline = curve.polyline(0.05).unwrap();
    let inner = polyline[polyline.len() / 3];
    json!({
        "points": sampled,
        "first_derivative": [first.x, first.y, first.z],
        "second_derivative": [second.x, second.y, second.z],
        "curvature": curve.curvature_at(at(0.31)),
        "length": curve.arc_length_m(1e-6),
        "polyline": polyline.len(),
        "polyline_third": [inner.x, inner.y, inner.z],
    })
}

#[test]
fn curves_are_as_committed() {
    let curves: Vec<_> = [(2, 5), (3, 6), (4, 8), (5, 9), (7, 7)]
        .iter()
        .map(|&(order, count)| summary(&winding(order, count)))
        .collect();
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), "curves", &curves.into()).unwrap();
}

#[test]
fn basis_tables_are_as_committed() {
    let tables: Vec<_> = [(8, 4, 0), (8, 4, 1), (6, 3, 0), (9, 5, 2)]
        .iter()
        .map(|&(count, order, derivative)| {
            let basis = Basis::of_derivative(count, order, 11, derivative).unwrap();
            let rows: Vec<_> = (0..3).map(|k| basis.row(4 * k).to_vec()).collect();
            json!({ "first": basis.first(5), "rows": rows })
        })
        .collect();
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), "basis", &tables.into()).unwrap();
}
