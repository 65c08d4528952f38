//! Positions of a mission file in local coordinates.

use super::document::{Datum, DrawnNumber, Extent, MissionFile};
use super::place::Place;
use auv_ocean::{Geodetic, LocalFrame};
use auv_types::rand::RngExt;
use auv_types::{Bounds, ChaCha8Rng, Point3, Violations};

/// The local frame about the datum; `None` if the file states none or an invalid one.
pub(super) fn frame(datum: Option<Datum>, violations: &mut Violations) -> Option<LocalFrame> {
    let datum = datum?;
    let geodetic = Geodetic {
        latitude_deg: datum.latitude_deg,
        longitude_deg: datum.longitude_deg,
        depth_m: 0.0,
    };
    LocalFrame::new(geodetic)
        .map_err(|wrong| violations.absorb("datum.", wrong))
        .ok()
}

impl MissionFile {
    /// The local frame about the file's datum; `None` without a datum or with a malformed one.
    #[must_use]
    pub fn frame(&self) -> Option<LocalFrame> {
        frame(self.datum, &mut Violations::new())
    }
}

/// A position in local coordinates. A malformed one is a violation and gives the origin.
pub(super) fn point(
    at: &Place,
    frame: Option<&LocalFrame>,
    place: &str,
    violations: &mut Violations,
) -> Point3<f64> {
    match at {
        Place::Flat([x, y]) => point(&Place::Local([*x, *y, 0.0]), frame, place, violations),
        Place::Local(xyz) => {
            let fine = xyz.iter().all(|x| x.is_finite() && x.abs() <= 1e7);
            violations.require(fine, place, || {
                format!("is at {xyz:?}; give metres north, east and down within 10,000 km")
            });
            if fine {
                Point3::from(*xyz)
            } else {
                Point3::origin()
            }
        }
        Place::Geodetic(geodetic) => {
            let wrong = geodetic.validate();
            let Some(frame) = frame else {
                violations.push(
                    place,
                    "is given in latitude and longitude; state the [datum] of the local frame",
                );
                return Point3::origin();
            };
            if wrong.is_empty() {
                frame.to_local(geodetic)
            } else {
                violations.absorb(&format!("{place}."), wrong);
                Point3::origin()
            }
        }
    }
}

/// The box in local metres. A malformed one is a violation and gives `None`.
pub(super) fn bounds(
    extent: Option<&Extent>,
    frame: Option<&LocalFrame>,
    violations: &mut Violations,
) -> Option<Bounds> {
    let extent = extent?;
    let bounds = match (
        extent.north_m.zip(extent.east_m),
        extent.latitude_deg.zip(extent.longitude_deg),
        frame,
    ) {
        (Some((north_m, east_m)), None, _) => Bounds::new(
            Point3::new(north_m[0], east_m[0], extent.depth_m[0]),
            Point3::new(north_m[1], east_m[1], extent.depth_m[1]),
        ),
        (None, Some((latitude_deg, longitude_deg)), Some(frame)) => {
            within(frame, latitude_deg, longitude_deg, extent.depth_m)
        }
        (None, Some(_), None) => {
            violations.push(
                "box",
                "is given in latitude and longitude; state the [datum] of the local frame",
            );
            return None;
        }
        _ => {
            violations.push(
                "box",
                "needs north_m and east_m, or latitude_deg and longitude_deg; give one pair",
            );
            return None;
        }
    };
    let sound = bounds.is_valid()
        && (0..3).all(|k| {
            bounds.low[k] < bounds.high[k] && bounds.low[k] >= -1e7 && bounds.high[k] <= 1e7
        });
    violations.require(sound, "box", || {
        "has bounds that are not ordered or not within 10,000 km; give [low, high]".into()
    });
    let submerged = bounds.low.z >= 0.0;
    violations.require(!sound || submerged, "box.depth_m", || {
        let above_m = -bounds.low.z;
        format!("begins {above_m} m above the surface; depths count downwards, begin at 0 or below")
    });
    (sound && submerged).then_some(bounds)
}

/// The largest rectangle, north up, inside the quadrilateral of the four corners.
fn within(
    frame: &LocalFrame,
    latitude: [f64; 2],
    longitude: [f64; 2],
    depth_m: [f64; 2],
) -> Bounds {
    let corner = |i: usize, j: usize| {
        frame.to_local(&Geodetic {
            latitude_deg: latitude[i],
            longitude_deg: longitude[j],
            depth_m: 0.0,
        })
    };
    let (sw, se, nw, ne) = (corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1));
    Bounds::new(
        Point3::new(sw.x.max(se.x), sw.y.max(nw.y), depth_m[0]),
        Point3::new(nw.x.min(ne.x), se.y.min(ne.y), depth_m[1]),
    )
}

impl DrawnNumber {
    /// The number, or a value drawn uniformly from the interval. A malformed interval is a violation.
    pub(super) fn draw(
        self,
        place: &str,
        random: &mut ChaCha8Rng,
        violations: &mut Violations,
    ) -> f64 {
        let [low, high] = match self {
            Self::Exactly(value) => [value, value],
            Self::Between(ends) => ends,
        };
        let sound = low.is_finite() && high.is_finite() && low <= high;
        violations.require(sound, place, || {
            format!("is [{low}, {high}]; give finite numbers, the lower one first")
        });
        let share: f64 = random.random();
        if sound {
            low + share * (high - low)
        } else {
            1.0
        }
    }
}

/// A cell size that is not positive or too large is a violation.
pub(super) fn check_cell(cell_m: Option<f64>, place: &str, violations: &mut Violations) {
    let sound = cell_m.is_none_or(|cell_m| cell_m > 0.0 && cell_m <= 100_000.0);
    violations.require(sound, place, || {
        let given = cell_m.unwrap_or_default();
        format!("is {given}; give metres above 0, at most 100000")
    });
}
