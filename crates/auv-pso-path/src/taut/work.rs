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

#[cfg(test)]
mod tests {
    use super::*;
    use auv_planning::Vehicle;
    use auv_types::Point3;

    #[test]
    fn an_evaluation_takes_more_work_among_more_regions() {
        let vehicle = Vehicle::paper();
        let regions = [auv_obstacles::Region::ball(Point3::origin(), 1.0); 50];
        let mut problem = PathProblem::new(Point3::origin(), Point3::new(9.0, 0.0, 0.0), &vehicle);
        assert_eq!(WorkRate::new(&problem).units(3), 3_000);
        problem.regions = &regions;
        let rate = WorkRate::new(&problem);
        assert_eq!(rate.units(3), 6_000);
        let evaluations = [0, 1, 2_000, 2_001].map(|units| rate.evaluations(units));
        assert_eq!(evaluations, [1, 1, 1, 2]);
        assert_eq!(rate.units(u64::MAX), u64::MAX);
    }
}
