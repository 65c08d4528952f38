//! What the verifier must find, and its clearance against the planners' closed form.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "tests compare exact values and fail loudly"
)]

mod paths;
#[cfg(feature = "conformance")]
mod planners;
