//! The scans of a sonar.

use auv_types::{Point3, Vector3};

/// One echo: a measured position and radius. It has no identity and no class.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Detection {
    /// Measured centre, metres (NED).
    pub position: Point3<f64>,
    /// Measured velocity over ground in m/s; `None` from a sonar that measures none.
    pub velocity: Option<Vector3<f64>>,
    /// Measured radius, metres.
    pub radius_m: f64,
    /// Standard deviation of the position on each axis, metres.
    pub position_sigma_m: f64,
    /// Standard deviation of the velocity on each axis, m/s (unused without a velocity).
    pub velocity_sigma_mps: f64,
    /// Standard deviation of the radius, metres.
    pub radius_sigma_m: f64,
}

/// One sweep of the sonar.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Scan {
    /// Mission time of the sweep, seconds.
    pub time_s: f64,
    /// Position of the sonar, metres (NED).
    pub from: Point3<f64>,
    /// Heading of the sonar, clockwise from north in radians.
    pub heading_rad: f64,
    /// A noisy measure of the sweep, such as the mean level of its raw data. Noise never repeats it bit for
    /// bit, so a repeated value reveals a frozen sonar even in an empty sea. `None`: not measured.
    #[cfg_attr(feature = "serde", serde(default))]
    pub background: Option<f64>,
    /// The echoes, in no particular order.
    pub detections: Vec<Detection>,
}
