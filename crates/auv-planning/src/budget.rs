//! What a planning call may spend.

use std::time::Duration;

/// What a planning call may spend. There is no default budget.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Budget {
    /// Most evaluations; exact and reproducible.
    pub evaluations: Option<u64>,
    /// Most wall time on the run's clock. It stops the run and affects nothing else.
    pub wall_time: Option<Duration>,
    /// Stop as soon as a feasible plan costs no more than this.
    pub target_cost: Option<f64>,
}

impl Budget {
    /// No limit but the planner's own iteration cap.
    #[must_use]
    pub const fn to_the_cap() -> Self {
        Self {
            evaluations: None,
            wall_time: None,
            target_cost: None,
        }
    }

    /// At most `n` evaluations: reproducible.
    #[must_use]
    pub const fn evaluations(n: u64) -> Self {
        Self {
            evaluations: Some(n),
            ..Self::to_the_cap()
        }
    }

    /// At most a wall time: not reproducible.
    #[must_use]
    pub const fn wall_time(time: Duration) -> Self {
        Self {
            wall_time: Some(time),
            ..Self::to_the_cap()
        }
    }
}
