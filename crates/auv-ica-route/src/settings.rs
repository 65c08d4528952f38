//! Settings of the Imperialist Competitive Algorithm.

use auv_route_encoding::{Decoding, RouteRanking};
use auv_types::Violations;

/// Settings of [`crate::IcaRoute`]. The paper states countries and iterations; the other values are
/// common in public implementations of the algorithm.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default)
)]
pub struct IcaSettings {
    /// Number of countries (Section 8.1: 100).
    pub countries: usize,
    /// Number of iterations after which the search ends (Section 8.1: 150).
    pub iterations: u64,
    /// Number of countries that become imperialists (8 in the original authors' code).
    pub imperialists: usize,
    /// `alpha` of an empire's power `exp(-alpha c / c_max)`.
    pub selection_pressure: f64,
    /// `beta`: a colony moves by up to this many times its distance to the imperialist.
    pub assimilation: f64,
    /// Probability that a colony undergoes a revolution.
    pub revolution: f64,
    /// `mu`: share of the coordinates that a revolution changes.
    pub revolution_share: f64,
    /// Standard deviation of the change, as a share of the range of priorities.
    pub revolution_spread: f64,
    /// `zeta`: weight of the colonies' mean cost in an empire's total cost.
    pub colony_share: f64,
    /// Empires whose imperialists are closer than this share of the diagonal of the space unite; `None`:
    /// never.
    pub uniting_distance: Option<f64>,
    /// How priority vectors are decoded.
    pub decoding: Decoding,
    /// Which of two routes is better.
    pub ranking: RouteRanking,
}

impl IcaSettings {
    /// The paper's 100 countries and 150 iterations, with 10 imperialists.
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            countries: 100,
            iterations: 150,
            imperialists: 10,
            selection_pressure: 1.0,
            assimilation: 2.0,
            revolution: 0.1,
            revolution_share: 0.05,
            revolution_spread: 0.1,
            colony_share: 0.1,
            uniting_distance: None,
            decoding: Decoding::BudgetAware,
            ranking: RouteRanking::Deb,
        }
    }

    /// Everything wrong with the settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require(
            (1..=1_000_000).contains(&self.countries),
            "countries",
            || format!("is {}; give 1 to 1,000,000", self.countries),
        );
        violations.require(self.imperialists > 0, "imperialists", || {
            "is 0; give at least 1".into()
        });
        for (share, place) in [
            (self.revolution, "revolution"),
            (self.revolution_share, "revolution_share"),
        ] {
            violations.require((0.0..=1.0).contains(&share), place, || {
                format!("is {share}; give a share from 0 to 1")
            });
        }
        for (value, place) in [
            (self.selection_pressure, "selection_pressure"),
            (self.assimilation, "assimilation"),
            (self.revolution_spread, "revolution_spread"),
            (self.colony_share, "colony_share"),
            (self.uniting_distance.unwrap_or(0.0), "uniting_distance"),
        ] {
            violations.require_not_negative(value, place);
        }
        violations
    }
}

impl Default for IcaSettings {
    fn default() -> Self {
        Self::paper()
    }
}
