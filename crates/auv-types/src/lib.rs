//! What every crate of the workspace shares: reproducible random streams ([`Seed`]), points and
//! vectors of one local frame, an axis-aligned [`Bounds`] box, and [`Violations`], the list of
//! everything wrong with an input.
//!
//! A `violation` (lower case, in planners and plans) is something else: a number that tells how far
//! a plan is from feasible.
//!
//! # Frame and units
//! One local frame, NED: `x` north, `y` east, `z` down (depth below the surface), metres,
//! right-handed. SI units and radians throughout; names of plain floats end in their unit.
//!
//! ```
//! use auv_types::{Bounds, Point3, Seed};
//! use auv_types::rand::RngExt;
//!
//! let inside = Bounds::new(Point3::origin(), Point3::new(10_000.0, 10_000.0, 1_000.0));
//! let mut random = Seed(7).stream(3);
//! let north_m = random.random_range(0.0..10_000.0);
//! assert!(inside.contains(&Point3::new(north_m, 0.0, 50.0)));
//! ```
//!
//! # Features
//!
//! None is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `serde` | points, seeds and violations can be written and read |

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod bounds;
mod civil;
mod seed;
mod violations;

pub use bounds::Bounds;
pub use civil::days_since_1970;
pub use libm;
pub use nalgebra;
pub use nalgebra::{Point3, Vector3};
pub use rand;
pub use rand_chacha::ChaCha8Rng;
pub use seed::Seed;
pub use violations::{Violation, Violations};
