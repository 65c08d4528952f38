//! Planners of other families behind the same traits: [`DifferentialEvolution`] for paths,
//! [`Insertion`] for routes. Short, conforming, flown; meant to be read and copied.
//!
//! ```
//! use auv_other_planners::{DifferentialEvolution, Insertion};
//!
//! auv_verify::conformance::path_planner(&DifferentialEvolution::default())?;
//! auv_verify::conformance::route_planner(&Insertion::default())?;
//! # Ok::<(), auv_verify::conformance::FailedChecks>(())
//! ```

mod differential_evolution;
mod insertion;

pub use differential_evolution::DifferentialEvolution;
pub use insertion::Insertion;
