//! How much memory the planner may use.

use auv_types::Violations;

/// Settings of [`crate::ExactRoute`].
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ExactSettings {
    /// Most nodes of a network that gets a linear program; a larger one gets the bound of a knapsack.
    /// The program takes some 100 bytes for each pair of nodes.
    pub most_nodes: usize,
    /// Most parts of the routes that are open at a time. With more, the planner ends with the bound
    /// that it has. A part takes some hundred bytes.
    pub most_parts: usize,
}

impl Default for ExactSettings {
    fn default() -> Self {
        Self {
            most_nodes: 2000,
            most_parts: 1 << 20,
        }
    }
}

impl ExactSettings {
    /// Everything wrong with the settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require(self.most_nodes <= 10_000, "most_nodes", || {
            format!("is {}; give at most 10,000", self.most_nodes)
        });
        let parts = 1..=1 << 24;
        violations.require(parts.contains(&self.most_parts), "most_parts", || {
            format!("is {}; give 1 to 2^24", self.most_parts)
        });
        violations
    }
}
