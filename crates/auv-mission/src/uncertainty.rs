//! What is charted as it must be kept clear of when a path ends: the error of the vehicle's place grows on the way.

use crate::Navigation;
use crate::view::View;
use auv_obstacles::{Region, TimedPoint};
use auv_types::Point3;
use std::sync::Arc;

/// By how much clearances from what is charted grow on a straight way to a place, metres.
pub(crate) fn growth_m(view: View<'_>, target: &Point3<f64>) -> f64 {
    let ahead_m = (target - view.beliefs().position).norm();
    let navigation = view.mission.navigation.unwrap_or_default();
    Navigation::SIGMAS * navigation.sigma_m(ahead_m, ahead_m)
}

/// The predicted regions, with what is charted as wide as at the end of a path, or as start and target allow. A
/// path that only just keeps clear of it now would be given up on the way.
pub(crate) fn widened(view: View<'_>, start: &Point3<f64>, target: &Point3<f64>) -> Arc<[Region]> {
    let regions = &view.beliefs().regions;
    let growth_m = growth_m(view, target);
    if growth_m <= 0.0 {
        return Arc::clone(regions);
    }
    let wanted_m = view.wanted_clearance_m();
    let wider = |region: &Region| {
        let room_m = |place: &Point3<f64>| {
            region.distance_m(&TimedPoint::new(*place, view.now_s())) - wanted_m
        };
        let by_m = growth_m.min(room_m(start)).min(room_m(target));
        region.widened(by_m.max(0.0))
    };
    let each = |region: &Region| {
        if region.is_permanent() {
            wider(region)
        } else {
            *region
        }
    };
    regions.iter().map(each).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{Fixture, place};
    use auv_types::Vector3;

    #[test]
    fn charted_regions_are_as_wide_as_at_the_end_where_there_is_room() {
        let beside =
            |x: f64, away_m: f64| Region::ball(place(x) + Vector3::new(0.0, away_m, 0.0), 20.0);
        let moving = Region {
            velocity_mps: Vector3::x(),
            ..beside(450.0, 90.0)
        };
        let regions = [beside(450.0, 90.0), beside(900.0, 38.0), moving];
        let mut fixture = Fixture::new().among(&regions);
        let radii = |fixture: &Fixture| {
            let widened = fixture.view(|view| widened(view, &place(0.0), &place(900.0)));
            widened.iter().map(|r| r.radius_m).collect::<Vec<_>>()
        };
        assert_eq!(radii(&fixture), [20.0; 3]);
        fixture.mission.navigation = Some(Navigation {
            drift_percent: 1.0,
            ..Navigation::default()
        });
        // 900 m: 18 m. The target keeps 10 m, 5 m of them hysteresis.
        assert_eq!(radii(&fixture), [38.0, 28.0, 20.0]);
    }
}
