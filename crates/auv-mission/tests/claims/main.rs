//! Claims about whole missions flown by the synchroniser.

#![allow(
    clippy::float_cmp,
    clippy::panic,
    clippy::unwrap_used,
    reason = "tests compare exact values and fail loudly on purpose"
)]

mod table2;
mod vehicle;
