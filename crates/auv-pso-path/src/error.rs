//! The planner's name in its errors.

use auv_planning::{NotFlyable, PlanError};

/// Name of the planner.
pub(crate) const NAME: &str = "pso";

/// No trajectory at all.
pub(crate) fn failed(reason: String) -> PlanError {
    PlanError::Failed {
        planner: NAME.into(),
        reason,
    }
}

/// No trajectory, because the current stops the vehicle.
pub(crate) fn not_flyable(error: NotFlyable) -> PlanError {
    failed(error.to_string())
}
