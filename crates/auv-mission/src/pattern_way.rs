//! The way of a pattern while it is put together, piece by piece.

use auv_planning::Vehicle;
use auv_planning::motion::{ConnectionEnd, ConnectionStart, Pose, connections_between};
use auv_types::{Point3, Vector3, libm};
use std::f64::consts::TAU;

/// Places on a circle where the vehicle may join it.
const JOINS: usize = 16;
/// Depths that differ by less are one, metres.
const SAME_DEPTH_M: f64 = 1e-3;

/// A way under construction.
pub(crate) struct Way<'v> {
    vehicle: &'v Vehicle,
    pub(crate) points: Vec<Point3<f64>>,
    /// The direction at its end; zero: any.
    pub(crate) direction: Vector3<f64>,
    /// Which of the connections is taken.
    pub(crate) variant: usize,
}

impl<'v> Way<'v> {
    pub(crate) fn from(
        vehicle: &'v Vehicle,
        place: Point3<f64>,
        velocity: &Vector3<f64>,
        variant: usize,
    ) -> Self {
        Self {
            vehicle,
            points: vec![place],
            direction: *velocity,
            variant,
        }
    }

    fn begins(&self) -> ConnectionStart {
        let place = self.points[self.points.len() - 1];
        let direction = self.direction;
        match direction.norm() > 1e-6 && self.vehicle.turn_radius_m > 0.0 {
            true => ConnectionStart::Pose(Pose { place, direction }),
            false => ConnectionStart::Place(place),
        }
    }

    /// Goes on to a place, if it is not there.
    pub(crate) fn lead_to(&mut self, end: ConnectionEnd) -> Option<()> {
        let here = self.points[self.points.len() - 1];
        let (ConnectionEnd::Pose(Pose { place, .. }) | ConnectionEnd::Place(place)) = end;
        let is_turned = match end {
            ConnectionEnd::Pose(pose) => {
                let (now, then) = (self.direction, pose.direction);
                self.vehicle.turn_radius_m <= 0.0
                    || now.dot(&then) > 0.9999 * now.norm() * then.norm()
            }
            ConnectionEnd::Place(_) => true,
        };
        if (place - here).norm() < SAME_DEPTH_M && is_turned {
            return Some(());
        }
        let found = connections_between(self.vehicle, self.begins(), end);
        let way = found.get(self.variant.min(found.len().saturating_sub(1)))?;
        self.points.extend(way.points.iter().skip(1));
        self.turn_to_last();
        if let ConnectionEnd::Pose(pose) = end {
            self.direction = pose.direction;
        }
        Some(())
    }

    /// Goes on to the circle round a place, to the right (positive radius) or left, where that is quickest.
    pub(crate) fn join_circle(&mut self, centre: Point3<f64>, radius_m: f64) -> Option<()> {
        let joins = (0..JOINS).map(|k| {
            let (sin, cos) = libm::sincos(TAU * k as f64 / JOINS as f64);
            let outwards = Vector3::new(cos, sin, 0.0);
            Pose {
                place: centre + outwards * radius_m.abs(),
                direction: Vector3::new(-sin, cos, 0.0) * radius_m.signum(),
            }
        });
        let found = joins.filter_map(|pose| {
            let ways = connections_between(self.vehicle, self.begins(), ConnectionEnd::Pose(pose));
            Some((ways.into_iter().next()?, pose.direction))
        });
        let (way, direction) = found.min_by(|a, b| a.0.length_m.total_cmp(&b.0.length_m))?;
        self.points.extend(way.points.iter().skip(1));
        self.direction = direction;
        Some(())
    }

    /// The direction is that of the last piece.
    pub(crate) fn turn_to_last(&mut self) {
        if let [.., before, last] = self.points[..] {
            self.direction = last - before;
        }
    }
}
