//! Predicted regions and their exact clearance to a timed segment.

use auv_types::{Point3, Vector3, Violations};

/// A position at a mission time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TimedPoint {
    /// Position in metres (NED).
    pub position: Point3<f64>,
    /// Mission time in seconds.
    pub time_s: f64,
}

impl TimedPoint {
    /// A position at a mission time.
    #[must_use]
    pub const fn new(position: Point3<f64>, time_s: f64) -> Self {
        Self { position, time_s }
    }
}

/// The obstacle or track a region belongs to. Several consecutive regions may share one id.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(transparent)
)]
pub struct ObstacleId(pub u32);

/// The shape of a region.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RegionShape {
    /// All points within the radius of the centre.
    Ball,
    /// A vertical cylinder between two depths. The centre's `z` and vertical velocity are ignored.
    Cylinder {
        /// Depth of the upper end in metres (`-inf` reaches above the surface).
        #[cfg_attr(feature = "serde", serde(with = "crate::unbounded"))]
        top_m: f64,
        /// Depth of the lower end in metres, below `top_m`.
        #[cfg_attr(feature = "serde", serde(with = "crate::unbounded"))]
        bottom_m: f64,
    },
}

/// A region that an obstacle is predicted to cover: a ball or a vertical cylinder whose centre moves and
/// whose radius grows linearly within a time window. Outside the window it does not exist.
///
/// At mission time `t` in `[from_s, until_s]` the centre is `centre + velocity_mps (t - at_s)` and
/// the radius `radius_m + growth_mps (t - at_s)`. A negative radius is an empty region.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Region {
    /// The obstacle it bounds.
    pub obstacle: ObstacleId,
    /// Ball or vertical cylinder.
    pub shape: RegionShape,
    /// The time at which `centre` and `radius_m` hold, seconds.
    pub at_s: f64,
    /// Start of the window, seconds (may be `-inf`).
    #[cfg_attr(feature = "serde", serde(with = "crate::unbounded"))]
    pub from_s: f64,
    /// End of the window, seconds (may be `+inf`).
    #[cfg_attr(feature = "serde", serde(with = "crate::unbounded"))]
    pub until_s: f64,
    /// Centre at `at_s`, metres.
    pub centre: Point3<f64>,
    /// Velocity of the centre, m/s.
    pub velocity_mps: Vector3<f64>,
    /// Radius at `at_s`, metres.
    pub radius_m: f64,
    /// Growth of the radius, m/s.
    pub growth_mps: f64,
}

impl Region {
    /// A ball at rest, at all times.
    #[must_use]
    pub fn ball(centre: Point3<f64>, radius_m: f64) -> Self {
        Self {
            obstacle: ObstacleId(0),
            shape: RegionShape::Ball,
            at_s: 0.0,
            from_s: f64::NEG_INFINITY,
            until_s: f64::INFINITY,
            centre,
            velocity_mps: Vector3::zeros(),
            radius_m,
            growth_mps: 0.0,
        }
    }

    /// A vertical cylinder at rest, at all times.
    #[must_use]
    pub fn cylinder(centre: Point3<f64>, radius_m: f64, top_m: f64, bottom_m: f64) -> Self {
        Self {
            shape: RegionShape::Cylinder { top_m, bottom_m },
            ..Self::ball(centre, radius_m)
        }
    }

    /// Whether it is at rest and never ends, as what is charted. A region that is predicted moves, grows or
    /// ends.
    #[must_use]
    pub fn is_permanent(&self) -> bool {
        let unending = self.until_s == f64::INFINITY;
        unending && self.velocity_mps == Vector3::zeros() && self.growth_mps <= 0.0
    }

    /// The same region with every surface `margin_m` further out.
    #[must_use]
    pub fn inflated(mut self, margin_m: f64) -> Self {
        self.radius_m += margin_m;
        if let RegionShape::Cylinder { top_m, bottom_m } = &mut self.shape {
            *top_m -= margin_m;
            *bottom_m += margin_m;
        }
        self
    }

    /// The same region with a greater radius: as far as the vehicle's place on the map may be wrong. Its depth is
    /// measured, so a cylinder keeps its depths.
    #[must_use]
    pub fn widened(self, by_m: f64) -> Self {
        Self {
            radius_m: self.radius_m + by_m,
            ..self
        }
    }

    /// Adds everything malformed about the region to a list, under the name `place`.
    pub fn validate_into(&self, place: &str, violations: &mut Violations) {
        let finite = |values: &[f64]| values.iter().all(|x| x.is_finite() && x.abs() <= 1e9);
        violations.require(finite(self.centre.coords.as_slice()), place, || {
            "has a centre that is not finite or beyond 1e9; give metres".into()
        });
        violations.require(finite(self.velocity_mps.as_slice()), place, || {
            "has a velocity that is not finite or beyond 1e9; give m/s".into()
        });
        violations.require(
            finite(&[self.radius_m]) && self.radius_m >= 0.0,
            place,
            || {
                format!(
                    "has radius {:?}; give metres of at least 0, at most 1e9",
                    self.radius_m
                )
            },
        );
        violations.require(finite(&[self.growth_mps, self.at_s]), place, || {
            format!(
                "grows by {:?} m/s from {:?} s; give finite values up to 1e9",
                self.growth_mps, self.at_s
            )
        });
        violations.require(self.from_s <= self.until_s, place, || {
            format!(
                "exists from {} to {} s; give from <= until",
                self.from_s, self.until_s
            )
        });
        if let RegionShape::Cylinder { top_m, bottom_m } = self.shape {
            violations.require(top_m < bottom_m, place, || {
                format!("reaches from depth {top_m} to {bottom_m}; give top < bottom")
            });
        }
    }

    /// Whether [`Region::validate_into`] finds nothing malformed.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let mut violations = Violations::new();
        self.validate_into("", &mut violations);
        violations.is_empty()
    }

    /// Centre at a time, whether or not the time lies in the window.
    #[must_use]
    #[inline]
    pub fn centre_at(&self, time_s: f64) -> Point3<f64> {
        self.centre + self.velocity_mps * (time_s - self.at_s)
    }

    /// Radius at a time, whether or not the time lies in the window.
    #[must_use]
    #[inline]
    pub fn radius_at(&self, time_s: f64) -> f64 {
        self.radius_m + self.growth_mps * (time_s - self.at_s)
    }

    /// Whether the region exists at a time.
    #[must_use]
    #[inline]
    pub fn exists_at(&self, time_s: f64) -> bool {
        self.from_s <= time_s && time_s <= self.until_s
    }

    /// Signed distance from a point to the surface at the point's time: negative inside, `+inf`
    /// outside the window.
    #[must_use]
    #[inline]
    pub fn distance_m(&self, point: &TimedPoint) -> f64 {
        if !self.exists_at(point.time_s) {
            return f64::INFINITY;
        }
        let offset = point.position - self.centre_at(point.time_s);
        let radius_m = self.radius_at(point.time_s);
        match self.shape {
            RegionShape::Ball => offset.norm() - radius_m,
            RegionShape::Cylinder { top_m, bottom_m } => {
                let z = point.position.z;
                corner_distance(offset.xy().norm() - radius_m, (top_m - z).max(z - bottom_m))
            }
        }
    }
}

/// Signed distance to the quadrant `horizontal <= 0, vertical <= 0`.
pub(crate) fn corner_distance(horizontal_m: f64, vertical_m: f64) -> f64 {
    if horizontal_m > 0.0 && vertical_m > 0.0 {
        (horizontal_m * horizontal_m + vertical_m * vertical_m).sqrt()
    } else {
        horizontal_m.max(vertical_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Seed;
    use auv_types::rand::RngExt;

    fn sampled(region: &Region, from: &TimedPoint, to: &TimedPoint) -> f64 {
        (0..=20_000)
            .map(|i| {
                let f = f64::from(i) / 20_000.0;
                region.distance_m(&TimedPoint::new(
                    from.position + (to.position - from.position) * f,
                    from.time_s + (to.time_s - from.time_s) * f,
                ))
            })
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn clearance_is_the_least_of_dense_samples() {
        let mut random = Seed(11).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        for case in 0..300 {
            let mut region = Region::ball(
                Point3::new(draw(-50.0, 50.0), draw(-50.0, 50.0), draw(0.0, 60.0)),
                draw(1.0, 40.0),
            );
            if case % 2 == 1 {
                let top = draw(0.0, 30.0);
                region.shape = RegionShape::Cylinder {
                    top_m: top,
                    bottom_m: top + draw(1.0, 30.0),
                };
            }
            region.velocity_mps = Vector3::new(draw(-2.0, 2.0), draw(-2.0, 2.0), draw(-1.0, 1.0));
            region.growth_mps = draw(-0.2, 1.0);
            region.at_s = draw(-10.0, 10.0);
            let from = TimedPoint::new(
                Point3::new(draw(-90.0, 0.0), draw(-90.0, 0.0), draw(0.0, 60.0)),
                draw(0.0, 5.0),
            );
            let to = TimedPoint::new(
                Point3::new(draw(0.0, 90.0), draw(0.0, 90.0), draw(0.0, 60.0)),
                from.time_s + draw(1.0, 60.0),
            );
            let exact = region.clearance(&from, &to).clearance_m;
            let coarse = sampled(&region, &from, &to);
            assert!(
                exact <= coarse + 1e-9,
                "case {case}: exact {exact} above sampled {coarse}"
            );
            assert!(
                coarse - exact < 0.02,
                "case {case}: exact {exact} far below {coarse}"
            );
        }
    }

    #[test]
    fn a_region_outside_its_window_does_not_exist() {
        let mut region = Region::ball(Point3::origin(), 5.0);
        region.from_s = 100.0;
        let from = TimedPoint::new(Point3::new(-10.0, 0.0, 0.0), 0.0);
        let to = TimedPoint::new(Point3::new(10.0, 0.0, 0.0), 20.0);
        assert!(region.clearance(&from, &to).clearance_m.is_infinite());
        region.from_s = 10.0;
        assert!((region.clearance(&from, &to).clearance_m + 5.0).abs() < 1e-9);
    }
}
