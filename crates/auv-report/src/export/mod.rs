//! A flown mission for other programs: one format a file.
//!
//! Latitude and longitude are degrees on WGS84, by the [`LocalFrame`] about the mission's datum, to
//! 1e-9 degrees (0.1 mm). Lengths are metres, to a millimetre. Vertically there are two quantities
//! and every column, property and file says which it holds: *depth*, positive down from the sea
//! surface (the local `z`), and *elevation*, positive up from the same surface, so minus the depth.
//! Neither is a height above the WGS84 ellipsoid; tide and geoid are not in the data.

#[cfg(feature = "export")]
mod antimeridian;
mod csv;
#[cfg(feature = "export")]
mod geojson;
#[cfg(feature = "export")]
mod kml;
#[cfg(feature = "export")]
mod plan;
#[cfg(feature = "export")]
mod read;
#[cfg(feature = "export")]
mod way;

pub use csv::track_csv;
#[cfg(feature = "export")]
pub use geojson::mission_geojson;
#[cfg(feature = "export")]
pub use kml::track_kml;
#[cfg(feature = "export")]
pub use plan::{route_plan, track_plan};
#[cfg(feature = "export")]
pub use read::read_track;

use auv_ocean::LocalFrame;
use auv_types::Point3;

/// Why a mission was not exported.
#[cfg(feature = "export")]
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The picture holds no mission.
    #[error(
        "no mission was recorded; give the picture to simulate() as its recorder, or begin with MissionPicture::of_flight"
    )]
    NotRecorded,
    /// A route visits a waypoint its network does not have.
    #[error("the route visits node {0}, which the network does not have; give a route of it")]
    UnknownNode(u32),
    /// The JSON writer failed.
    #[error("JSON could not be written: {0}")]
    Json(#[from] serde_json::Error),
    /// The KML writer failed.
    #[error("KML could not be written: {0}")]
    Kml(#[from] ::kml::Error),
}

/// A point as exports write it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    latitude_deg: f64,
    longitude_deg: f64,
    /// Height above the sea surface, metres, positive up: minus the depth.
    #[cfg(feature = "export")]
    elevation_m: f64,
}

impl Place {
    fn of(point: &Point3<f64>, frame: &LocalFrame) -> Self {
        let place = frame.to_geodetic(point);
        Self {
            latitude_deg: rounded(place.latitude_deg, 1e9),
            longitude_deg: rounded(place.longitude_deg, 1e9),
            #[cfg(feature = "export")]
            elevation_m: rounded(-place.depth_m, 1e3),
        }
    }
}

/// A value rounded to a fraction of one; zero has no sign.
fn rounded(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts + 0.0
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::MissionPicture;
    use auv_mission::driver::Stepped;
    use auv_ocean::Geodetic;
    use auv_planning::baseline::{GreedyRoute, StraightPath};
    use auv_sim::{Campaign, simulate};
    use auv_types::Seed;

    pub(crate) fn flown() -> MissionPicture {
        let campaign = Campaign::table2(Seed(3)).unwrap();
        let mut picture = MissionPicture::new();
        let driver = Stepped::new(&GreedyRoute, &StraightPath);
        simulate(&campaign.scenario(0).unwrap(), &driver, &mut picture).unwrap();
        picture
    }

    pub(super) fn frame() -> LocalFrame {
        LocalFrame::new(Geodetic {
            latitude_deg: 56.5,
            longitude_deg: -5.25,
            depth_m: 0.0,
        })
        .unwrap()
    }

    /// The local point that a written place stands for.
    pub(super) fn back(longitude_deg: f64, latitude_deg: f64, elevation_m: f64) -> Point3<f64> {
        frame().to_local(&Geodetic {
            latitude_deg,
            longitude_deg,
            depth_m: -elevation_m,
        })
    }

    #[cfg(feature = "export")]
    #[test]
    fn a_place_comes_back_within_a_millimetre_at_10_km() {
        for k in 0..64 {
            let (sin, cos) = auv_types::libm::sincos(f64::from(k) * 0.1);
            let point = Point3::new(10_000.0 * cos, 10_000.0 * sin, 0.4321 * f64::from(k));
            let place = Place::of(&point, &frame());
            assert!(place.elevation_m <= 0.0);
            let again = back(place.longitude_deg, place.latitude_deg, place.elevation_m);
            assert!((again - point).norm() < 1e-3, "{point} {again}");
        }
    }
}
