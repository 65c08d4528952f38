//! Where connections begin and end.

use auv_types::{Point3, Vector3};

/// A place and the direction of travel there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The place, metres.
    pub place: Point3<f64>,
    /// The direction of travel; its length does not count. A vertical one heads north.
    pub direction: Vector3<f64>,
}

/// Where a connection ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConnectionEnd {
    /// At a place, in a direction.
    Pose(Pose),
    /// At a place, in whatever direction is reached soonest.
    Place(Point3<f64>),
}

/// How a connection begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConnectionStart {
    /// At a place, in the direction flown.
    Pose(Pose),
    /// At a place, in any direction.
    Place(Point3<f64>),
}
