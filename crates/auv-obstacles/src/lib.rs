//! Obstacles as planners see them: predicted [`Region`]s, each a ball or a vertical cylinder that
//! moves and grows linearly over a stated time span, with its clearance to a timed segment in
//! closed form.
//!
//! ```
//! use auv_obstacles::{Region, TimedPoint};
//! use auv_types::{Point3, Vector3};
//!
//! let rock = Region::ball(Point3::new(50.0, 10.0, 0.0), 4.0);
//! let from = TimedPoint::new(Point3::origin(), 0.0);
//! let to = TimedPoint::new(Point3::new(100.0, 0.0, 0.0), 50.0);
//! let closest = rock.clearance(&from, &to);
//! assert!((closest.clearance_m - 6.0).abs() < 1e-9 && (closest.time_s - 25.0).abs() < 1e-6);
//! ```

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod region;

pub use region::{Closest, ObstacleId, Region, Shape, TimedPoint};
