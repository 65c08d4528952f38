//! Fronts of earliest arrival: over a lattice of places each node is labelled with the time at which a
//! vehicle reaches it through moving water.
//!
//! Path planners look for the right side of land and flow with them ([`Front`]); the times and ways of a
//! network's arcs come from the same fronts ([`NetworkFronts`]).

mod lattice;
mod network;
mod shortened;
mod spread;
mod stencil;
mod tide;

pub use lattice::{Depths, Frame, Lattice};
pub use network::{NetworkFronts, NetworkSea};
pub use spread::{Front, STEP_WORK, Spread};
pub use stencil::Stencil;
pub use tide::Tide;
