//! What a planning call spent and why it ended.

/// What a planning call spent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stats {
    /// Evaluations granted: complete routes or curves costed, steps of a local search included.
    pub evaluations: u64,
    /// Generations completed.
    pub generations: u64,
    /// Why the call ended.
    pub stop: StopReason,
}

/// Why a run ended. All but the last two depend on seed and problem alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum StopReason {
    /// The planner reached its own iteration cap or had nothing left to try.
    #[default]
    Finished,
    /// Proven optimal.
    Optimal,
    /// No improvement for as long as the planner waits for one.
    Stalled,
    /// A feasible plan reached the target cost.
    TargetReached,
    /// All evaluations granted were spent.
    EvaluationsSpent,
    /// The wall time passed: not reproducible.
    DeadlinePassed,
    /// Cancelled from outside: not reproducible.
    Cancelled,
}

impl StopReason {
    /// Whether the same seed and budget give the same bits again.
    #[must_use]
    pub const fn is_reproducible(self) -> bool {
        !matches!(self, Self::DeadlinePassed | Self::Cancelled)
    }

    /// The reason as one word of JSON output.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Optimal => "optimal",
            Self::Stalled => "stalled",
            Self::TargetReached => "target_reached",
            Self::EvaluationsSpent => "evaluations_spent",
            Self::DeadlinePassed => "deadline_passed",
            Self::Cancelled => "cancelled",
        }
    }
}
