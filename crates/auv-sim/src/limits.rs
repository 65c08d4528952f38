//! The limits that a mission asks to be kept, and how far the true track broke them.

use auv_mission::Mission;
use auv_types::Bounds;
use std::fmt;

/// A limit that a mission asks to be kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Limit {
    /// The least altitude over the true sea bed. The standard deviations that plans add to it are a margin
    /// for what the chart does not know; they are no limit of the true track.
    Altitude,
    /// The box; without one, the surface. It is broken when the vehicle is farther outside than its greatest
    /// guidance error: plans may lead along its faces.
    Box,
    /// The mission's clearance to the true surface of any obstacle. The margins by source of a region
    /// ([`auv_obstacles::ClearancePolicy`]) allow for errors of predictions; they are no limit of the true
    /// track.
    Clearance,
    /// The prisms of `keep_out`.
    KeepOut,
    /// The prisms of `keep_in`.
    KeepIn,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Altitude => "altitude",
            Self::Box => "box",
            Self::Clearance => "clearance",
            Self::KeepOut => "keep_out",
            Self::KeepIn => "keep_in",
        })
    }
}

/// A limit that the true track broke, where it broke it most.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LimitBroken {
    /// Which limit.
    pub limit: Limit,
    /// When it was broken most, mission time in seconds.
    pub at_s: f64,
    /// By how much then, metres.
    pub by_m: f64,
}

impl fmt::Display for LimitBroken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} by {:.2} m at {:.0} s",
            self.limit, self.by_m, self.at_s
        )
    }
}

/// What a mission asks of the true track.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked {
    pub(crate) altitude_m: f64,
    pub(crate) bounds: Bounds,
    /// How far outside the box the vehicle may be, metres.
    pub(crate) slack_m: f64,
    pub(crate) clearance_m: f64,
}

impl Asked {
    pub(crate) fn of(mission: &Mission, guidance_error_m: f64) -> Self {
        Self {
            altitude_m: mission.min_altitude_m,
            bounds: mission.limits(),
            slack_m: guidance_error_m,
            clearance_m: mission.clearance_m,
        }
    }
}

/// Below this an excess is rounding, metres.
const ROUNDING_M: f64 = 1e-6;

/// Adds an excess to a list of at most one entry a limit: the worst of each, in the order in which the limits
/// were first broken.
pub(crate) fn note(broken: &mut Vec<LimitBroken>, limit: Limit, at_s: f64, by_m: f64) {
    if by_m.is_nan() || by_m <= ROUNDING_M {
        return;
    }
    let now = LimitBroken { limit, at_s, by_m };
    match broken.iter_mut().find(|before| before.limit == limit) {
        Some(before) if by_m > before.by_m => *before = now,
        Some(_) => {}
        None => broken.push(now),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_of_each_limit_is_kept() {
        let mut broken = Vec::new();
        note(&mut broken, Limit::Box, 1.0, 0.0);
        note(&mut broken, Limit::Box, 2.0, f64::NAN);
        assert!(broken.is_empty());
        note(&mut broken, Limit::Altitude, 3.0, 1.0);
        note(&mut broken, Limit::Box, 4.0, 2.0);
        note(&mut broken, Limit::Altitude, 5.0, 1.5);
        note(&mut broken, Limit::Altitude, 6.0, 0.5);
        let texts: Vec<String> = broken.iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["altitude by 1.50 m at 5 s", "box by 2.00 m at 4 s"]);
    }
}
