//! Drivers: they call the planners a synchroniser asks for.
//!
//! Both catch panics of planners: the synchroniser gets an error and decides what to do. (This needs
//! `panic = "unwind"`, the default of Rust's profiles; with `panic = "abort"` a panic ends the process.)
//! A planner that has panicked three times is not called again. After three plans in a row that were
//! called feasible and are not, a planner is skipped for one call, and again after each further one.
//! When a planner is not called, a baseline planner of `auv-planning` answers; its plans are verified as
//! all plans are.
//!
//! A driver of your own implements [`Driver`]. It can answer with [`Stepped::answer`], on threads or processes of its
//! own, and prepare the next waypoint with [`Prepared`].

#[cfg(feature = "threads")]
mod call;
mod orders;
mod planners;
mod prepared;
mod stepped;
#[cfg(feature = "threads")]
mod threaded;

pub use orders::{Driver, Orders};
pub use prepared::Prepared;
pub use stepped::Stepped;
#[cfg(feature = "threads")]
pub use threaded::{Threaded, ThreadedSettings};
