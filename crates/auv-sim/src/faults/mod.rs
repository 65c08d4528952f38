//! Fault injection: what fails at sea, done to simulated missions on purpose.
//!
//! A [`FaultPlan`] names faults by [`Fault`], with an [`Intensity`] and a seed;
//! [`fly_with_faults`] flies a scenario with them and judges the run. Faults 1 to 7 are met when a
//! mission is loaded and must be refused; 8 to 24 begin in the middle of a leg. Everything follows
//! from scenario, plan and planners: a run that fails can be flown again.
//!
//! Whatever is injected, a run fails when something panics, does not end, holds what is not a
//! number, puts a plan in force that does not hold, touches an obstacle, or ends worse than the
//! fault allows ([`Fault::expected`]).

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
