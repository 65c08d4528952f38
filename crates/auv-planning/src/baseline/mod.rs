//! The simplest planners that pass the conformance kit: for tests, comparisons and as a fallback.

mod greedy;
mod straight;

pub use greedy::{GreedyRoute, greedy};
pub use straight::StraightPath;
