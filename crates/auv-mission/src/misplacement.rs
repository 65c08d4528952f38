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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use auv_graph::{Edge, Network, Task, Waypoint};
    use auv_ocean::SeaBed;
    use auv_types::{Bounds, Point3};
    use std::sync::Arc;

    /// 50 m deep, land north of 1,000 m.
    #[derive(Debug)]
    struct Coast;

    impl SeaBed for Coast {
        fn depth_at(&self, north_m: f64, _: f64) -> f64 {
            if north_m > 1_000.0 { -2.0 } else { 50.0 }
        }

        fn max_slope_near(&self, _: f64, _: f64, _: f64) -> f64 {
            f64::INFINITY
        }
    }

    #[test]
    fn every_waypoint_where_no_vehicle_can_be_is_told_with_reason_and_remedy() {
        let places = [
            [0.0, 0.0, 45.0],
            [0.0, 0.0, -1.5],
            [0.0, 120.0, 20.0],
            [1_100.0, 0.0, 20.0],
            [0.0, 0.0, 47.0],
            // Both outside the box and on land: the box is told first.
            [1_100.0, 110.0, 20.0],
        ];
        let waypoints = places.map(|place| Waypoint::at(Point3::from(place)));
        let edge = Edge::undirected(0, 1, Task::TRANSIT);
        let mut mission = Fixture::new().mission;
        mission.network = Arc::new(Network::new(&waypoints, &[edge], 3.0).unwrap());
        mission.sea_bed = Some(Arc::new(Coast));
        mission.min_altitude_m = 5.0;
        let (low, high) = ([-100.0, -100.0, 0.0], [2e3, 100.0, 99.0]);
        mission.bounds = Some(Bounds::new(low.into(), high.into()));
        let found = mission.misplacements();
        let told = found.iter().map(|(node, why)| {
            let text = format!("{why}; {}", why.remedy());
            (node.0, why.by_m(), text)
        });
        let wanted = [
            (
                1,
                1.5,
                "lies 1.5 m above the surface; depths count downwards, give at least 0",
            ),
            (2, 20.0, "lies 20.0 m outside the box; move it inside"),
            (
                3,
                0.0,
                "lies on land or outside the chart; move it into the water",
            ),
            (
                4,
                2.0,
                "at depth 47.0 m is below 45.0 m, the deepest allowed over the bed there; raise it",
            ),
            (5, 10.0, "lies 10.0 m outside the box; move it inside"),
        ];
        assert!(told.eq(wanted.map(|(node, by_m, text)| (node, by_m, text.to_owned()))));
        // The same texts keep the mission from starting.
        mission.destination = NodeId(1);
        let text = mission.validate().to_string();
        for (node, _, why) in wanted {
            let name = mission.name_of(NodeId(node));
            assert!(
                text.contains(&format!("waypoints[{node}] ({name}) {why}")),
                "{text}"
            );
        }
    }
}
