//! Motion geometry that planners and missions share.
//!
//! Positions are in metres (north, east, down), times in seconds. All functions are pure: equal
//! arguments give equal bits. The verifier (`auv-verify`) and the simulation's judge have code of
//! their own on purpose, so that a mistake here does not hide itself.

mod circle;
mod clearance;
mod connection;
mod connection_task;
mod curve;
mod curve_points;
mod descent;
mod floor;
mod heading;
mod joining;
mod pose;
mod speed;
mod travel;

pub use circle::{LEVELLING_RADII, arc_step_rad, begins_level, tightest_circle_m};
pub use clearance::{ALWAYS, Nearest, distance_to_regions_m, least_clearance};
pub(crate) use connection::{LevelWay, shortest_level};
pub use connection::{connections, connections_between};
pub use connection_task::Connection;
pub(crate) use connection_task::STEEPEST_RAD;
pub use floor::Floor;
pub use heading::level_heading;
pub use joining::join;
pub use pose::{ConnectionEnd, ConnectionStart, Pose};
pub use speed::{LEAST_SPEED_SHARE, speed_over_ground_mps};
pub(crate) use travel::format_point;
pub use travel::{NotFlyable, travel_time_s};
