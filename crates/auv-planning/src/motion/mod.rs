//! Motion geometry that planners and missions share.
//!
//! Positions are in metres (north, east, down), times in seconds. All functions are pure: equal
//! arguments give equal bits. The verifier (`auv-verify`) and the simulation's judge have code of
//! their own on purpose, so that a mistake here does not hide itself.

mod circle;
mod clearance;
mod connection;
mod curve;
mod descent;
mod floor;
mod heading;
mod speed;
mod travel;

pub use circle::{LEVELLING_RADII, arc_step_rad, begins_level, tightest_circle_m};
pub use clearance::{ALWAYS, Nearest, distance_to_regions_m, least_clearance};
pub use connection::{
    Connection, ConnectionEnd, ConnectionStart, Pose, connections, connections_between,
};
pub(crate) use connection::{LevelWay, STEEPEST_RAD, shortest_level};
pub use floor::Floor;
pub use heading::level_heading;
pub use speed::{LEAST_SPEED_SHARE, speed_over_ground_mps};
pub(crate) use travel::format_point;
pub use travel::{NotFlyable, travel_time_s};
