//! How much memory and effort the planner may use.

use auv_types::Violations;

/// Settings of [`crate::ExactRoute`].
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ExactSettings {
    /// Number of nodes that a relaxed walk remembers at each node, stage by stage. A walk may return to
    /// a node only after it passed one that does not remember it. Each more gives tighter bounds and
    /// doubles the time.
    pub memory: Vec<usize>,
    /// Most price updates in a stage; the first stage does an eighth of them.
    pub price_updates: usize,
    /// Number of labels kept in a layer in the first stage. Each further stage keeps four times as many,
    /// up to [`ExactSettings::most_labels`].
    pub first_labels: usize,
    /// Most labels kept in a layer. A label takes about 80 bytes in the current layer and 8 bytes in
    /// each finished one.
    pub most_labels: usize,
}

impl Default for ExactSettings {
    fn default() -> Self {
        Self {
            memory: vec![2, 2, 4, 6, 8],
            price_updates: 80,
            first_labels: 64,
            most_labels: 1 << 18,
        }
    }
}

impl ExactSettings {
    /// Most nodes that a walk can remember at a node.
    pub const MAX_MEMORY: usize = 12;

    /// Everything wrong with the settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require(!self.memory.is_empty(), "memory", || {
            "is empty; give a number of nodes for at least one stage".into()
        });
        for (i, &memory) in self.memory.iter().enumerate() {
            violations.require(memory <= Self::MAX_MEMORY, &format!("memory[{i}]"), || {
                format!("is {memory}; give at most {}", Self::MAX_MEMORY)
            });
        }
        violations.require(self.price_updates > 0, "price_updates", || {
            "is 0; give at least 1".into()
        });
        let labels = 1..=1 << 24;
        violations.require(labels.contains(&self.most_labels), "most_labels", || {
            format!("is {}; give 1 to 2^24", self.most_labels)
        });
        let first = 1..=self.most_labels;
        violations.require(first.contains(&self.first_labels), "first_labels", || {
            format!("is {}; give 1 to most_labels", self.first_labels)
        });
        violations
    }
}
