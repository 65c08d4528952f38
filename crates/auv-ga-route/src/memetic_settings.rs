//! Settings of the memetic algorithm.

use auv_types::Violations;

/// Settings of the memetic algorithm.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default)
)]
pub struct MemeticSettings {
    /// Routes in the population of the first epoch; each epoch has twice as many, up to `population`.
    /// Small ones converge early, large ones better.
    pub first_population: usize,
    /// Most routes in a population.
    pub population: usize,
    /// Evaluations spent on one pair in a generation: children and the descent steps they take.
    pub offspring: u64,
    /// Windows solved anew in a route that crossing does not improve.
    pub windows: u32,
    /// Most evaluations spent on one first route.
    pub descent: u64,
    /// Neighbours of a node that moves and joints consider, in each direction.
    pub neighbours: usize,
    /// Noise of the greedy choice in first routes, as a share of the profit.
    pub noise: f64,
    /// Price of a second left unused, as a share of the best route's profit per second.
    pub price: f64,
    /// Generations without any change that end an epoch.
    pub idle_generations: u64,
    /// Epochs without a better route that end the search.
    pub patience: u64,
}

impl Default for MemeticSettings {
    fn default() -> Self {
        Self {
            first_population: 8,
            population: 100,
            offspring: 30,
            windows: 1,
            descent: 100,
            neighbours: 6,
            noise: 0.5,
            price: 0.7,
            idle_generations: 2,
            patience: 8,
        }
    }
}

impl MemeticSettings {
    /// Everything wrong with the settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let mut within = |value: u64, most: u64, place: &str| {
            violations.require((1..=most).contains(&value), place, || {
                format!("is {value}; give 1 to {most}")
            });
        };
        within(self.first_population as u64, 100_000, "first_population");
        within(self.population as u64, 100_000, "population");
        within(self.offspring, 1_000_000, "offspring");
        within(self.descent, 1_000_000, "descent");
        within(self.neighbours as u64, 1_000, "neighbours");
        within(self.idle_generations, 1_000_000, "idle_generations");
        within(self.patience, 1_000_000, "patience");
        violations.require((0.0..=1.0).contains(&self.noise), "noise", || {
            format!("is {}; give a share from 0 to 1", self.noise)
        });
        violations.require_not_negative(self.price, "price");
        violations
    }
}
