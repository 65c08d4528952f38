//! What steps cost, in evaluations.

use auv_planning::PathProblem;

/// Units of a curve costed against no region.
const UNITS_PER_CURVE: u64 = 1_000;
/// Units of a curve costed against one region more.
const UNITS_PER_REGION: u64 = 20;
/// Units of looking up the sea bed or the current at a place.
pub(crate) const LOOK_UP: u64 = 8;

/// Converts units of work (about 10 ns each) to evaluations: whole curves costed against all
/// regions.
///
/// Every step of the search counts its units, so an evaluation takes about the same time in every
/// problem.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WorkRate {
    units_per_evaluation: u64,
}

impl WorkRate {
    pub(crate) fn new(problem: &PathProblem<'_>) -> Self {
        let regions = problem.regions.len() as u64;
        Self {
            units_per_evaluation: UNITS_PER_CURVE + UNITS_PER_REGION * regions,
        }
    }

    /// The evaluations that units of work count as, at least one.
    pub(crate) fn evaluations(&self, units: u64) -> u64 {
        units.div_ceil(self.units_per_evaluation).max(1)
    }

    /// The units that evaluations stand for.
    pub(crate) fn units(&self, evaluations: u64) -> u64 {
        evaluations.saturating_mul(self.units_per_evaluation)
    }
}
