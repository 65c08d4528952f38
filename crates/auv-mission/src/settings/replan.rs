//! When a route or a path is planned again although the one in force still holds.

use auv_types::Violations;

/// The time expected of a leg (specification 3.1). The replan rule compares the real time with it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum ExpectedTime {
    /// Exactly the edge's time: every detour makes the leg late.
    Strict,
    /// The flight alone is compared with the edge's whole time, task included. Nearest to the paper's
    /// Table 2.
    TravelVsEstimate,
    /// The edge's travel time times `1 + kappa`, plus its task, plus the mean charged computing time.
    Slack {
        /// Share of the travel time. 0.02 is calibrated to the paper's Fig. 18.
        kappa: f64,
    },
    /// A given time for each leg in order, seconds (a scripted replay); infinite beyond the list.
    Given(#[cfg_attr(feature = "serde", serde(with = "crate::any_number::list"))] Vec<f64>),
}

/// When a new route is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum ReplanPolicy {
    /// At a waypoint, when the leg took longer than expected: the paper's rule.
    Late,
    /// As [`ReplanPolicy::Late`]. In addition, during a leg, as soon as its projected time exceeds the
    /// expected one; that route is planned for the expected arrival.
    Projected,
    /// At every waypoint. The route in force is kept unless the new one is better, so spare time is
    /// turned into tasks.
    EveryWaypoint,
}

/// When a route or a path is planned again although the one in force still holds.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReplanSettings {
    /// When a new route is asked for. Key `replan` in files.
    #[cfg_attr(feature = "serde", serde(rename = "replan"))]
    pub policy: ReplanPolicy,
    /// The time expected of a leg.
    pub expected_time: ExpectedTime,
    /// Time between two attempts to shorten a trajectory that makes a long detour, seconds.
    pub improve_s: f64,
    /// A trajectory makes a long detour when it takes longer than the straight line by this share.
    pub long_way: f64,
}

impl ReplanSettings {
    /// The paper's: a route is planned again when a leg was late.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            policy: ReplanPolicy::Late,
            ..Self::default()
        }
    }

    pub(super) fn validate_into(&self, violations: &mut Violations) {
        violations.require_not_negative(self.long_way, "long_way");
        violations.require_positive(self.improve_s, "improve_s");
        if let ExpectedTime::Slack { kappa } = self.expected_time {
            violations.require_not_negative(kappa, "expected_time.kappa");
        }
    }
}

impl Default for ReplanSettings {
    fn default() -> Self {
        Self {
            policy: ReplanPolicy::EveryWaypoint,
            expected_time: ExpectedTime::Slack { kappa: 0.02 },
            improve_s: 60.0,
            long_way: 0.05,
        }
    }
}
