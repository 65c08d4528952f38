//! Times of a mission file: seconds of the mission, or UTC where the launch is given.

use jiff::Timestamp;
use serde::Deserialize;

/// A time: mission seconds, or UTC text such as `2026-06-01T08:30:00Z`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(
    untagged,
    expecting = "give seconds from the launch, or UTC text like \"2026-06-01T08:30:00Z\""
)]
pub(super) enum Moment {
    Seconds(f64),
    Text(String),
    Date(toml::value::Datetime),
}

impl Moment {
    /// Seconds since 1970; `None` for mission seconds, and where the text is no time in UTC.
    pub(super) fn unix_s(&self) -> Option<f64> {
        let text = match self {
            Self::Seconds(_) => return None,
            Self::Text(text) => text.clone(),
            Self::Date(date) => date.to_string(),
        };
        let time: Timestamp = text.parse().ok()?;
        Some(time.as_millisecond() as f64 / 1_000.0)
    }
}
