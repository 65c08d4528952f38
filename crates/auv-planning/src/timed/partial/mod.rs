//! Partial routes in time, extended step by step in the order of time; those that another one beats, and those
//! that cannot weigh more than the best route known, are dropped. When none is open, the best is proven.
//!
//! # References
//! Righini and Salani, "Decremental state space relaxation strategies and initialization heuristics for
//! solving the orienteering problem with time windows with dynamic programming", Computers and Operations
//! Research 36(4), 2009.

mod extension;
mod frontier;
mod label;
mod priced;
mod reach;
mod rivals;
mod slots;

pub use frontier::{Extended, PartialRoutes};
pub use reach::most_of_all;
