//! Mission files: a simulated mission in TOML.
//!
//! [`MissionFile::from_toml`] parses the text; [`MissionFile::scenario`] builds a [`Scenario`] from it and
//! from the bytes of the charts, model currents and ship tracks it names. A preset sets vehicle, sonar,
//! tracker, current, obstacles and reserve; the file overrides single values.
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

mod body;
mod build;
mod courses;
mod data_report;
mod document;
mod fences;
mod guides;
mod heights;
mod ladders;
mod launch_check;
mod misplaced;
mod nearest_name;
mod network;
mod no_room;
mod obstacles;
mod overrides;
mod place;
mod places;
mod plain_words;
mod room_below;
mod sea;
mod ships;
mod surface;
mod surveys;
#[cfg(test)]
mod tests;
mod timed;
mod true_bed;
mod utc;
mod values;
mod versions;
mod waypoints;
mod works;

pub use crate::Preset;
pub use data_report::{DataReport, FileRead};
pub use document::MissionFile;
pub use launch_check::{LaunchCheck, LeftOut, StopCheck, TaskCheck, WhyLeftOut};
pub use works::Work;

use auv_types::Violations;
use std::fmt;
use thiserror::Error;

#[cfg(doc)]
use crate::Scenario;

/// The contents of the data files a mission names.
#[derive(Clone, Copy, Debug, Default)]
pub struct MissionData<'a> {
    /// A chart of depths, NetCDF or GeoTIFF. It replaces the sea bed of the mission file.
    pub bathymetry: Option<&'a [u8]>,
    /// A NetCDF file of an ocean model. It replaces the current of the mission file.
    pub currents: Option<&'a [u8]>,
    /// Ship tracks as comma-separated text.
    pub ais: Option<&'a [u8]>,
}

/// A kind of data file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DataFile {
    /// The chart of depths.
    Bathymetry,
    /// The modelled currents.
    Currents,
    /// The ship tracks.
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

/// Why a mission file is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MissionFileError {
    /// The text is not TOML or violates the schema: an unknown key, a missing key, a wrong type.
    #[error("{0}")]
    Syntax(String),
    /// Every invalid value.
    #[error("{0}")]
    Invalid(#[from] Violations),
    /// The file is understood, but its mission cannot be flown: everything that keeps it from that.
    #[error("{0}")]
    NoGo(Violations),
    /// A data file is missing or damaged.
    #[error("{file}: {reason}")]
    Data {
        /// Which file.
        file: DataFile,
        /// What is wrong, with the remedy.
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
