//! The types of a first route, path and mission: `use auv::prelude::*;`.

pub use auv_graph::{Edge, EdgeSet, Network, NodeId, Route, Task, Waypoint};
pub use auv_mission::driver::Stepped;
pub use auv_mission::{Mission, Observation, Outcome, SyncSettings, Synchroniser};
pub use auv_obstacles::{ObstacleId, Region};
pub use auv_ocean::UniformCurrent;
pub use auv_planning::baseline::{GreedyRoute, StraightPath};
pub use auv_planning::{
    Budget, PathPlanner, PathProblem, PlanError, Planned, RoutePlanner, RouteProblem, Run,
    StopReason, Trajectory, Vehicle,
};
pub use auv_types::{Bounds, Point3, Seed, Vector3, Violations};
pub use auv_verify::{verify_route, verify_trajectory};

#[cfg(feature = "planners")]
pub use auv_exact_route::{ExactRoute, ExactSettings};
#[cfg(feature = "planners")]
pub use auv_ga_route::{GaRoute, GaSettings};
#[cfg(feature = "planners")]
pub use auv_pso_path::{PathSearch, PsoPath};

#[cfg(feature = "report")]
pub use auv_report::{MissionPicture, mission_svg};
#[cfg(feature = "sim")]
pub use auv_sim::{Campaign, MissionOutcome, Preset, Scenario, Summary, simulate};
