//! What the population-based route planners share: the arcs a route may use ([`Legs`]), a route
//! with its cost ([`Candidate`]) and the priority vectors that encode it ([`Decoder`]).

mod answer;
mod legs;
mod priority;
mod ranking;

pub use answer::{Standard, plan};
pub use legs::{Candidate, Leg, Legs};
pub use priority::{Decoder, DecoderScratch, Decoding};
pub use ranking::{Ranking, Wheel};
