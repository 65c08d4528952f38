//! What steps cost, in evaluations.

use auv_planning::PathProblem;

/// Work counted in units of about 10 ns, and how much of it is one evaluation: a whole curve costed
/// against all regions.
///
/// Every step of the taut planner counts its units, so that no problem, however tangled, takes much
/// longer than another with as many evaluations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rate {
    units: u64,
}

/// A place looked up in the sea bed or the current.
pub(crate) const LOOK_UP: u64 = 8;

impl Rate {
    pub(crate) fn of(problem: &PathProblem<'_>) -> Self {
        Self {
            units: 1_000 + 20 * problem.regions.len() as u64,
        }
    }

    /// What so many units count as, at least one evaluation.
    pub(crate) fn evaluations(&self, units: u64) -> u64 {
        units.div_ceil(self.units).max(1)
    }

    /// Units that so many evaluations stand for.
    pub(crate) fn units(&self, evaluations: u64) -> u64 {
        evaluations.saturating_mul(self.units)
    }
}
