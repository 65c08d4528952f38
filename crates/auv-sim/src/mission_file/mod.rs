//! Missions as TOML files: everything a simulated mission needs, on one page.
//!
//! [`MissionFile::from_toml`] reads the text, [`MissionFile::scenario`] makes a [`Scenario`] of it, with
//! the charts, model currents and ship tracks it names handed over as bytes. A preset sets vehicle,
//! sonar, tracker, current, obstacles and reserve together; the file overrides what it wants.
//!
//! ```
//! use auv_sim::mission_file::{MissionData, MissionFile};
//! use auv_types::Seed;
//!
//! let text = r#"
//!     version = 1
//!     name = "two stations"
//!     preset = "paper"
//!     budget_s = 2000.0
//!     start = "boat"
//!     destination = "dock"
//!     waypoints = [
//!         { name = "boat", at = [0, 0, 20] },
//!         { name = "station", at = [900, 300, 20], task = "profile" },
//!         { name = "dock", at = [1800, 0, 20] },
//!     ]
//!     tasks.profile = { priority = 6, risk = 2, time_s = 60 }
//!     connect.nearest = 2
//! "#;
//! let scenario = MissionFile::from_toml(text)?.scenario(&MissionData::default(), Seed(0))?;
//! assert_eq!(scenario.mission.network.num_nodes(), 3);
//! # Ok::<(), auv_sim::mission_file::MissionFileError>(())
//! ```

mod build;
mod document;
mod network;
mod obstacles;
mod places;
mod preset;
mod sea;
mod ships;
#[cfg(test)]
mod tests;
mod ways;

pub use document::MissionFile;
pub use preset::Preset;

use auv_types::Violations;
use std::fmt;
use thiserror::Error;

#[cfg(doc)]
use crate::Scenario;

/// The files a mission names, as bytes; `None` where it names none or they are not at hand.
#[derive(Clone, Copy, Debug, Default)]
pub struct MissionData<'a> {
    /// A NetCDF chart of depths; it takes the place of the file's sea bed.
    pub bathymetry: Option<&'a [u8]>,
    /// A NetCDF file of a ROMS model; it takes the place of the file's current.
    pub currents: Option<&'a [u8]>,
    /// Ship tracks as comma-separated text.
    pub ais: Option<&'a [u8]>,
}

/// Which file beside the mission file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DataFile {
    /// The chart of depths.
    Bathymetry,
    /// The model's currents.
    Currents,
    /// The ships' tracks.
    Ais,
}

impl fmt::Display for DataFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Bathymetry => "bathymetry",
            Self::Currents => "currents",
            Self::Ais => "ais",
        })
    }
}

/// Why a mission file makes no mission.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MissionFileError {
    /// It is not TOML, or not in the schema: an unknown key, a missing one, another type.
    #[error("{0}")]
    Syntax(String),
    /// Values that make no mission, all of them.
    #[error("{0}")]
    Invalid(#[from] Violations),
    /// A file beside it is missing or damaged.
    #[error("{file}: {reason}")]
    Data {
        /// Which.
        file: DataFile,
        /// What is wrong, and the remedy.
        reason: String,
    },
}

impl MissionFileError {
    pub(crate) fn data(file: DataFile, reason: impl fmt::Display) -> Self {
        Self::Data {
            file,
            reason: reason.to_string(),
        }
    }
}
