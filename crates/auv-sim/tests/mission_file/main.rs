//! Claims about mission files: documented missions fly, mistakes are reported.
#![cfg(feature = "mission-file")]
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test that fails should say where, a skipped one that it is"
)]

mod bad_input;
#[cfg(feature = "netcdf")]
mod data;
mod examples;
mod schema;
mod version_2;
#[cfg(feature = "netcdf")]
mod written;

use auv_sim::Scenario;
use auv_sim::mission_file::{MissionData, MissionFile, MissionFileError};
use auv_types::Seed;

/// The mission of a text without data files.
fn scenario(text: &str) -> Result<Scenario, MissionFileError> {
    MissionFile::from_toml(text)?.scenario(&MissionData::default(), Seed(0))
}

/// The mission files of the document.
fn documented() -> Vec<&'static str> {
    let document = include_str!("../mission-file.md");
    let blocks = document.split("```toml\n").skip(1);
    blocks
        .map(|block| block.split("```").next().unwrap())
        .collect()
}
