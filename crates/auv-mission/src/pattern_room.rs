//! Whether a vehicle has room for what it flies at work.

use crate::leads::directions;
use crate::pattern::profile;
use crate::{Manner, Mission, Pattern, check};
use auv_obstacles::TimedPoint;
use auv_types::Point3;

impl Mission {
    /// Why a task cannot be done so at a place in still, empty water, with the remedy; `None` where it can,
    /// arriving from whichever direction suits.
    #[must_use]
    pub fn keeps_out(&self, manner: &Manner, place: &Point3<f64>) -> Option<String> {
        let place = Point3::new(place.x, place.y, manner.depth_m.unwrap_or(place.z));
        let pattern = &manner.pattern.unwrap_or(profile(place.z, place.z));
        let problem = self.open_problem(place, place);
        let here = TimedPoint::new(place, 0.0);
        let level = directions().filter(|direction| direction.z == 0.0);
        let mut ways = level.flat_map(|direction| {
            let velocity = direction * self.vehicle.speed_mps;
            pattern.ways(&problem, here, velocity)
        });
        if ways.any(|way| check::is_flyable(&problem, &way)) {
            return None;
        }
        let most_m = match *pattern {
            Pattern::Profile { from_m, to_m } => from_m.max(to_m),
            Pattern::Yoyo { bottom_m, .. } => bottom_m,
            Pattern::Circle { .. } => place.z,
        };
        let (least_m, allowed_m) = (self.limits().low.z, self.deepest_at(place.x, place.y));
        Some(if most_m > allowed_m {
            format!(
                "its pattern reaches {:.1} m below what the altitude over the bed allows; go no deeper than {allowed_m:.1} m",
                most_m - allowed_m
            )
        } else {
            format!(
                "its pattern does not fit between the top of the box at {least_m} m, its sides and the bed; make it smaller or move it"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use auv_ocean::FlatBed;
    use auv_planning::Vehicle;
    use auv_types::Bounds;
    use std::sync::Arc;

    /// In a box of 400 m, 5 to 60 m deep, over a bed at 50 m that is left 5 m.
    fn mission(vehicle: Vehicle) -> Mission {
        let mut mission = Fixture::new().mission;
        mission.vehicle = vehicle;
        let (low, high) = ([-200.0, -200.0, 5.0], [200.0, 200.0, 60.0]);
        mission.bounds = Some(Bounds::new(low.into(), high.into()));
        mission.sea_bed = Some(Arc::new(FlatBed::new(50.0)));
        mission.min_altitude_m = 5.0;
        mission
    }

    #[test]
    fn work_without_room_is_told_with_the_remedy() {
        let place = Point3::new(0.0, 0.0, 20.0);
        let yoyo = |bottom_m, length_m| Pattern::Yoyo {
            top_m: 10.0,
            bottom_m,
            length_m,
            heading_deg: 0.0,
        };
        let circle = |radius_m| Pattern::Circle {
            radius_m,
            turns: 1.0,
        };
        let deep = |m: &str| {
            Some(format!(
                "reaches {m} m below what the altitude over the bed allows; go no deeper than 45.0 m"
            ))
        };
        let small = Some("does not fit between the top of the box at 5 m".to_owned());
        let cases = [
            (Some(profile(10.0, 45.0)), None, None),
            (Some(profile(10.0, 46.0)), None, deep("1.0")),
            (Some(profile(48.0, 10.0)), None, deep("3.0")),
            (Some(profile(4.0, 30.0)), None, small.clone()),
            (Some(yoyo(40.0, 150.0)), None, None),
            (Some(yoyo(47.5, 150.0)), None, deep("2.5")),
            (Some(yoyo(40.0, 250.0)), None, small.clone()),
            (Some(circle(80.0)), None, None),
            (Some(circle(80.0)), Some(46.0), deep("1.0")),
            (Some(circle(250.0)), None, small),
            (None, Some(45.0), None),
        ];
        for vehicle in [Vehicle::default(), Vehicle::paper()] {
            let mission = mission(vehicle);
            for (pattern, depth_m, why) in cases.clone() {
                let manner = Manner {
                    pattern,
                    depth_m,
                    speed_mps: None,
                };
                let told = mission.keeps_out(&manner, &place);
                match (&told, why) {
                    (None, None) => {}
                    (Some(told), Some(why)) if told.contains(&why) => {}
                    (_, why) => panic!("{manner:?}: {told:?}, not {why:?}"),
                }
            }
        }
    }
}
