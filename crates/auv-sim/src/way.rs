//! What a simulated vehicle is to follow.

use auv_planning::Trajectory;

/// Where the vehicle is to go, in true time and true coordinates, and when.
#[derive(Clone, Copy)]
pub(crate) struct Way<'a> {
    pub(crate) trajectory: &'a Trajectory,
    pub(crate) from_s: f64,
    pub(crate) until_s: f64,
    /// Share of the greatest speed that it has.
    pub(crate) pace: f64,
}
