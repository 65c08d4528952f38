//! The box a vehicle may move in.

use nalgebra::Point3;

/// An axis-aligned box; both corners belong to it. Metres, NED.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bounds {
    /// Corner with the smallest coordinates.
    pub low: Point3<f64>,
    /// Corner with the largest coordinates.
    pub high: Point3<f64>,
}

/// Where "anywhere" ends, metres: positions are valid within 10,000 km.
const FARTHEST_M: f64 = 1e7;

impl Bounds {
    /// Everywhere below the surface: the limit of a vehicle that has no box.
    pub const BELOW_SURFACE: Self = Self::new(
        Point3::new(-FARTHEST_M, -FARTHEST_M, 0.0),
        Point3::new(FARTHEST_M, FARTHEST_M, FARTHEST_M),
    );

    /// A box from its two extreme corners.
    #[must_use]
    pub const fn new(low: Point3<f64>, high: Point3<f64>) -> Self {
        Self { low, high }
    }

    /// Whether a point lies in the box.
    #[must_use]
    #[inline]
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        (0..3).all(|k| self.low[k] <= point[k] && point[k] <= self.high[k])
    }

    /// Length of the diagonal, metres; `None` for [`Self::BELOW_SURFACE`] and whatever is as wide.
    #[must_use]
    pub fn diagonal_m(&self) -> Option<f64> {
        let size = self.high - self.low;
        (size.x < 2.0 * FARTHEST_M || size.y < 2.0 * FARTHEST_M).then(|| size.norm())
    }

    /// How far outside the box a point lies in metres: the largest excess over the axes, 0 inside.
    #[must_use]
    pub fn excess_m(&self, point: &Point3<f64>) -> f64 {
        (0..3)
            .map(|k| (self.low[k] - point[k]).max(point[k] - self.high[k]))
            .fold(0.0, f64::max)
    }

    /// The point of the box nearest to `point`.
    #[must_use]
    pub fn clamp(&self, point: &Point3<f64>) -> Point3<f64> {
        Point3::from(
            point
                .coords
                .zip_map(&self.low.coords, f64::max)
                .zip_map(&self.high.coords, f64::min),
        )
    }

    /// The smallest box that contains this one and a point.
    #[must_use]
    pub fn grown_to(&self, point: &Point3<f64>) -> Self {
        Self {
            low: self.low.inf(point),
            high: self.high.sup(point),
        }
    }

    /// Whether both corners are finite and ordered on every axis.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        (0..3).all(|k| {
            self.low[k].is_finite() && self.high[k].is_finite() && self.low[k] <= self.high[k]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excess_is_zero_inside_and_the_largest_axis_outside() {
        let unit = Bounds::new(Point3::origin(), Point3::new(1.0, 1.0, 1.0));
        assert!(unit.contains(&Point3::new(1.0, 0.0, 0.5)));
        assert!((unit.excess_m(&Point3::new(1.5, -2.0, 0.5)) - 2.0).abs() < 1e-15);
        assert!(unit.contains(&unit.clamp(&Point3::new(9.0, -9.0, 0.3))));
    }

    #[test]
    fn below_the_surface_is_everything_but_the_air_and_has_no_size() {
        let sea = Bounds::BELOW_SURFACE;
        assert!(sea.is_valid() && sea.contains(&Point3::new(-9e6, 9e6, 0.0)));
        assert_eq!(sea.excess_m(&Point3::new(0.0, 0.0, -3.0)), 3.0);
        assert_eq!(
            sea.grown_to(&Point3::new(0.0, 0.0, -3.0)).diagonal_m(),
            None
        );
        let unit = Bounds::new(Point3::origin(), Point3::new(2.0, 2.0, 1.0));
        assert_eq!(unit.diagonal_m(), Some(3.0));
    }
}
