//! Universal Transverse Mercator, from eastings and northings to degrees.

use auv_types::libm;

/// A zone of the projection on WGS84.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Zone {
    /// 1 to 60.
    pub(super) number: u16,
    /// Whether northings count from 10,000 km south of the equator.
    pub(super) south: bool,
}

const SEMI_MAJOR_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;
const SCALE: f64 = 0.9996;

impl Zone {
    /// Latitude and longitude of a point, degrees, by Krueger's series to the fourth order of the third
    /// flattening: exact to a micrometre within 3,000 km of the central meridian.
    pub(super) fn degrees(self, easting_m: f64, northing_m: f64) -> [f64; 2] {
        let n = FLATTENING / (2.0 - FLATTENING);
        let (n2, n3, n4) = (n * n, n * n * n, n * n * n * n);
        let radius_m = SEMI_MAJOR_M / (1.0 + n) * (1.0 + n2 / 4.0 + n4 / 64.0);
        let beta = [
            n / 2.0 - 2.0 / 3.0 * n2 + 37.0 / 96.0 * n3 - n4 / 360.0,
            n2 / 48.0 + n3 / 15.0 - 437.0 / 1_440.0 * n4,
            17.0 / 480.0 * n3 - 37.0 / 840.0 * n4,
            4_397.0 / 161_280.0 * n4,
        ];
        let false_northing_m = if self.south { 1e7 } else { 0.0 };
        let xi = (northing_m - false_northing_m) / (SCALE * radius_m);
        let eta = (easting_m - 5e5) / (SCALE * radius_m);
        let (mut xi_sphere, mut eta_sphere) = (xi, eta);
        for (k, beta) in (1_u8..).zip(beta) {
            let k = 2.0 * f64::from(k);
            let (sin, cos) = libm::sincos(k * xi);
            xi_sphere -= beta * sin * libm::cosh(k * eta);
            eta_sphere -= beta * cos * libm::sinh(k * eta);
        }
        let (sin, cos) = libm::sincos(xi_sphere);
        let across = libm::sinh(eta_sphere);
        let conformal = sin / libm::sqrt(across * across + cos * cos);
        let meridian_deg = f64::from(self.number) * 6.0 - 183.0;
        let longitude_deg = meridian_deg + libm::atan2(across, cos).to_degrees();
        [
            libm::atan(geodetic_tangent(conformal)).to_degrees(),
            longitude_deg,
        ]
    }
}

/// The tangent of the geodetic latitude from that of the conformal one, by Newton's method.
fn geodetic_tangent(conformal: f64) -> f64 {
    let square = FLATTENING * (2.0 - FLATTENING);
    let eccentricity = libm::sqrt(square);
    let mut tangent = conformal / (1.0 - square);
    for _ in 0..6 {
        let secant = libm::sqrt(1.0 + tangent * tangent);
        let sigma = libm::sinh(eccentricity * libm::atanh(eccentricity * tangent / secant));
        let met = tangent * libm::sqrt(1.0 + sigma * sigma) - sigma * secant;
        let step = (conformal - met) / libm::sqrt(1.0 + met * met)
            * (1.0 + (1.0 - square) * tangent * tangent)
            / ((1.0 - square) * secant);
        tangent += step;
        if step.abs() < 1e-15 * (1.0 + tangent.abs()) {
            break;
        }
    }
    tangent
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Geodetic, LocalFrame};

    fn place([latitude_deg, longitude_deg]: [f64; 2]) -> Geodetic {
        Geodetic {
            latitude_deg,
            longitude_deg,
            depth_m: 0.0,
        }
    }

    #[test]
    fn the_central_meridian_has_its_scale_and_all_else_is_conformal() {
        let zone = Zone {
            number: 32,
            south: false,
        };
        let equator = place(zone.degrees(5e5, 0.0));
        assert!(equator.latitude_deg.abs() < 1e-12 && (equator.longitude_deg - 9.0).abs() < 1e-12);
        for northing_m in [1e5, 2e6, 6.5e6, 8e6] {
            let there = place(zone.degrees(5e5, northing_m));
            assert!((there.longitude_deg - 9.0).abs() < 1e-12);
            let frame = LocalFrame::new(equator).unwrap();
            let geodesic_m = frame.distance_m(&equator, &there);
            assert!(
                (geodesic_m * SCALE - northing_m).abs() < 1e-5,
                "{northing_m} {geodesic_m}"
            );
        }
        // Steps of a kilometre east and north are equally long and at right angles on the ground.
        for (easting_m, northing_m) in [(3e5, 5e6), (7.2e5, 6.5e6), (5.1e5, 1e6)] {
            let frame = LocalFrame::new(place(zone.degrees(easting_m, northing_m))).unwrap();
            let east = frame.to_local(&place(zone.degrees(easting_m + 1e3, northing_m)));
            let north = frame.to_local(&place(zone.degrees(easting_m, northing_m + 1e3)));
            let scale = libm::hypot(east.x, east.y) / libm::hypot(north.x, north.y);
            assert!((scale - 1.0).abs() < 1e-4, "{scale}");
            let cosine = (east.x * north.x + east.y * north.y) / 1e6;
            assert!(cosine.abs() < 1e-4, "{cosine}");
        }
    }

    #[test]
    fn a_published_point_and_the_southern_half_agree() {
        // The centre of square 38SMB4488 in the documentation of GeographicLib's GeoConvert.
        let north = Zone {
            number: 38,
            south: false,
        };
        let [latitude, longitude] = north.degrees(444_500.0, 3_688_500.0);
        assert!((latitude - 33.334_24).abs() < 6e-6 && (longitude - 44.403_63).abs() < 6e-6);
        let south = Zone {
            number: 38,
            south: true,
        };
        let [mirrored, same] = south.degrees(444_500.0, 1e7 - 3_688_500.0);
        assert!((mirrored + latitude).abs() < 1e-12 && (same - longitude).abs() < 1e-12);
    }
}
