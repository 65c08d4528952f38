//! Drivers: they call the planners a synchroniser asks for.
//!
//! Both catch panics of planners: the synchroniser gets an error and decides what to do. (This needs
//! `panic = "unwind"`, the default of Rust's profiles; with `panic = "abort"` a panic ends the process.)
//! A planner that has panicked three times is not called again. After three plans in a row that were
//! called feasible and are not, a planner is skipped for one call, and again after each further one.
//! When a planner is not called, a baseline planner of `auv-planning` answers; its plans are verified as
//! all plans are.

#[cfg(feature = "threads")]
mod anticipation;
#[cfg(feature = "threads")]
mod call;
mod planners;
mod stepped;
#[cfg(feature = "threads")]
mod threaded;

pub use stepped::{Orders, Stepped};
#[cfg(feature = "threads")]
pub use threaded::{Threaded, ThreadedSettings};
