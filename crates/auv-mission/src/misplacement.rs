//! Waypoints where no vehicle can be.

use crate::Mission;
use auv_graph::NodeId;
use std::fmt;

/// Why a waypoint lies where the vehicle cannot be.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Misplacement {
    /// It lies above the surface.
    AboveSurface {
        /// By how much, metres.
        by_m: f64,
    },
    /// It lies outside the box.
    OutsideBox {
        /// How far, metres.
        by_m: f64,
    },
    /// It lies on land, or where the chart has no depth.
    OnLand,
    /// It lies below what the altitude over the bed allows.
    TooDeep {
        /// Its depth, metres.
        depth_m: f64,
        /// The deepest allowed there, metres.
        deepest_m: f64,
    },
}

impl Misplacement {
    /// How far it is from where it may be, metres; on land unknown, and 0.
    #[must_use]
    pub fn by_m(&self) -> f64 {
        match *self {
            Self::AboveSurface { by_m } | Self::OutsideBox { by_m } => by_m,
            Self::OnLand => 0.0,
            Self::TooDeep { depth_m, deepest_m } => depth_m - deepest_m,
        }
    }

    /// What to do about a waypoint.
    #[must_use]
    pub const fn remedy(&self) -> &'static str {
        match self {
            Self::AboveSurface { .. } => "depths count downwards, give at least 0",
            Self::OutsideBox { .. } => "move it inside",
            Self::OnLand => "move it into the water",
            Self::TooDeep { .. } => "raise it",
        }
    }
}

impl fmt::Display for Misplacement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AboveSurface { by_m } => write!(f, "lies {by_m:.1} m above the surface"),
            Self::OutsideBox { by_m } => write!(f, "lies {by_m:.1} m outside the box"),
            Self::OnLand => f.write_str("lies on land or outside the chart"),
            Self::TooDeep { depth_m, deepest_m } => write!(
                f,
                "at depth {depth_m:.1} m is below {deepest_m:.1} m, the deepest allowed over the bed there"
            ),
        }
    }
}

impl Mission {
    /// The waypoints where the vehicle cannot be, each with the first reason.
    #[must_use]
    pub fn misplacements(&self) -> Vec<(NodeId, Misplacement)> {
        let waypoints = self.network.waypoints().iter().enumerate();
        let found = waypoints.filter_map(|(i, waypoint)| {
            let p = &waypoint.position;
            let deepest_m = self.deepest_at(p.x, p.y);
            let bed = self.sea_bed.as_ref();
            let why = if p.z < 0.0 {
                Misplacement::AboveSurface { by_m: -p.z }
            } else if let Some(bounds) = self.bounds.filter(|bounds| !bounds.contains(p)) {
                let by_m = bounds.excess_m(p);
                Misplacement::OutsideBox { by_m }
            } else if bed.is_some_and(|bed| bed.depth_at(p.x, p.y) <= 0.0) {
                Misplacement::OnLand
            } else if p.z > deepest_m {
                let depth_m = p.z;
                Misplacement::TooDeep { depth_m, deepest_m }
            } else {
                return None;
            };
            Some((NodeId(i as u32), why))
        });
        found.collect()
    }
}
