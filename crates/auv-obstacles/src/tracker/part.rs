//! Contacts at the edge of the sonar's range: a part of them is seen, more as they come nearer.

use crate::{Detection, Sonar};
use auv_types::{Point3, Vector3};

/// Standard deviations within which an echo may be of a part.
const SIGMAS: f64 = 2.0;

/// How much of a contact its last echo showed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Seen {
    /// All of it.
    #[default]
    Whole,
    /// The part within range.
    Part,
}

impl Seen {
    /// A ball as large as the echo, and where it is, would lie in part beyond the range.
    pub(super) fn of(echo: &Detection, from: &Point3<f64>, sonar: &Sonar) -> Self {
        let reach_m = (echo.position - from).norm() + SIGMAS * echo.position_sigma_m;
        let horizon_m2 = reach_m * reach_m - echo.radius_m * echo.radius_m;
        if sonar.near_face && horizon_m2 > sonar.range_m * sonar.range_m {
            Self::Part
        } else {
            Self::Whole
        }
    }

    /// How much two echoes show, to be compared.
    pub(super) fn with(self, other: Self) -> Self {
        if self == Self::Whole {
            other
        } else {
            Self::Part
        }
    }
}

/// An echo, of which the contact shows a part, as it would be if it showed as much of it as the track knows: what is
/// nearest to the sonar is where it is.
pub(super) fn at_radius(echo: &Detection, radius_m: f64, from: &Point3<f64>) -> Detection {
    Detection {
        position: echo.position - outwards(echo, from) * (echo.radius_m - radius_m),
        radius_m,
        ..*echo
    }
}

/// The direction from the sonar to an echo.
pub(super) fn outwards(echo: &Detection, from: &Point3<f64>) -> Vector3<f64> {
    let offset = echo.position - from;
    offset / offset.norm().max(1e-9)
}
