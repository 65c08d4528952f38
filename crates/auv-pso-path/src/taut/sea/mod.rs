//! Ways through a moving sea: the global stage is a front of earliest arrival, the local stage pulls its
//! way tight in the metric of travel time.

mod chart;
mod tide;
mod tube;
mod water;
mod ways;

pub(crate) use ways::{SeaSource, SeaWays};
