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
    /// Number of routes in the population of the first epoch. Each further epoch has twice as many, up
    /// to `population`: small populations converge sooner, large ones to better routes.
    pub first_population: usize,
    /// Most routes in a population.
    pub population: usize,
    /// Most evaluations for one pair in a generation: one for each child and each descent step.
    pub offspring: u64,
    /// Number of windows searched in a route that crossover does not improve.
    pub windows: u32,
    /// Most evaluations for one initial route.
    pub descent: u64,
    /// Number of neighbours of a node, in each direction, that the local search tries.
    pub neighbours: usize,
    /// Noise of the choices that construct initial routes, as a share of the profit.
    pub noise: f64,
    /// Price of a second, as a share of the best route's profit per second.
    pub price: f64,
    /// Number of generations without a replacement that end an epoch.
    pub idle_generations: u64,
    /// Number of epochs without a better route that end the search.
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
