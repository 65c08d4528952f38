//! What makes a mission hard, for tables.

use crate::Landscape;
use crate::waypoints::Place;

/// What makes a mission hard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traits {
    /// The kind of its coast.
    pub landscape: Landscape,
    /// Whether its sea is empty and still.
    pub empty: bool,
    /// Number of waypoints at the lowest legal depth.
    pub at_limit: usize,
    /// The steepest slope within two turn radii of a waypoint at the lowest legal depth, degrees; 0 without
    /// such a waypoint.
    pub slope_at_limit_deg: f64,
    /// The steepest slope within two turn radii of any waypoint, degrees.
    pub slope_deg: f64,
}

impl Traits {
    /// The slope from which on a waypoint at the limit counts as steep, degrees.
    pub const STEEP_DEG: f64 = 20.0;

    pub(crate) fn of(landscape: Landscape, empty: bool, places: &[Place]) -> Self {
        let steepest = |most: f64, place: &Place| most.max(place.slope_deg);
        let limit = places.iter().filter(|place| place.at_limit);
        Self {
            landscape,
            empty,
            at_limit: limit.clone().count(),
            slope_at_limit_deg: limit.fold(0.0, steepest),
            slope_deg: places.iter().fold(0.0, steepest),
        }
    }

    /// Whether a waypoint at the lowest legal depth lies within two turn radii of a slope over
    /// [`Traits::STEEP_DEG`].
    #[must_use]
    pub fn is_steep(&self) -> bool {
        self.slope_at_limit_deg > Self::STEEP_DEG
    }
}
