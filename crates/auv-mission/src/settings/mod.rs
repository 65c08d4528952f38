//! How the synchroniser decides: settings in groups.

mod margins;
mod planning;
mod replan;
mod waiting;
mod watchdogs;

use auv_types::Violations;
pub use margins::MarginSettings;
pub use planning::{ComputeCharge, PlanningSettings};
pub use replan::{ExpectedTime, ReplanPolicy, ReplanSettings};
pub use waiting::WaitingSettings;
pub use watchdogs::{WatchdogSettings, WithoutSonar};

/// Settings of the synchroniser. In files the keys of all groups stand side by side.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SyncSettings {
    /// When a route or a path is planned again although the one in force still holds.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub replan: ReplanSettings,
    /// What planners are given, and what their computing time costs.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub planning: PlanningSettings,
    /// How much time and distance plans keep free.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub margins: MarginSettings,
    /// How long the vehicle waits, and how often it asks for a path, when none leads to the target.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub waiting: WaitingSettings,
    /// When a sensor, the clock or the mission itself has failed.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub watchdogs: WatchdogSettings,
}

impl SyncSettings {
    /// The paper's synchroniser: a route is planned again when a leg was late, computing is not
    /// charged, no margins.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            replan: ReplanSettings::paper(),
            planning: PlanningSettings::paper(),
            margins: MarginSettings::paper(),
            waiting: WaitingSettings::paper(),
            watchdogs: WatchdogSettings::paper(),
        }
    }

    /// Everything wrong with the settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        self.replan.validate_into(&mut violations);
        self.planning.validate_into(&mut violations);
        self.margins.validate_into(&mut violations);
        self.waiting.validate_into(&mut violations);
        self.watchdogs.validate_into(&mut violations);
        violations
    }
}
