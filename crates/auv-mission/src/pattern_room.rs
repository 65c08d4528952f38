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
