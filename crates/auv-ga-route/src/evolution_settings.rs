//! Settings of the paper's algorithm.

use auv_route_encoding::{Decoding, RouteRanking};
use auv_types::Violations;

/// Settings of the paper's genetic algorithm; the paper states the population and the iterations,
/// the rest are choices where it is silent.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default)
)]
pub struct EvolutionSettings {
    /// Routes in the population (Section 8.1: 100).
    pub population: usize,
    /// Generations after which it ends (Section 8.1: 150).
    pub iterations: u64,
    /// Pairs crossed in a generation, two children each.
    pub parent_pairs: usize,
    /// Mutants in a generation.
    pub mutants: usize,
    /// How often more an offspring that is no route is bred anew: 11 to 34 % of crossings give one.
    pub retries: u32,
    /// `beta` of the roulette wheel, `p` proportional to `exp(-beta c / c_worst)`.
    pub selection_pressure: f64,
    /// How the first routes are decoded.
    pub initialisation: Decoding,
    /// How often a first route that takes too long is drawn again, when decoded plainly.
    pub initial_tries: u64,
    /// What becomes of offspring that repeat a node or use a missing edge.
    pub infertile: Infertile,
    /// What makes a route better.
    pub ranking: RouteRanking,
    /// Ends after so many generations in which the costs differ by less than `uniform_tolerance`.
    pub uniform_patience: Option<u64>,
    /// Spread of the costs as a share of their mean below which they are held equal.
    pub uniform_tolerance: f64,
    /// Ends after so many generations in which the best improves by less than `stall_tolerance`.
    pub stall_patience: Option<u64>,
    /// Improvement of the best cost that counts.
    pub stall_tolerance: f64,
}

/// What becomes of offspring that are no routes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Infertile {
    /// They are discarded, as the paper has it.
    #[default]
    Discard,
    /// Nodes are dropped until they are routes.
    Repair,
}

impl EvolutionSettings {
    /// 100 routes, 150 iterations; 40 pairs and 60 mutants a generation.
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
            infertile: Infertile::Discard,
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
            "is 0; draw the first routes at least once".into()
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
