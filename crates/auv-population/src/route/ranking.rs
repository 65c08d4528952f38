//! What makes a route better, and chance in proportion to it.

use super::Candidate;
use auv_types::{ChaCha8Rng, libm, rand::RngExt};
use std::cmp::Ordering;

/// What makes a route better than another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Ranking {
    /// Less violation, then less cost: every late route ranks behind every one in time.
    #[default]
    Deb,
    /// The cost alone, its own penalty for lateness included.
    Cost,
}

impl Ranking {
    /// The better route first.
    #[must_use]
    pub fn order(self, a: &Candidate, b: &Candidate) -> Ordering {
        match self {
            Self::Deb => a.score().cmp(&b.score()),
            Self::Cost => a.cost.total_cmp(&b.cost),
        }
    }

    /// One number that orders roughly alike, for the roulette wheel.
    #[must_use]
    pub fn penalised(self, candidate: &Candidate) -> f64 {
        match self {
            Self::Deb => candidate.cost + candidate.violation * candidate.cost.abs().max(1.0),
            Self::Cost => candidate.cost,
        }
    }
}

/// A roulette wheel: members are drawn with a chance proportional to `exp(-pressure c / c_worst)`.
///
/// Costs below 0 are shifted first, so that any scale of cost will do; infinite ones get no slice
/// to speak of.
#[derive(Clone, Debug, Default)]
pub struct Wheel {
    /// Where each slice ends.
    ends: Vec<f64>,
}

impl Wheel {
    /// Cuts a wheel into slices, one for each cost.
    #[must_use]
    pub fn new(costs: impl Iterator<Item = f64> + Clone, pressure: f64) -> Self {
        let finite = || costs.clone().filter(|cost| cost.is_finite());
        let base = finite().fold(0.0, f64::min);
        let worst = finite().fold(0.0, |worst: f64, cost| worst.max(cost - base));
        let mut end = 0.0;
        let slice = |cost: f64| {
            let relative = (cost - base) / worst.max(f64::MIN_POSITIVE);
            libm::exp(-pressure * relative.min(1e3))
        };
        let ends = costs
            .clone()
            .map(|cost| {
                end += slice(cost);
                end
            })
            .collect();
        Self { ends }
    }

    /// Draws a member's index (0 from an empty wheel).
    pub fn spin(&self, random: &mut ChaCha8Rng) -> usize {
        let whole = self.ends.last().copied().unwrap_or(0.0);
        let ball = random.random_range(0.0..1.0) * whole;
        let slot = self.ends.partition_point(|&end| end <= ball);
        slot.min(self.ends.len().saturating_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Seed;

    #[test]
    fn the_better_a_cost_the_larger_its_slice() {
        for costs in [[1.0, 2.0, 4.0], [-4.0, -3.0, -1.0]] {
            let wheel = Wheel::new(costs.into_iter(), 8.0);
            let mut drawn = [0; 3];
            let mut random = Seed(2).stream(0);
            for _ in 0..10_000 {
                drawn[wheel.spin(&mut random)] += 1;
            }
            assert!(
                drawn[0] > 5 * drawn[1] && drawn[1] > 5 * drawn[2],
                "{drawn:?}"
            );
        }
    }

    #[test]
    fn no_route_is_drawn_while_there_are_others() {
        let wheel = Wheel::new([f64::INFINITY, 1.0, f64::INFINITY].into_iter(), 8.0);
        let mut random = Seed(2).stream(0);
        assert!((0..1_000).all(|_| wheel.spin(&mut random) == 1));
    }
}
