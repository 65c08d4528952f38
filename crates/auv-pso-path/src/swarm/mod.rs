//! The paper's planner: a particle swarm over the control points of a B-spline (Eq. 11, 13-18).

mod cost;
mod hazards;
mod lanes;
mod particles;
mod plan;
mod settings;
mod windows;

pub(crate) use plan::plan;
pub use settings::{Acceleration, PathRanking, SwarmSettings, Windows};
