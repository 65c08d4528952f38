//! Clamped uniform B-spline curves of any order in three dimensions (Eq. 11).
//!
//! [`BSpline`] is one curve: points, derivatives, curvature, length, and a polyline within a chord
//! error. [`Basis`] is a table that turns control points into samples by multiplication alone, for a
//! whole population of curves.
//!
//! # Units and determinism
//! Coordinates are in metres; the parameter has no unit. Equal input gives equal bits on every
//! machine: transcendental functions come from `libm`, and sums have a fixed order.
//!
//! ```
//! use auv_bspline::{BSpline, Basis};
//! use auv_types::Point3;
//!
//! let control = [(0.0, 0.0), (200.0, 150.0), (600.0, -150.0), (900.0, 0.0), (1000.0, 0.0)];
//! let control: Vec<_> = control.iter().map(|&(x, y)| Point3::new(x, y, 20.0)).collect();
//! let curve = BSpline::new(4, control.clone())?;
//! assert_eq!(curve.point_at(curve.parameter_end()), control[4]);
//! let polyline = curve.polyline(0.01)?;
//! let chords_m: f64 = polyline.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
//! assert!((curve.arc_length_m(1e-6) - chords_m).abs() < 0.05);
//!
//! // The same curve at 100 parameters, from a table computed once.
//! let basis = Basis::new(5, 4, 100)?;
//! let north_m: Vec<_> = control.iter().map(|p| p.x).collect();
//! let mut samples_m = [0.0; 100];
//! basis.apply(&north_m, &mut samples_m);
//! assert!((samples_m[33] - curve.point_at(2.0 * 33.0 / 99.0).x).abs() < 1e-9);
//! # Ok::<(), auv_types::Violations>(())
//! ```
//!
//! # Features
//!
//! None is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `serde` | curves can be written and read |

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod basis;
mod curve;
mod knots;
mod length;
mod sampling;

pub use basis::Basis;
pub use curve::BSpline;
