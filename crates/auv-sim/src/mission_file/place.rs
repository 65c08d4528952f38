//! A position in a mission file.

use auv_ocean::Geodetic;
use serde::{Deserialize, Deserializer};

/// A position: `[north, east, depth]` or `[north, east]` in metres, or latitude, longitude and depth.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(
    untagged,
    expecting = "give [north, east, depth] in metres or { latitude_deg, longitude_deg, depth_m }"
)]
pub(super) enum Place {
    Local([f64; 3]),
    /// At depth 0.
    Flat([f64; 2]),
    Geodetic(#[serde(deserialize_with = "from_table")] Geodetic),
}

/// A position in degrees is a table; serde alone would accept `[latitude, longitude]` too.
fn from_table<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Geodetic, D::Error> {
    let table = toml::Table::deserialize(deserializer)?;
    table.try_into().map_err(serde::de::Error::custom)
}
