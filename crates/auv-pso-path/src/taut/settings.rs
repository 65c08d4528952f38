//! Settings of the time-optimal search.

use auv_types::Violations;

/// Most detours that may be tried side by side.
const MOST_DETOURS: usize = 25_000;

/// Settings of the taut-string search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct TautSettings {
    /// Detours tried side by side in a generation, 1 to 25,000.
    pub detours: usize,
}

impl TautSettings {
    /// Everything wrong with the settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let possible = (1..=MOST_DETOURS).contains(&self.detours);
        violations.require(possible, "detours", || {
            format!("is {}; give 1 to {MOST_DETOURS}", self.detours)
        });
        violations
    }
}

impl Default for TautSettings {
    /// Eight detours a generation: enough for eight threads, few enough that each generation starts
    /// from the gains of the one before.
    fn default() -> Self {
        Self { detours: 8 }
    }
}
