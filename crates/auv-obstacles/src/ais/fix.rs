//! One reported position of a ship, and the units of reports.

/// One knot in m/s.
pub(super) const KNOT_MPS: f64 = 1852.0 / 3600.0;

/// Degrees north and east in metres north and east of the mission's origin.
pub(super) type MetresOf<'a> = dyn Fn(f64, f64) -> (f64, f64) + 'a;

/// What a ship says it is doing, as far as its motion is concerned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NavStatus {
    /// Under way, fishing, drifting, or not told.
    #[default]
    Free,
    /// At anchor.
    Anchored,
    /// Moored.
    Moored,
    /// Aground.
    Aground,
}

/// One reported position.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AisFix {
    /// Seconds after the first fix of the whole text.
    pub time_s: f64,
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
    /// Speed over ground, m/s.
    pub speed_mps: Option<f64>,
    /// Course over ground, clockwise from north in radians.
    pub course_rad: Option<f64>,
    /// Heading, clockwise from north in radians.
    pub heading_rad: Option<f64>,
    /// Navigational status.
    #[cfg_attr(feature = "serde", serde(default))]
    pub status: NavStatus,
}

impl AisFix {
    /// Whether the ship reports that it lies at anchor, moored or aground.
    #[must_use]
    pub fn lies_still(&self) -> bool {
        self.status != NavStatus::Free
    }
}
