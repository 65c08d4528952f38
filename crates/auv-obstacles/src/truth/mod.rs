//! The true obstacles and their equations of motion (Eq. 2 to 5). Only simulators and tests use this
//! module; planners see predicted regions.

mod birth;
mod field;
mod growth;
mod obstacle;
mod ship;
#[cfg(test)]
mod tests;
mod whole_mission;

pub use birth::{Birth, LegObstacles, LegScenario};
pub use field::{FieldSettings, KeepOut, ObstacleField};
pub use growth::{Eq5, Growth};
pub use obstacle::{Obstacle, ObstacleClass};
pub use ship::{AfterLastFix, ShipFix, TrackedShip};
pub use whole_mission::MissionObstacles;
