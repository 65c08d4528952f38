//! How good a plan is.

use std::cmp::Ordering;

/// How good a plan is: how far from feasible it is, then what it costs.
///
/// Scores are totally ordered by Deb's rule, the better one first: the smaller violation wins;
/// among equal violations, the smaller cost. A NaN is worse than every number, whatever its sign,
/// and -0 comes before 0.
///
/// K. Deb, "An efficient constraint handling method for genetic algorithms", Comput. Methods Appl.
/// Mech. Eng. 186 (2000).
///
/// ```
/// use auv_planning::Score;
///
/// let (late, dear) = (Score::new(0.1, 1.0), Score::feasible(9.0));
/// assert!(dear < late && dear.is_feasible());
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Score {
    /// How far the plan is from feasible: 0 when it is feasible.
    pub violation: f64,
    /// What the planner minimises.
    pub cost: f64,
}

impl Score {
    /// Worse than any plan.
    pub const WORST: Self = Self::new(f64::INFINITY, f64::INFINITY);

    /// The score of a plan.
    #[must_use]
    pub const fn new(violation: f64, cost: f64) -> Self {
        Self { violation, cost }
    }

    /// The score of a feasible plan.
    #[must_use]
    pub const fn feasible(cost: f64) -> Self {
        Self::new(0.0, cost)
    }

    /// Whether nothing is violated.
    #[must_use]
    pub const fn is_feasible(&self) -> bool {
        self.violation <= 0.0
    }
}

impl Ord for Score {
    fn cmp(&self, other: &Self) -> Ordering {
        number_order(self.violation, other.violation)
            .then_with(|| number_order(self.cost, other.cost))
    }
}

impl PartialOrd for Score {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Score {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Score {}

/// The order of two numbers, NaN of either sign last.
fn number_order(a: f64, b: f64) -> Ordering {
    a.is_nan().cmp(&b.is_nan()).then(a.total_cmp(&b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_by_violation_then_cost() {
        let sorted = [
            Score::feasible(f64::NEG_INFINITY),
            Score::feasible(1.0),
            Score::feasible(2.0),
            Score::feasible(f64::NAN),
            Score::new(0.5, -9.0),
            Score::WORST,
            Score::new(f64::NAN, 0.0),
        ];
        for (i, a) in sorted.iter().enumerate() {
            for (j, b) in sorted.iter().enumerate() {
                assert_eq!(a.cmp(b), i.cmp(&j), "{a:?} {b:?}");
                assert_eq!(a == b, i == j);
            }
        }
    }

    #[test]
    fn nan_is_last_whatever_its_sign() {
        for nan in [f64::NAN, -f64::NAN] {
            assert!(Score::new(nan, 0.0) > Score::WORST);
            assert!(Score::feasible(nan) > Score::feasible(f64::INFINITY));
            assert!(!Score::new(nan, 0.0).is_feasible());
        }
    }
}
