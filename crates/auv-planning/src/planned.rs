//! A planner's answer.

use crate::{Schedule, Score, Stats};
use auv_obstacles::ObstacleId;
use auv_types::Violations;
use std::fmt;
use thiserror::Error;

/// A plan: feasible when `violation` is 0, else the one of least violation found.
#[must_use = "a plan may be infeasible: check its violation or call feasible()"]
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Planned<T> {
    /// The best plan found.
    pub best: T,
    /// What the planner minimised: for paths the duration in seconds (or the paper's cost), for
    /// routes the objective's cost.
    pub cost: f64,
    /// How far the plan is from feasible; exactly 0 when it is. The planner states the unit: metres
    /// for paths, a share of the time available for routes. (Errors in an input are
    /// [`Violations`].)
    pub violation: f64,
    /// A proven lower bound of the cost, if the planner has one (equal to `cost`: optimal).
    pub bound: Option<f64>,
    /// The obstacle that blocks an infeasible path.
    pub blocked_by: Option<ObstacleId>,
    /// The times of a route in time.
    #[cfg_attr(
        feature = "serde",
        serde(default, skip_serializing_if = "Option::is_none")
    )]
    pub schedule: Option<Schedule>,
    /// What the call spent and why it ended.
    pub stats: Stats,
}

impl<T> Planned<T> {
    /// A plan without bound or blocking obstacle.
    pub const fn new(best: T, cost: f64, violation: f64, stats: Stats) -> Self {
        Self {
            best,
            cost,
            violation,
            bound: None,
            blocked_by: None,
            schedule: None,
            stats,
        }
    }

    /// How good the plan is.
    #[must_use]
    pub const fn score(&self) -> Score {
        Score::new(self.violation, self.cost)
    }

    /// Whether the plan is feasible: no violation.
    #[must_use]
    pub fn is_feasible(&self) -> bool {
        self.score().is_feasible()
    }

    /// The plan if it is feasible.
    ///
    /// # Errors
    /// The whole answer when `violation > 0`.
    pub fn feasible(self) -> Result<T, Box<Self>> {
        if self.violation <= 0.0 {
            Ok(self.best)
        } else {
            Err(Box::new(self))
        }
    }
}

impl<T: fmt::Display> fmt::Display for Planned<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let stop = self.stats.stop.as_str();
        // Without the sign of a cost of -0.
        write!(f, "{}; cost {:.3}, ", self.best, self.cost + 0.0)?;
        if self.violation <= 0.0 {
            f.write_str("feasible")?;
        } else {
            write!(f, "infeasible: violation {:.3}", self.violation)?;
        }
        write!(f, "; {} evaluations, {stop}", self.stats.evaluations)
    }
}

/// Why there is no plan at all. An infeasible problem is not an error: its answer is a [`Planned`]
/// with a violation.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The problem is malformed.
    #[error("the problem is malformed: {0}")]
    Invalid(#[from] Violations),
    /// No edges lead to the destination.
    #[error(
        "destination {destination} cannot be reached from node {start}: no edges lead there; \
             add some or choose another destination"
    )]
    Unreachable {
        /// Where the route should start.
        start: u32,
        /// Where it should end.
        destination: u32,
    },
    /// Some mandatory tasks cannot be done, whatever else is left out.
    #[error(
        "not possible: {conflict}; give more time, wider windows, or make fewer tasks mandatory"
    )]
    Impossible {
        /// The smallest set found that cannot go together, and why.
        conflict: String,
    },
    /// The planner knows routes without times only.
    #[error(
        "this planner knows no windows, travel times by departure, tasks at nodes, order or visits; \
         choose a planner of routes in time (ga, greedy or exact)"
    )]
    NotInTime,
    /// The planner cannot do what the problem asks.
    #[error("planner {planner} does not support {what}")]
    Unsupported {
        /// The planner's name.
        planner: String,
        /// What it does not support.
        what: String,
    },
    /// The planner failed for a reason of its own.
    #[error("planner {planner} failed: {reason}")]
    Failed {
        /// The planner's name.
        planner: String,
        /// What happened.
        reason: String,
    },
}
