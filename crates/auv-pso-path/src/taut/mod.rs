//! The time-optimal planner: a string under tension between the regions at its own arrival times.

mod candidate;
mod contact;
mod cross_section;
mod detour;
mod detours;
mod flyable;
mod intrusion;
mod joined;
mod lattice;
mod plan;
mod regions;
mod sea;
mod search_context;
mod settings;
mod sources;
mod string;
mod strung;
mod through_sea;
mod work;

pub(crate) use plan::plan;
pub use settings::TautSettings;
