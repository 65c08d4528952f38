//! What a sonar reports.

use auv_types::{Point3, Vector3};

/// One echo: where something is and how large it looks. It carries no identity and no class.
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

/// Everything one sweep of the sonar reports.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Scan {
    /// When the sweep was taken, mission time in seconds.
    pub time_s: f64,
    /// Where the sonar was, metres (NED).
    pub from: Point3<f64>,
    /// Where it pointed, clockwise from north in radians.
    pub heading_rad: f64,
    /// A measure of this sweep that noise never repeats to the bit, such as the mean level of its raw
    /// data: the same again tells of a sonar that is stuck, in an empty sea too. `None`: none is told.
    #[cfg_attr(feature = "serde", serde(default))]
    pub background: Option<f64>,
    /// The echoes, in no particular order.
    pub detections: Vec<Detection>,
}
