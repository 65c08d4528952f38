//! The two presets and their settings.

use crate::{EvolutionSettings, MemeticSettings};
use auv_types::Violations;

/// Which genetic algorithm runs, with its settings.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum GaSettings {
    /// The paper's generational algorithm.
    Evolution(EvolutionSettings),
    /// Populations of locally optimal routes, crossed by edge assembly.
    Memetic(MemeticSettings),
}

impl GaSettings {
    /// The paper's algorithm with its settings.
    #[must_use]
    pub const fn paper() -> Self {
        Self::Evolution(EvolutionSettings::paper())
    }

    /// Everything wrong with the settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        match self {
            Self::Evolution(settings) => settings.validate(),
            Self::Memetic(settings) => settings.validate(),
        }
    }
}

impl Default for GaSettings {
    fn default() -> Self {
        Self::Memetic(MemeticSettings::default())
    }
}
