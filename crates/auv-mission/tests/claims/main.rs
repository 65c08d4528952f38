//! Claims about whole missions flown by the synchroniser.

#![allow(
    clippy::float_cmp,
    clippy::panic,
    clippy::unwrap_used,
    reason = "tests compare exact values and fail loudly on purpose"
)]

mod battery;
#[cfg(feature = "serde")]
mod checkpoint;
mod courses;
mod drivers;
mod emergencies;
mod fixes;
mod flight;
mod golden;
mod late_answers;
mod projected;
#[cfg(feature = "threads")]
mod threaded;
mod unusual;
mod waiting;
mod way_on;
mod work;
mod world;
