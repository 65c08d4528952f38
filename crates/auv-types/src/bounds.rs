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

impl Bounds {
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
}
