//! A string under tension among the regions: the shortest polyline of its kind.

mod contacts;
mod forces;
mod segment_contact;
mod shape;
mod solver;
mod taut_string;
mod tension;

pub(crate) use solver::{StringSolver, Tightening};
pub(crate) use taut_string::TautString;
