//! Whether a vehicle has room to stay at a place, within box and above the bed.

use crate::Mission;
use crate::station_keeping::arc;
use auv_planning::motion::tightest_circle_m;
use auv_types::{Point3, Vector3, libm};
use std::f64::consts::TAU;
use std::fmt;

/// Directions from a place in which the centre of a circle is tried.
const DIRECTIONS: u32 = 16;
/// Radii of the circles that are tried, in those of the tightest.
const RADII: [f64; 2] = [1.0, 2.0];
/// Ways on from a place that has no room for a circle: lengths in metres.
const LEADS_M: [f64; 4] = [25.0, 50.0, 100.0, 200.0];
/// Share of the greatest pitch at which a way on climbs.
const CLIMB_SHARE: f64 = 0.9;
/// A circle that lacks no more than this fits, metres: rounding.
const ROUNDING_M: f64 = 1e-6;
/// Remedies are depths in whole steps of this, metres.
const DEPTH_STEP_M: f64 = 0.5;

/// The room of a vehicle at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Room {
    /// The vehicle can stay: it hovers, or a circle fits.
    Stays,
    /// No circle fits, but a short way leads on to where one does.
    LeadsOn(Shortage),
    /// The vehicle can neither stay nor go on.
    None(Shortage),
}

/// What keeps the tightest circle at a place from fitting. Its text names the remedy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shortage {
    /// Radius of the circle, metres.
    pub radius_m: f64,
    /// By how much it leaves the box, metres.
    pub beyond_box_m: f64,
    /// By how much it goes below the deepest allowed over the bed, metres.
    pub below_m: f64,
    /// The greatest depth at which a circle fits here, metres; `None` if it fits at no depth.
    pub raise_to_m: Option<f64>,
}

impl fmt::Display for Shortage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "its circle of {:.0} m radius ", self.radius_m)?;
        if self.beyond_box_m > self.below_m {
            write!(f, "leaves the box by {:.1} m; ", self.beyond_box_m)?;
        } else {
            let below_m = self.below_m;
            write!(
                f,
                "reaches {below_m:.1} m below what the altitude over the bed allows; "
            )?;
        }
        match self.raise_to_m {
            Some(depth_m) => write!(f, "raise it to {depth_m} m or move it"),
            None => f.write_str("move it"),
        }
    }
}

impl Mission {
    /// The room that the vehicle has at a place, arriving level from whichever direction suits.
    ///
    /// # Determinism
    /// The result depends on the mission's vehicle, box and bed, and on the place.
    #[must_use]
    pub fn room_at(&self, place: &Point3<f64>) -> Room {
        if self.vehicle.can_hover() {
            return Room::Stays;
        }
        let Some(shortage) = self.shortage_at(place) else {
            return Room::Stays;
        };
        if self.leads_on(place) {
            Room::LeadsOn(shortage)
        } else {
            Room::None(shortage)
        }
    }

    /// What the circle that fits best at a place lacks; `None` if one fits.
    fn shortage_at(&self, place: &Point3<f64>) -> Option<Shortage> {
        let radius_m = tightest_circle_m(&self.vehicle);
        let mut all = RADII
            .iter()
            .flat_map(|radii| circles(place, radii * radius_m));
        if all.any(|circle| self.has_room(&circle)) {
            return None;
        }
        let worst_m = |lacks: (f64, f64)| lacks.0.max(lacks.1);
        let (beyond_box_m, below_m) = circles(place, radius_m)
            .map(|circle| self.lacks_m(&circle))
            .min_by(|a, b| worst_m(*a).total_cmp(&worst_m(*b)))
            .unwrap_or_default();
        Some(Shortage {
            radius_m,
            beyond_box_m,
            below_m,
            raise_to_m: self.raised_m(place, radius_m),
        })
    }

    /// Whether a polyline stays within the box and above the bed.
    fn has_room(&self, points: &[Point3<f64>]) -> bool {
        let (beyond_m, below_m) = self.lacks_m(points);
        beyond_m.max(below_m) <= ROUNDING_M
    }

    /// By how much a polyline leaves the box, and how far it dips below the deepest allowed, metres.
    fn lacks_m(&self, points: &[Point3<f64>]) -> (f64, f64) {
        let limits = self.limits();
        let beyond_m = points
            .iter()
            .map(|p| limits.excess_m(p))
            .fold(0.0, f64::max);
        let below_m = self.floor().map_or(0.0, |floor| {
            let pieces = points.windows(2);
            let dips = pieces.map(|pair| floor.grounding_m(&pair[0], &pair[1]));
            dips.fold(0.0, f64::max)
        });
        (beyond_m, below_m)
    }

    /// The greatest depth above a place at which one of its tightest circles fits. What fits at a depth fits
    /// above it as well.
    fn raised_m(&self, place: &Point3<f64>, radius_m: f64) -> Option<f64> {
        let fits = |step: u32| {
            let there = Point3::new(place.x, place.y, f64::from(step) * DEPTH_STEP_M);
            circles(&there, radius_m).any(|circle| self.has_room(&circle))
        };
        let mut shallow = libm::ceil(self.limits().low.z / DEPTH_STEP_M) as u32;
        let mut deep = libm::ceil(place.z / DEPTH_STEP_M) as u32;
        if shallow >= deep || !fits(shallow) {
            return None;
        }
        while deep - shallow > 1 {
            let middle = shallow.midpoint(deep);
            *if fits(middle) {
                &mut shallow
            } else {
                &mut deep
            } = middle;
        }
        Some(f64::from(shallow) * DEPTH_STEP_M)
    }

    /// Whether a short level way, or a climb, leads from a place to where a circle fits.
    fn leads_on(&self, place: &Point3<f64>) -> bool {
        let pitch_rad = CLIMB_SHARE * self.vehicle.max_pitch_rad.min(1.0);
        let radius_m = tightest_circle_m(&self.vehicle);
        let directions = (0..DIRECTIONS).map(bearing);
        let slopes = [0.0, libm::tan(pitch_rad)];
        let mut ways = directions.flat_map(|direction| {
            slopes
                .iter()
                .flat_map(move |&slope| LEADS_M.map(|length_m| (direction, slope, length_m)))
        });
        ways.any(|(direction, slope, length_m)| {
            // A climb begins and ends level: half its slope on the whole.
            let rise_m = (0.5 * slope * length_m).min((place.z - self.limits().low.z).max(0.0));
            let end = place + direction * length_m - Vector3::z() * rise_m;
            let holds = || circles(&end, radius_m).any(|circle| self.has_room(&circle));
            self.has_room(&[*place, end]) && holds()
        })
    }
}

fn bearing(k: u32) -> Vector3<f64> {
    let (sin, cos) = libm::sincos(TAU * f64::from(k) / f64::from(DIRECTIONS));
    Vector3::new(cos, sin, 0.0)
}

/// Level circles through a place, to the right of each direction.
fn circles(place: &Point3<f64>, radius_m: f64) -> impl Iterator<Item = Vec<Point3<f64>>> {
    let place = *place;
    (0..DIRECTIONS).map(move |k| {
        let rest = arc(place, bearing(k), radius_m, TAU);
        std::iter::once(place).chain(rest).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use auv_ocean::{AnalyticBed, BedFeature, Footprint};
    use auv_planning::Vehicle;
    use std::sync::Arc;

    /// A survey vehicle's mission over a bed of 100 m that rises 1 in 1 to the east, from 1000 m east on.
    fn by_a_slope() -> Mission {
        let mut mission = Fixture::new().mission;
        mission.vehicle = Vehicle::default();
        mission.min_altitude_m = 5.0;
        let land = Footprint::Beyond {
            through: [0.0, 1_100.0],
            towards: [0.0, 1_200.0],
        };
        let bed = AnalyticBed::new(100.0).with(BedFeature::new("slope", land, 0.0, 100.0));
        mission.sea_bed = Some(Arc::new(bed));
        mission.bounds = Some(auv_types::Bounds::new(
            Point3::new(-2e3, -2e3, 2.0),
            Point3::new(2e3, 2e3, 90.0),
        ));
        mission
    }

    #[test]
    fn a_vehicle_that_cannot_hover_stays_where_a_circle_fits() {
        let mut mission = by_a_slope();
        assert_eq!(mission.room_at(&Point3::new(0.0, 0.0, 90.0)), Room::Stays);
        // At the foot of the slope a circle on the side of the sea fits.
        assert_eq!(
            mission.room_at(&Point3::new(0.0, 1_010.0, 60.0)),
            Room::Stays
        );
        mission.vehicle.min_speed_mps = 0.0;
        assert_eq!(
            mission.room_at(&Point3::new(0.0, 1_099.0, 1.0)),
            Room::Stays
        );
    }

    #[test]
    fn a_pit_leaves_no_room_and_the_remedy_is_a_depth_that_does() {
        let mut mission = by_a_slope();
        let pit = Footprint::Disc {
            centre: [0.0, 0.0],
            radius_m: 4.0,
        };
        let bed = AnalyticBed::new(30.0).with(BedFeature::new("pit", pit, 60.0, 8.0));
        mission.sea_bed = Some(Arc::new(bed));
        let (Room::LeadsOn(shortage) | Room::None(shortage)) =
            mission.room_at(&Point3::new(0.0, 0.0, 50.0))
        else {
            panic!("no circle fits in a pit");
        };
        assert!(shortage.below_m > 20.0, "{shortage:?}");
        let raised_m = shortage.raise_to_m.unwrap();
        assert!((20.0..=25.0).contains(&raised_m), "{shortage:?}");
        assert_eq!(
            mission.room_at(&Point3::new(0.0, 0.0, raised_m)),
            Room::Stays
        );
        assert!(shortage.to_string().contains("raise it to"), "{shortage}");
    }

    #[test]
    fn a_corridor_narrower_than_a_circle_leaves_no_room_at_any_depth() {
        let mut mission = by_a_slope();
        mission.bounds = Some(auv_types::Bounds::new(
            Point3::new(-2e3, -15.0, 2.0),
            Point3::new(2e3, 15.0, 90.0),
        ));
        let room = mission.room_at(&Point3::new(0.0, 0.0, 50.0));
        let Room::None(shortage) = room else {
            panic!("{room:?}");
        };
        assert_eq!(shortage.raise_to_m, None);
        assert!(
            shortage.to_string().contains("leaves the box"),
            "{shortage}"
        );
    }
}
