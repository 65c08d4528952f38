//! How long the vehicle waits, and how often it asks for a path, when none leads to the target.

use auv_types::Violations;

/// How long the vehicle waits, and how often it asks for a path, when none leads to the target.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WaitingSettings {
    /// Path calls of one leg. When they are spent and its path fails, the leg is dropped, unless it
    /// leads to the destination.
    pub max_path_calls: u32,
    /// Longest wait for a covered waypoint, seconds. Then the leg is dropped, unless it leads to the
    /// destination.
    pub max_wait_s: f64,
    /// Longest time with nothing but waiting, over consecutive legs, seconds. Then the vehicle counts
    /// as shut in, and the mission is aborted while it can still surface.
    pub max_shut_in_s: f64,
    /// Least time between two path calls of a leg whose path is not clear, seconds. In between the
    /// vehicle evades without a planner.
    pub react_s: f64,
    /// Time between two path calls while waiting, seconds.
    pub retry_s: f64,
}

impl WaitingSettings {
    /// The paper says nothing of waiting: the same as the default.
    #[must_use]
    pub fn paper() -> Self {
        Self::default()
    }

    pub(super) fn validate_into(&self, violations: &mut Violations) {
        violations.require_not_negative(self.max_wait_s, "max_wait_s");
        violations.require_not_negative(self.max_shut_in_s, "max_shut_in_s");
        violations.require_not_negative(self.react_s, "react_s");
        let retry_s = self.retry_s;
        violations.require(retry_s > 0.0 && retry_s <= 1e6, "retry_s", || {
            format!("is {retry_s}; give a time above 0, at most 1e6 s")
        });
        violations.require(self.max_path_calls > 0, "max_path_calls", || {
            "is 0; allow at least 1".into()
        });
    }
}

impl Default for WaitingSettings {
    fn default() -> Self {
        Self {
            max_path_calls: 200,
            max_wait_s: 600.0,
            max_shut_in_s: 1800.0,
            react_s: 3.0,
            retry_s: 20.0,
        }
    }
}
