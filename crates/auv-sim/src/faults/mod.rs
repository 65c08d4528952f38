//! Fault injection: faults that occur at sea, injected into simulated missions.
//!
//! A [`FaultPlan`] lists faults with an [`Intensity`] and a seed; [`fly_with_faults`] flies a scenario
//! with them and judges the run. Faults 1 to 7 occur when a mission is loaded and must be refused; faults
//! 8 to 24 start in the middle of a leg. A run depends on scenario, plan and planners only, so a failed
//! run can be repeated.
//!
//! A run fails if something panics, if the mission does not end, if a result is not a number, if an
//! invalid plan goes into force, if the vehicle touches an avoidable obstacle or the sea bed, or if the
//! response is more severe than the fault allows ([`Fault::expected`]).

mod active_faults;
mod canary;
mod catalogue;
mod clock;
mod failure_rate;
mod fly;
mod injection;
mod input;
mod motion;
mod plan;
mod planners;
#[cfg(feature = "serde")]
mod restart;
mod sea;
mod sonar;
#[cfg(test)]
#[cfg(feature = "serde")]
mod tests;
mod trial;
mod witness;

pub use catalogue::{Fault, FaultResponse, Intensity};
pub use failure_rate::FailureRate;
pub use fly::fly_with_faults;
pub use plan::FaultPlan;
pub use trial::Trial;
