//! Which search plans the paths.

use crate::swarm::SwarmSettings;
use crate::taut::TautSettings;
use auv_types::Violations;

/// The search of a [`crate::PsoPath`], with its settings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum PathSearch {
    /// The paper's particle swarm. The answer is a B-spline, its cost the paper's.
    Swarm(SwarmSettings),
    /// The time-optimal search: a string pulled taut between the regions. The answer's cost is its
    /// duration in seconds.
    TautString(TautSettings),
}

impl PathSearch {
    /// The paper's swarm: [`SwarmSettings::paper`].
    #[must_use]
    pub const fn paper() -> Self {
        Self::Swarm(SwarmSettings::paper())
    }

    /// The swarm with coefficients in common use: [`SwarmSettings::standard`].
    #[must_use]
    pub const fn standard() -> Self {
        Self::Swarm(SwarmSettings::standard())
    }

    /// Everything wrong with the settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        match self {
            Self::Swarm(settings) => settings.validate(),
            Self::TautString(settings) => settings.validate(),
        }
    }
}

impl Default for PathSearch {
    /// The time-optimal search.
    fn default() -> Self {
        Self::TautString(TautSettings::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_valid() {
        for preset in [
            PathSearch::paper(),
            PathSearch::standard(),
            PathSearch::default(),
        ] {
            assert!(preset.validate().is_empty());
        }
        let none = PathSearch::TautString(TautSettings { detours: 0 });
        assert_eq!(none.validate().total(), 1);
    }
}
