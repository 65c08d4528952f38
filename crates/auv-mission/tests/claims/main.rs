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
mod golden;
mod projected;
mod table2;
#[cfg(feature = "threads")]
mod threaded;
mod unusual;
mod vehicle;
mod waiting;
mod world;
