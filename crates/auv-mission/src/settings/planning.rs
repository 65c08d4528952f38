//! What planners are given, and what their computing time costs.

use auv_planning::Budget;
use auv_types::Violations;

/// Whether computing time is charged to the mission (Eq. 12 and 21).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum ComputeCharge {
    /// Not charged, as in the paper's Table 2. Reproducible.
    None,
    /// A fixed time for each call, seconds. Reproducible.
    Fixed {
        /// Each route call.
        route_s: f64,
        /// Each path call.
        path_s: f64,
    },
    /// What the driver measured. Not reproducible.
    Measured,
}

/// What planners are given, and what their computing time costs.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PlanningSettings {
    /// Whether computing time is charged to the mission.
    pub compute: ComputeCharge,
    /// Budget of the first route call, before the vehicle is under way.
    pub launch_budget: Budget,
    /// Budget of each later route call.
    pub route_budget: Budget,
    /// Budget of each path call.
    pub path_budget: Budget,
    /// Time between the request for a path and its departure, seconds. The vehicle moves on meanwhile;
    /// routes count this time for every leg. 0: paths depart at once.
    pub planning_s: f64,
}

impl PlanningSettings {
    /// The paper's: computing is not charged. The same as the default.
    #[must_use]
    pub fn paper() -> Self {
        Self::default()
    }

    pub(super) fn validate_into(&self, violations: &mut Violations) {
        let planning_s = self.planning_s;
        violations.require((0.0..=1e6).contains(&planning_s), "planning_s", || {
            format!("is {planning_s}; give 0 to 1e6 s")
        });
        if let ComputeCharge::Fixed { route_s, path_s } = self.compute {
            violations.require_not_negative(route_s, "compute.route_s");
            violations.require_not_negative(path_s, "compute.path_s");
        }
    }
}

impl Default for PlanningSettings {
    fn default() -> Self {
        Self {
            compute: ComputeCharge::None,
            launch_budget: Budget::evaluations(20_000),
            route_budget: Budget::evaluations(3_000),
            path_budget: Budget::evaluations(1_000),
            planning_s: 0.0,
        }
    }
}
