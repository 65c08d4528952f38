//! Settings of the paper's algorithm.

use auv_route_encoding::{Decoding, RouteRanking};
use auv_types::Violations;

/// Settings of the paper's genetic algorithm. The paper states the population and the iterations; the
/// other values are choices of this implementation.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default)
)]
pub struct EvolutionSettings {
    /// Number of routes in the population (Section 8.1: 100).
    pub population: usize,
    /// Number of generations after which the search ends (Section 8.1: 150).
    pub iterations: u64,
    /// Number of pairs crossed in a generation; each has two children.
    pub parent_pairs: usize,
    /// Number of mutants in a generation.
    pub mutants: usize,
    /// Most repetitions of a crossover or mutation whose result is not a route.
    pub retries: u32,
    /// `beta` of the roulette wheel: a route of cost `c` is chosen with a probability proportional to
    /// `exp(-beta c / c_worst)`.
    pub selection_pressure: f64,
    /// How the initial routes are decoded.
    pub initialisation: Decoding,
    /// Most draws of an initial route that takes too long, under [`Decoding::Plain`].
    pub initial_tries: u64,
    /// What is done with offspring that repeat a node or use a missing edge.
    pub invalid_offspring: InvalidOffspring,
    /// Which of two routes is better.
    pub ranking: RouteRanking,
    /// Number of generations in a row, with costs that differ by at most `uniform_tolerance`, that end
    /// the search; `None`: never.
    pub uniform_patience: Option<u64>,
    /// Spread of the costs, as a share of their mean, up to which they count as equal.
    pub uniform_tolerance: f64,
    /// Number of generations in a row in which the best cost improves by less than `stall_tolerance`
    /// that end the search; `None`: never.
    pub stall_patience: Option<u64>,
    /// Least improvement of the best cost that counts.
    pub stall_tolerance: f64,
}

/// What is done with offspring that are not routes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum InvalidOffspring {
    /// They are discarded, as in the paper.
    #[default]
    Discard,
    /// Nodes are removed until they are routes.
    Repair,
}

impl EvolutionSettings {
    /// The paper's 100 routes and 150 iterations, with 40 pairs and 60 mutants a generation.
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            population: 100,
            iterations: 150,
            parent_pairs: 40,
            mutants: 60,
            retries: 5,
            selection_pressure: 8.0,
            initialisation: Decoding::BudgetAware,
            initial_tries: 1_000,
            invalid_offspring: InvalidOffspring::Discard,
            ranking: RouteRanking::Deb,
            uniform_patience: Some(10),
            uniform_tolerance: 1e-6,
            stall_patience: Some(50),
            stall_tolerance: 1e-9,
        }
    }

    /// Everything wrong with the settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require(
            (1..=1_000_000).contains(&self.population),
            "population",
            || format!("is {}; give 1 to 1,000,000 routes", self.population),
        );
        let offspring = self.parent_pairs.saturating_add(self.mutants);
        violations.require((1..=1_000_000).contains(&offspring), "mutants", || {
            format!("and parent_pairs add up to {offspring}; give 1 to 1,000,000 offspring")
        });
        violations.require(self.initial_tries > 0, "initial_tries", || {
            "is 0; give at least 1".into()
        });
        violations.require_not_negative(self.selection_pressure, "selection_pressure");
        violations.require_not_negative(self.uniform_tolerance, "uniform_tolerance");
        violations.require_not_negative(self.stall_tolerance, "stall_tolerance");
        violations
    }
}

impl Default for EvolutionSettings {
    fn default() -> Self {
        Self::paper()
    }
}
