//! The verifier finds every fault of a trajectory; its clearance equals the planners' closed form.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "tests compare exact values and fail loudly"
)]

#[cfg(feature = "conformance")]
mod faulty;
#[cfg(feature = "conformance")]
mod faulty_paths;
#[cfg(feature = "conformance")]
mod faulty_planners;
#[cfg(feature = "conformance")]
mod faulty_routes;
mod in_time;
mod limits;
#[cfg(feature = "conformance")]
mod misread;
mod paths;
#[cfg(feature = "conformance")]
mod planners;
mod route_in_time;
mod tasks_in_time;
mod way_on;
mod way_on_limits;
