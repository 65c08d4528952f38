//! What a clamped uniform B-spline must satisfy, against the definition and another implementation.

#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_bspline::{BSpline, Basis};
use auv_types::nalgebra::{Matrix3, Rotation3};
use auv_types::{Point3, Vector3};
use proptest::prelude::*;

/// The knots as the definition lists them.
fn knots(n: usize, order: usize) -> Vec<f64> {
    (0..n + order)
        .map(|i| match i {
            _ if i < order => 0.0,
            _ if i < n => (i - order + 1) as f64,
            _ => (n - order + 1) as f64,
        })
        .collect()
}

/// The i-th basis function by the recursion of the definition, 0/0 read as 0.
fn cox_de_boor(t: &[f64], i: usize, order: usize, n: usize, u: f64) -> f64 {
    if order == 1 {
        let last = u >= t[t.len() - 1] && i + 1 == n;
        return f64::from(u8::from((t[i] <= u && u < t[i + 1]) || last));
    }
    let ratio = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
    let left = ratio(u - t[i], t[i + order - 1] - t[i]);
    let right = ratio(t[i + order] - u, t[i + order] - t[i + 1]);
    left * cox_de_boor(t, i, order - 1, n, u) + right * cox_de_boor(t, i + 1, order - 1, n, u)
}

fn by_definition(control: &[Point3<f64>], order: usize, u: f64) -> Vector3<f64> {
    let t = knots(control.len(), order);
    (0..control.len())
        .map(|i| control[i].coords * cox_de_boor(&t, i, order, control.len(), u))
        .sum()
}

/// Distance from a point to a segment.
fn to_chord(p: Point3<f64>, a: Point3<f64>, b: Point3<f64>) -> f64 {
    let chord = b - a;
    let along = ((p - a).dot(&chord) / chord.norm_squared().max(1e-300)).clamp(0.0, 1.0);
    (p - a - chord * along).norm()
}

prop_compose! {
    fn curves()(order in 2_usize..7, extra in 0_usize..7)
        (points in prop::collection::vec([-500.0..500.0, -500.0..500.0, 0.0..100.0_f64], order + extra),
         order in Just(order)) -> BSpline
    {
        BSpline::new(order, points.into_iter().map(Point3::from).collect()).unwrap()
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn points_follow_the_definition(curve in curves(), share in 0.0..=1.0_f64) {
        let u = share * curve.parameter_end();
        let expected = by_definition(curve.control_points(), curve.order(), u);
        prop_assert!((curve.point_at(u).coords - expected).norm() < 1e-9);
    }

    #[test]
    fn points_equal_those_of_another_implementation(curve in curves(), share in 0.0..0.999_f64) {
        let u = share * curve.parameter_end();
        let t = knots(curve.control_points().len(), curve.order());
        for axis in 0..3 {
            let control = curve.control_points().iter().map(|p| p[axis]).collect();
            let other = bspline::BSpline::new(curve.order() - 1, control, t.clone());
            prop_assert!((other.point(u) - curve.point_at(u)[axis]).abs() < 1e-9);
        }
    }

    #[test]
    fn weights_are_a_partition_of_unity(n in 2_usize..20, order in 2_usize..20, samples in 2_usize..50) {
        prop_assume!(n >= order);
        for (first, row) in Basis::new(n, order, samples).unwrap().rows() {
            prop_assert!(row.iter().all(|&w| w >= 0.0) && first + order <= n);
            prop_assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn ends_are_the_end_control_points(curve in curves()) {
        let control = curve.control_points();
        prop_assert_eq!(curve.point_at(0.0), control[0]);
        prop_assert_eq!(curve.point_at(curve.parameter_end()), control[control.len() - 1]);
    }

    #[test]
    fn points_stay_in_the_hull(curve in curves(), share in 0.0..=1.0_f64, direction in [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64]) {
        // Seen along any direction, a point lies between the control points of its piece.
        let u = share * curve.parameter_end();
        let first = (u as usize).min(curve.control_points().len() - curve.order());
        let seen = |p: &Point3<f64>| p.coords.dot(&Vector3::from(direction));
        let active = curve.control_points()[first..first + curve.order()].iter().map(seen);
        let (low, high) = active.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        let here = seen(&curve.point_at(u));
        prop_assert!(low - 1e-9 <= here && here <= high + 1e-9);
    }

    #[test]
    fn derivatives_match_finite_differences(curve in curves(), share in 0.01..0.99_f64) {
        let (u, h) = (share * curve.parameter_end(), 1e-4);
        prop_assume!((u - u.round()).abs() > 2.0 * h);
        let [before, here, after] = [u - h, u, u + h].map(|u| curve.point_at(u).coords);
        let first = (after - before) / (2.0 * h);
        let second = (after - here * 2.0 + before) / (h * h);
        let scale = curve.second_derivative_at(u).norm() + curve.first_derivative_at(u).norm() + 1.0;
        prop_assert!((curve.first_derivative_at(u) - first).norm() < 1e-3 * scale);
        prop_assert!((curve.second_derivative_at(u) - second).norm() < 2e-3 * scale + 0.1);
    }

    #[test]
    fn derivative_tables_give_the_derivatives(curve in curves()) {
        for derivative in 1..3 {
            let basis = Basis::of_derivative(curve.control_points().len(), curve.order(), 17, derivative).unwrap();
            for (j, (first, row)) in basis.rows().enumerate() {
                let u = curve.parameter_end() * j as f64 / 16.0;
                let sum: Vector3<f64> = row.iter().zip(&curve.control_points()[first..]).map(|(&w, p)| p.coords * w).sum();
                let expected = if derivative == 1 { curve.first_derivative_at(u) } else { curve.second_derivative_at(u) };
                // A sample may fall on either side of a knot by rounding.
                prop_assume!(curve.order() > derivative + 1 || (u - u.round()).abs() > 1e-9);
                prop_assert!((sum - expected).norm() < 1e-6);
            }
        }
    }

    #[test]
    fn moves_with_its_control_points(curve in curves(), share in 0.0..=1.0_f64, angles in [-3.0..3.0, -3.0..3.0, -3.0..3.0_f64], stretch in 0.1..3.0_f64) {
        let rotation = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let matrix = rotation.matrix() * Matrix3::from_diagonal(&Vector3::new(stretch, 1.0, 1.0 / stretch));
        let shift = Vector3::new(10.0, -70.0, 5.0);
        let map = |p: &Point3<f64>| Point3::from(matrix * p.coords + shift);
        let moved = BSpline::new(curve.order(), curve.control_points().iter().map(map).collect()).unwrap();
        let u = share * curve.parameter_end();
        prop_assert!((moved.point_at(u) - map(&curve.point_at(u))).norm() < 1e-8);
    }

    #[test]
    fn length_is_that_of_a_fine_polyline(curve in curves()) {
        let pieces = 4_000;
        let points = curve.uniform_points(pieces * curve.parameter_end() as usize + 1).unwrap();
        let fine_m: f64 = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let length_m = curve.arc_length_m(1e-6);
        prop_assert!(length_m >= fine_m - 2e-6 && length_m - fine_m < 1e-5 * fine_m + 1e-3, "{} {}", length_m, fine_m);
    }

    #[test]
    fn chords_stay_within_the_error_and_change_gradually(curve in curves(), error_m in prop::sample::select(vec![0.01, 0.5, 5.0])) {
        let parameters = curve.polyline_parameters(error_m).unwrap();
        prop_assert_eq!((parameters[0], parameters[parameters.len() - 1]), (0.0, curve.parameter_end()));
        for pair in parameters.windows(2) {
            prop_assert!(pair[0] < pair[1]);
            let (a, b) = (curve.point_at(pair[0]), curve.point_at(pair[1]));
            for k in 1..10 {
                let p = curve.point_at(pair[0] + (pair[1] - pair[0]) * f64::from(k) / 10.0);
                prop_assert!(to_chord(p, a, b) <= error_m * (1.0 + 1e-9) + 1e-12);
            }
        }
        for triple in parameters.windows(3).filter(|_| curve.order() > 2) {
            let ratio = (triple[1] - triple[0]) / (triple[2] - triple[1]);
            prop_assert!((0.8..1.25).contains(&ratio), "{}", ratio);
        }
    }
}

#[test]
fn a_local_detour_takes_far_fewer_points_than_uniform_sampling() {
    let point = |i: i32| {
        let aside_m = if i == 10 { 200.0 } else { 0.0 };
        Point3::new(f64::from(i) * 100.0, aside_m, 10.0)
    };
    let detour = BSpline::new(4, (0..20).map(point).collect()).unwrap();
    let parameters = detour.polyline_parameters(0.01).unwrap();
    let finest = parameters.windows(2).map(|pair| pair[1] - pair[0]);
    let uniform = detour.parameter_end() / finest.fold(f64::INFINITY, f64::min);
    assert!(
        uniform > 2.5 * parameters.len() as f64,
        "{uniform} {}",
        parameters.len()
    );
}

#[test]
fn sampling_asks_for_a_possible_error() {
    let bent = (0..8).map(|i| Point3::new(f64::from(i * i) * 100.0, f64::from(i % 3) * 90.0, 10.0));
    let bent = BSpline::new(4, bent.collect()).unwrap();
    for error_m in [0.0, -1.0, f64::NAN, 1e-12] {
        assert!(bent.polyline(error_m).is_err());
    }
    assert!(bent.uniform_points(1).is_err());
    let polygon = BSpline::new(2, bent.control_points().to_vec()).unwrap();
    assert_eq!(polygon.polyline(0.01).unwrap(), bent.control_points());
}

#[test]
fn any_order_works() {
    let points: Vec<_> = (0..40)
        .map(|i| Point3::new(f64::from(i), f64::from(i % 5), 3.0))
        .collect();
    let bezier = BSpline::new(40, points.clone()).unwrap();
    assert_eq!(bezier.point_at(1.0), points[39]);
    assert!(bezier.arc_length_m(1e-6) > 39.0 && bezier.polyline(0.01).is_ok());
}

#[cfg(feature = "serde")]
#[test]
fn a_file_is_checked_as_a_call_is() {
    let curve = BSpline::new(
        3,
        vec![
            Point3::origin(),
            Point3::new(1.0, 0.1, 0.0),
            Point3::new(2.0, 0.0, 0.3),
        ],
    )
    .unwrap();
    let text = serde_json::to_string(&curve).unwrap();
    assert_eq!(serde_json::from_str::<BSpline>(&text).unwrap(), curve);
    assert!(serde_json::from_str::<BSpline>(&text.replace("\"order\":3", "\"order\":4")).is_err());
}
