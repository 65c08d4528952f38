//! Conversion between latitude and longitude and local metres.

use auv_types::{Point3, Violations, libm};
use geographiclib_rs::{DirectGeodesic, Geodesic, InverseGeodesic};

/// A position on the WGS84 ellipsoid with a depth below the sea surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Geodetic {
    /// Degrees north, -90 to 90.
    pub latitude_deg: f64,
    /// Degrees east, -180 to 180; values up to 360 are accepted.
    pub longitude_deg: f64,
    /// Depth below the surface, metres, positive down.
    #[cfg_attr(feature = "serde", serde(default))]
    pub depth_m: f64,
}

/// Depth below the surface, metres, positive down: the `z` of a local point.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(transparent)
)]
pub struct Depth(pub f64);

/// Height above the sea bed, metres, positive up. Not to be confused with [`Depth`].
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(transparent)
)]
pub struct Altitude(pub f64);

impl Depth {
    /// The altitude of a point at this depth above a bed.
    #[must_use]
    pub fn above(self, bed: Self) -> Altitude {
        Altitude(bed.0 - self.0)
    }
}

impl Altitude {
    /// The depth of a point at this altitude above a bed.
    #[must_use]
    pub fn over(self, bed: Depth) -> Depth {
        Depth(bed.0 - self.0)
    }
}

/// A local frame (north, east, down in metres) about a datum on the sea surface.
///
/// Horizontally it is the azimuthal equidistant projection of WGS84. Distance and bearing from the datum
/// are exact; distances between positions within 30 km of it are correct to 4 parts in a million. Depth is
/// unchanged, whereas a tangent plane would deviate by 7.8 m at 10 km and by 71 m at 30 km.
///
/// ```
/// use auv_ocean::{Geodetic, LocalFrame};
///
/// let datum = Geodetic { latitude_deg: 49.62, longitude_deg: -124.84, depth_m: 0.0 };
/// let frame = LocalFrame::new(datum).expect("a place on Earth");
/// let place = Geodetic { latitude_deg: 49.65, longitude_deg: -124.80, depth_m: 25.0 };
/// let point = frame.to_local(&place);
/// assert!((point.x - 3_338.0).abs() < 5.0 && point.z == 25.0);
/// let back = frame.to_geodetic(&point);
/// assert!((back.latitude_deg - place.latitude_deg).abs() < 1e-9);
/// ```
#[derive(Clone, Debug)]
pub struct LocalFrame {
    datum: Geodetic,
    ellipsoid: Geodesic,
}

impl Geodetic {
    /// Everything malformed about the position.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let (latitude, longitude) = (self.latitude_deg, self.longitude_deg);
        violations.require(latitude.abs() <= 90.0, "latitude_deg", || {
            format!("is {latitude}; give degrees north from -90 to 90")
        });
        violations.require(
            (-180.0..=360.0).contains(&longitude),
            "longitude_deg",
            || format!("is {longitude}; give degrees east from -180 to 180"),
        );
        violations.require(self.depth_m.is_finite(), "depth_m", || {
            "is not finite; give metres below the surface".into()
        });
        violations
    }
}

impl LocalFrame {
    /// A frame about a datum. The datum's depth is ignored.
    ///
    /// # Errors
    /// The violations of an invalid datum.
    pub fn new(datum: Geodetic) -> Result<Self, Violations> {
        datum.validate().into_result()?;
        Ok(Self {
            datum,
            ellipsoid: Geodesic::wgs84(),
        })
    }

    /// The position of the local origin.
    #[must_use]
    pub fn datum(&self) -> Geodetic {
        self.datum
    }

    /// The local coordinates of a valid position, metres.
    #[must_use]
    pub fn to_local(&self, place: &Geodetic) -> Point3<f64> {
        let (north_m, east_m, _) = self.project(place.latitude_deg, place.longitude_deg);
        Point3::new(north_m, east_m, place.depth_m)
    }

    /// The position of a local point: the inverse of [`LocalFrame::to_local`] within 1e-6 m.
    #[must_use]
    pub fn to_geodetic(&self, point: &Point3<f64>) -> Geodetic {
        let bearing_deg = libm::atan2(point.y, point.x).to_degrees();
        let (latitude_deg, longitude_deg): (f64, f64) = self.ellipsoid.direct(
            self.datum.latitude_deg,
            self.datum.longitude_deg,
            bearing_deg,
            libm::hypot(point.x, point.y),
        );
        Geodetic {
            latitude_deg,
            longitude_deg,
            depth_m: point.z,
        }
    }

    /// The bearing of true north at a position, in the local frame, radians clockwise: 0 at the datum, some
    /// tenths of a degree at 30 km. The sum of this bearing and a true direction (a ship's course, a model's
    /// current) is the local direction.
    #[must_use]
    pub fn bearing_of_true_north(&self, place: &Geodetic) -> f64 {
        self.project(place.latitude_deg, place.longitude_deg).2
    }

    /// Geodesic distance between two positions at the surface, metres.
    #[must_use]
    pub fn distance_m(&self, from: &Geodetic, to: &Geodetic) -> f64 {
        self.ellipsoid.inverse(
            from.latitude_deg,
            from.longitude_deg,
            to.latitude_deg,
            to.longitude_deg,
        )
    }

    /// North, east and the bearing of true north. A geodesic leaves the datum at one bearing and arrives at
    /// another; in the local frame it is a straight line.
    pub(crate) fn project(&self, latitude_deg: f64, longitude_deg: f64) -> (f64, f64, f64) {
        let (distance_m, leaving_deg, arriving_deg, _): (f64, f64, f64, f64) =
            self.ellipsoid.inverse(
                self.datum.latitude_deg,
                self.datum.longitude_deg,
                latitude_deg,
                longitude_deg,
            );
        let (sin, cos) = libm::sincos(leaving_deg.to_radians());
        (
            distance_m * cos,
            distance_m * sin,
            (leaving_deg - arriving_deg).to_radians(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Seed;
    use auv_types::rand::RngExt;

    fn frame() -> LocalFrame {
        LocalFrame::new(Geodetic {
            latitude_deg: 49.62,
            longitude_deg: -124.84,
            depth_m: 0.0,
        })
        .unwrap()
    }

    fn points_within_30_km() -> impl Iterator<Item = Point3<f64>> {
        let mut random = Seed(2).stream(0);
        (0..500).map(move |_| {
            let (sin, cos) = libm::sincos(random.random_range(0.0..std::f64::consts::TAU));
            let distance_m = random.random_range(0.0..30_000.0);
            Point3::new(distance_m * cos, distance_m * sin, 25.0)
        })
    }

    #[test]
    fn round_trips_within_a_millimetre_at_30_km() {
        let frame = frame();
        for point in points_within_30_km() {
            let back = frame.to_local(&frame.to_geodetic(&point));
            assert!((back - point).norm() < 1e-6, "{point} {back}");
            assert_eq!(back.z, point.z);
        }
    }

    #[test]
    fn distances_agree_with_the_geodesic() {
        let frame = frame();
        let points: Vec<_> = points_within_30_km().collect();
        for pair in points.windows(2) {
            let (a, b) = (frame.to_geodetic(&pair[0]), frame.to_geodetic(&pair[1]));
            let local_m = (pair[1] - pair[0]).norm();
            let error = (local_m - frame.distance_m(&a, &b)).abs();
            assert!(error <= 4e-6 * local_m + 1e-6, "{error} m of {local_m} m");
            let from_datum_m = frame.distance_m(&frame.datum(), &a);
            assert!((from_datum_m - pair[0].coords.xy().norm()).abs() < 1e-6);
        }
    }

    #[test]
    fn the_bearing_of_true_north_is_that_of_a_step_north() {
        let frame = frame();
        for point in points_within_30_km() {
            let place = frame.to_geodetic(&point);
            let further = Geodetic {
                latitude_deg: place.latitude_deg + 1e-4,
                ..place
            };
            let step = frame.to_local(&further) - point;
            let lean = libm::atan2(step.y, step.x);
            assert!((lean - frame.bearing_of_true_north(&place)).abs() < 1e-5);
        }
    }

    #[test]
    fn an_invalid_position_is_refused() {
        let place = Geodetic {
            latitude_deg: 95.0,
            longitude_deg: f64::NAN,
            depth_m: 0.0,
        };
        assert_eq!(LocalFrame::new(place).unwrap_err().total(), 2);
    }

    #[test]
    fn altitude_and_depth_convert_into_each_other() {
        let bed = Depth(80.0);
        assert_eq!(Depth(25.0).above(bed), Altitude(55.0));
        assert_eq!(Altitude(5.0).over(bed), Depth(75.0));
    }
}
