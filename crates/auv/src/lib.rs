//! Mission planning for autonomous underwater vehicles: which waypoints to visit in which order, a path for each leg
//! among obstacles, and the synchroniser that flies the mission and replans.
//!
//! This crate has nothing of its own. It brings the workspace's crates together under short names, and the types of a
//! first mission in [`prelude`]. A library that needs one part only may depend on that part's crate; a planner of your own
//! needs `auv-planning` alone.
//!
//! | module | holds | feature |
//! |---|---|---|
//! | [`graph`] | networks of waypoints with tasks, routes | |
//! | [`planning`] | the traits [`RoutePlanner`](planning::RoutePlanner) and [`PathPlanner`](planning::PathPlanner), problems, budgets, trajectories | |
//! | [`mission`] | the synchroniser and its drivers | `threads`: the driver that plans while the vehicle moves |
//! | [`verify`] | independent checks of any plan | `conformance`: the kit that any planner must pass, `verify::conformance` |
//! | [`obstacles`], [`ocean`], [`bspline`], [`types`] | sonar, tracker, regions; currents, beds, charts; curves; points, seeds | `netcdf`, `geotiff`: files |
//! | `planners` | GA, ICA and exact route planners; the path planner | `planners` (default) |
//! | `sim` | simulated missions and campaigns | `sim`; `mission-file`: missions from TOML files |
//! | `report` | pictures, tables, replays, exports | `report` |
//!
//! The feature `serde` makes problems, plans and checkpoints readable and writable.
//!
//! ```
//! use auv::prelude::*;
//!
//! let network = Network::builder(1.5)
//!     .waypoint("ramp", [0.0, 0.0, 10.0])
//!     .waypoint("wreck", [900.0, 200.0, 25.0])
//!     .waypoint("dock", [1_800.0, 0.0, 10.0])
//!     .task("ramp", "wreck", Task { priority: 6.0, risk: 2.0, completion_time_s: 60.0 })
//!     .connect_nearest(2)
//!     .build()?;
//! let (ramp, dock) = (network.waypoint("ramp")?, network.waypoint("dock")?);
//! let problem = RouteProblem::new(&network, ramp, dock, 3_600.0);
//! let planned = GreedyRoute.plan_route(&mut Run::new(Seed(0), Budget::evaluations(1)), &problem)?;
//! assert_eq!(network.describe(&planned.best), "ramp -> wreck -> dock");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod prelude;

pub use auv_bspline as bspline;
pub use auv_graph as graph;
pub use auv_mission as mission;
pub use auv_obstacles as obstacles;
pub use auv_ocean as ocean;
pub use auv_planning as planning;
#[cfg(feature = "report")]
pub use auv_report as report;
#[cfg(feature = "sim")]
pub use auv_sim as sim;
pub use auv_types as types;
pub use auv_verify as verify;

/// The planners, one crate each.
#[cfg(feature = "planners")]
pub mod planners {
    pub use auv_exact_route as exact_route;
    pub use auv_ga_route as ga_route;
    pub use auv_ica_route as ica_route;
    pub use auv_pso_path as pso_path;
}

/// The first page of the project, whose programs are compiled and run here.
#[cfg(all(doctest, feature = "planners", feature = "report"))]
#[doc = include_str!("../README.md")]
pub mod first_page {}
