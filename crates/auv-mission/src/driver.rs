//! Drivers: they call the planners a synchroniser asks for.
//!
//! Both contain planners that panic (this needs `panic = "unwind"`, the default of Rust's profiles;
//! with `panic = "abort"` a panicking planner ends the process): the synchroniser gets an error and
//! falls back. A planner that panicked three times is not called any more; one that three times in a
//! row called a plan feasible that is not sits out a call, and another each time it does so again. A
//! baseline planner of `auv-planning` answers in its place; its plans are verified as all are.

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
