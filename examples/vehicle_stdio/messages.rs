//! The lines that go in and come out, one JSON object each, told apart by `type`.
//!
//! Places are `[north, east, down]` in metres, velocities in m/s over ground, times mission seconds.

use auv_mission::{PathCall, RouteCall, SetPoint};
use auv_obstacles::{Detection, Region, Rejected};
use auv_types::{Point3, Vector3};
use serde::{Deserialize, Serialize};

/// A line in.
#[derive(Debug, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Incoming {
    /// What the vehicle knows at a moment. It is answered with orders.
    Observation(Box<Moment>),
    /// Asks for the whole state as text, to be kept on disk.
    Save,
    /// Goes on from a saved state: the first line after a restart.
    Resume {
        /// What `saved` gave.
        checkpoint: String,
    },
}

/// What the vehicle knows at a moment.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Moment {
    pub(crate) time_s: f64,
    pub(crate) position: Point3<f64>,
    pub(crate) velocity: Vector3<f64>,
    /// Standard deviation of the position's horizontal error, metres.
    #[serde(default)]
    pub(crate) position_sigma_m: f64,
    /// By how much a fix has moved the position since the last line, metres: what is tracked moves along.
    #[serde(default)]
    pub(crate) corrected_by: Option<Vector3<f64>>,
    /// A scan of the sonar, for the tracker of this process.
    #[serde(default)]
    pub(crate) scan: Option<Echoes>,
    /// Ships as their transponders report them now, without margins: each from the surface to its keel.
    #[serde(default)]
    pub(crate) ships: Vec<Region>,
    /// Regions that the vehicle predicts itself, margins included.
    #[serde(default)]
    pub(crate) regions: Vec<Region>,
    /// Altitude over the bed as measured, metres.
    #[serde(default)]
    pub(crate) altitude_m: Option<f64>,
    /// Whether the autopilot cannot follow trajectories any more.
    #[serde(default)]
    pub(crate) cannot_follow: bool,
    /// Whether there is water in the vehicle.
    #[serde(default)]
    pub(crate) leak: bool,
    /// Usable energy left as measured, joules.
    #[serde(default)]
    pub(crate) battery_j: Option<f64>,
}

/// A scan from where the vehicle is.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Echoes {
    /// Clockwise from north, radians.
    pub(crate) heading_rad: f64,
    /// A noisy measure of the sweep, which reveals a frozen sonar.
    #[serde(default)]
    pub(crate) background: Option<f64>,
    pub(crate) echoes: Vec<Detection>,
}

/// A line out.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Outgoing<'a> {
    /// The mission was read; the first line.
    Ready {
        name: &'a str,
        budget_s: f64,
        position: Point3<f64>,
        waypoints: Vec<String>,
        warnings: &'a [String],
    },
    /// The answer to an observation.
    Orders {
        time_s: f64,
        /// What to steer now; null before the first trajectory.
        set_point: Option<SetPoint>,
        /// The trajectory to follow from now on, `[north, east, down, time]` each; null: the one before.
        trajectory: Option<Vec<[f64; 4]>>,
        /// Rows of both tables that are new: what was decided, and why.
        route_calls: &'a [RouteCall],
        legs: &'a [PathCall],
        /// What was refused of the scan: numbers of scans and echoes by reason; null: nothing.
        refused: Option<Rejected>,
        /// When an observation is due at the latest.
        due_s: f64,
        /// Null until the mission is over.
        outcome: Option<String>,
    },
    /// The whole state.
    Saved { checkpoint: String },
    /// The state was taken up again, with the trajectory in force.
    Resumed {
        due_s: f64,
        trajectory: Option<Vec<[f64; 4]>>,
    },
    /// The line was refused, and changed nothing.
    Refused { reason: String },
}
