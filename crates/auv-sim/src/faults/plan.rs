//! The faults of one run.

use super::{Fault, FaultResponse, Intensity};
use auv_types::Seed;

/// Which faults happen to a mission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultPlan {
    /// The faults. Faults in flight start together. If the list holds a fault on loading, only the first
    /// such fault is injected.
    pub faults: Vec<Fault>,
    /// How severe each fault is.
    pub intensity: Intensity,
    /// Seed of all random draws of the faults.
    pub seed: Seed,
}

impl FaultPlan {
    /// The most severe response allowed: the most severe one that any of the faults allows.
    #[must_use]
    pub fn expected(&self) -> FaultResponse {
        let responses = self
            .faults
            .iter()
            .map(|fault| fault.expected(self.intensity));
        responses.max().unwrap_or(FaultResponse::Unchanged)
    }
}
