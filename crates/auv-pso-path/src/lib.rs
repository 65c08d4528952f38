//! Particle swarm path planning with B-splines among moving obstacles.

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod certify;
mod cost;
mod hazards;
mod planner;
mod settings;
mod swarm;
mod windows;

pub use planner::PsoPath;
pub use settings::{Acceleration, PsoSettings, Ranking, Windows};
