//! The vehicle of a simulation.

use crate::Guidance;
use auv_obstacles::TimedPoint;
use auv_planning::Trajectory;
use auv_types::{Point3, Vector3};
use std::fmt::Debug;

/// A vehicle that a simulation moves: [`crate::Simulation::with_vehicle`].
///
/// # Determinism
/// Equal calls in equal order must give equal bits.
pub trait SimulatedVehicle: Debug {
    /// The true place, metres.
    fn position(&self) -> Point3<f64>;

    /// The true velocity over ground, m/s.
    fn velocity(&self) -> Vector3<f64>;

    /// Another trajectory is in force from a mission time in seconds on.
    fn take(&mut self, _trajectory: &Trajectory, _time_s: f64) {}

    /// Moves until `guidance.until_s`. Appends the true track without its start: at least one point, in the order of
    /// time, the last one at `until_s` where the vehicle is then. Between two points it moves on a straight line.
    fn advance(&mut self, guidance: &Guidance<'_>, track: &mut Vec<TimedPoint>);
}
