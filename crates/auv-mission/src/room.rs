//! Whether a vehicle has room to stay at a place, within box and above the bed.

use crate::approach::headings;
use crate::leads::directions;
use crate::station_keeping::holds;
use crate::{Mission, check};
use auv_obstacles::TimedPoint;
use auv_planning::motion::tightest_circle_m;
use auv_planning::{PathProblem, Trajectory};
use auv_types::{Point3, Vector3, libm};
use std::fmt;

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
    /// The room that the vehicle has at a place, arriving level from whichever direction suits: whether one of
    /// the circles, or of the ways on, that it would fly there is accepted by the verifier.
    ///
    /// # Determinism
    /// The result depends on the mission's vehicle, box and bed, and on the place.
    #[must_use]
    pub fn room_at(&self, place: &Point3<f64>) -> Room {
        if self.vehicle.can_hover() || self.has_circle(place) {
            return Room::Stays;
        }
        let shortage = self.shortage_at(place);
        if headings(&self.open_problem(*place, *place)).is_empty() {
            Room::None(shortage)
        } else {
            Room::LeadsOn(shortage)
        }
    }

    /// The problem of going from one place to another in still, empty water.
    pub(crate) fn open_problem(&self, start: Point3<f64>, target: Point3<f64>) -> PathProblem<'_> {
        PathProblem {
            bounds: Some(self.limits()),
            sea_bed: self.sea_bed.as_deref(),
            min_altitude_m: self.min_altitude_m,
            altitude_sigmas: self.altitude_sigmas,
            ..PathProblem::new(start, target, &self.vehicle)
        }
    }

    /// Whether one of the circles at a place stays within box and bed.
    fn has_circle(&self, place: &Point3<f64>) -> bool {
        let problem = self.open_problem(*place, *place);
        let mut all = circles(&problem);
        all.any(|(velocity, circle)| check::leads_on(&problem, velocity, &circle))
    }

    /// What the circle that fits best at a place lacks.
    fn shortage_at(&self, place: &Point3<f64>) -> Shortage {
        let problem = self.open_problem(*place, *place);
        let worst_m = |lacks: (f64, f64)| lacks.0.max(lacks.1);
        let (beyond_box_m, below_m) = circles(&problem)
            .map(|(_, circle)| self.lacks_m(&circle))
            .min_by(|a, b| worst_m(*a).total_cmp(&worst_m(*b)))
            .unwrap_or_default();
        Shortage {
            radius_m: tightest_circle_m(&self.vehicle),
            beyond_box_m,
            below_m,
            raise_to_m: self.raised_m(place),
        }
    }

    /// By how much a trajectory leaves the box, and how far it dips below the deepest allowed, metres.
    fn lacks_m(&self, way: &Trajectory) -> (f64, f64) {
        let limits = self.limits();
        let beyond_m = way.points().iter().map(|p| limits.excess_m(&p.position));
        let below_m = self.floor().map_or(0.0, |floor| {
            let dips = way
                .segments()
                .map(|(from, to)| floor.grounding_m(&from.position, &to.position));
            dips.fold(0.0, f64::max)
        });
        (beyond_m.fold(0.0, f64::max), below_m)
    }

    /// The greatest depth above a place at which one of its circles fits. What fits at a depth fits above it as
    /// well.
    fn raised_m(&self, place: &Point3<f64>) -> Option<f64> {
        let fits = |step: u32| {
            self.has_circle(&Point3::new(
                place.x,
                place.y,
                f64::from(step) * DEPTH_STEP_M,
            ))
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
}

/// The level circles through a problem's start, in all directions of arrival, each with the velocity there.
fn circles<'p>(
    problem: &'p PathProblem<'_>,
) -> impl Iterator<Item = (Vector3<f64>, Trajectory)> + 'p {
    let place = TimedPoint::new(problem.start, problem.departure_s);
    let level = directions().filter(|direction| direction.z == 0.0);
    level.flat_map(move |direction| {
        let velocity = direction * problem.vehicle.speed_mps;
        holds(problem, place, velocity, 0.0).map(move |circle| (velocity, circle))
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
