//! Selection with a chance that falls with the cost.

use auv_types::{ChaCha8Rng, libm, rand::RngExt};

/// A roulette wheel: members are drawn with a chance proportional to `exp(-pressure c / c_worst)`.
///
/// If any cost is negative, all are shifted so that the least is 0. The slice of an infinite cost is
/// negligible.
#[derive(Clone, Debug, Default)]
pub struct RouletteWheel {
    /// Upper end of each slice.
    ends: Vec<f64>,
}

impl RouletteWheel {
    /// A wheel with one slice for each cost.
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

    /// Draws the index of a member; 0 from an empty wheel.
    pub fn spin(&self, random: &mut ChaCha8Rng) -> usize {
        let whole = self.ends.last().copied().unwrap_or(0.0);
        let drawn = random.random_range(0.0..1.0) * whole;
        let index = self.ends.partition_point(|&end| end <= drawn);
        index.min(self.ends.len().saturating_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Seed;

    #[test]
    fn a_lower_cost_gets_a_larger_slice() {
        for costs in [[1.0, 2.0, 4.0], [-4.0, -3.0, -1.0]] {
            let wheel = RouletteWheel::new(costs.into_iter(), 8.0);
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
    fn an_infinite_cost_is_not_drawn_beside_a_finite_one() {
        let wheel = RouletteWheel::new([f64::INFINITY, 1.0, f64::INFINITY].into_iter(), 8.0);
        let mut random = Seed(2).stream(0);
        assert!((0..1_000).all(|_| wheel.spin(&mut random) == 1));
    }
}
