//! What a simulated vehicle is to follow.

use auv_mission::Mission;
use auv_ocean::CurrentField;
use auv_planning::Trajectory;

/// Where the vehicle is to go in one step of a simulation, in true time and true coordinates, and when.
#[derive(Clone, Copy, Debug)]
pub struct Guidance<'a> {
    /// The trajectory in force.
    pub trajectory: &'a Trajectory,
    /// Start and end of the step, mission time in seconds.
    pub from_s: f64,
    /// See `from_s`.
    pub until_s: f64,
    /// Share of the greatest speed that the vehicle has; 1 unless a fault slows it.
    pub pace: f64,
    /// The mission, for limits of the vehicle and for set-points ([`auv_mission::set_point`]).
    pub mission: &'a Mission,
    /// The true current that moves the vehicle.
    pub water: Option<&'a dyn CurrentField>,
}
