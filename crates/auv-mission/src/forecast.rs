//! Delays that predicted obstacles cause on the next leg.

use crate::{Mission, SyncSettings};
use auv_obstacles::{Region, TimedPoint};
use auv_types::{Point3, libm};

/// Step of the times at which a covered waypoint is checked, seconds.
const STEP_S: f64 = 60.0;

/// The predicted regions, as far as they delay a leg that starts soon.
///
/// A prediction says little of the time after the next leg, so later edges keep their times.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldForecast<'a> {
    regions: &'a [Region],
    clearance_m: f64,
    speed_mps: f64,
    longest_s: f64,
    /// A place to which a path is known, and how long the path takes in seconds.
    known_path: Option<(Point3<f64>, f64)>,
}

impl<'a> FieldForecast<'a> {
    pub(crate) fn new(mission: &Mission, settings: &SyncSettings, regions: &'a [Region]) -> Self {
        Self {
            regions: if settings.margins.forecast {
                regions
            } else {
                &[]
            },
            clearance_m: mission.clearance_m + settings.margins.hysteresis_m,
            speed_mps: mission.vehicle.speed_mps,
            longest_s: settings.waiting.max_wait_s,
            known_path: None,
        }
    }

    /// With the time that the path in force takes from here to a place. A leg that was given up for
    /// taking too long is then not planned again with a shorter time.
    pub(crate) fn with_known_path(self, place: Point3<f64>, takes_s: f64) -> Self {
        Self {
            known_path: Some((place, takes_s)),
            ..self
        }
    }

    /// Delay in seconds of a leg between two places that starts at a time and takes `travel_s` without
    /// obstacles: the longest delay that any single region causes.
    pub(crate) fn delay_s(&self, ends: [Point3<f64>; 2], time_s: f64, travel_s: f64) -> f64 {
        let from = TimedPoint::new(ends[0], time_s);
        let to = TimedPoint::new(ends[1], time_s + travel_s);
        let known_s = self.known_path.filter(|(place, _)| *place == ends[1]);
        self.regions
            .iter()
            .map(|region| self.delay_by_s(region, &from, &to))
            .chain(known_s.map(|(_, takes_s)| takes_s - travel_s))
            .fold(0.0, f64::max)
    }

    fn delay_by_s(&self, region: &Region, from: &TimedPoint, to: &TimedPoint) -> f64 {
        let closest = region.clearance(from, to);
        if closest.clearance_m >= self.clearance_m {
            return 0.0;
        }
        if region.distance_m(to) < self.clearance_m {
            return self.covered_for_s(region, to);
        }
        let radius_m = region.radius_at(closest.time_s) + self.clearance_m;
        let offset_m = (radius_m - (self.clearance_m - closest.clearance_m)).max(0.0);
        let before_m = (closest.time_s - from.time_s) * self.speed_mps;
        let after_m = (to.time_s - closest.time_s) * self.speed_mps;
        detour_m(radius_m, offset_m, [before_m, after_m]) / self.speed_mps
    }

    /// How long a region still covers a place, seconds; at most the longest wait.
    fn covered_for_s(&self, region: &Region, place: &TimedPoint) -> f64 {
        let steps = (self.longest_s / STEP_S).floor() as usize;
        (1..=steps)
            .map(|k| STEP_S * k as f64)
            .find(|wait_s| {
                let later = TimedPoint::new(place.position, place.time_s + wait_s);
                region.distance_m(&later) >= self.clearance_m
            })
            .unwrap_or(self.longest_s)
    }
}

/// How much longer the path round a ball is than the straight line, metres: two tangents and the arc
/// between. The line passes the centre at `offset_m` and has `ends_m` before and after that point.
fn detour_m(radius_m: f64, offset_m: f64, ends_m: [f64; 2]) -> f64 {
    let mut longer_m = 0.0;
    for end_m in ends_m {
        let away_m = libm::hypot(end_m, offset_m);
        if away_m <= radius_m {
            // The line starts or ends inside the ball.
            longer_m += radius_m - offset_m;
            continue;
        }
        let tangent_m = (away_m * away_m - radius_m * radius_m).sqrt();
        let angle_rad = libm::atan2(end_m, offset_m) - libm::acos(radius_m / away_m);
        longer_m += (tangent_m + radius_m * angle_rad - end_m).max(0.0);
    }
    longer_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
    use auv_planning::Vehicle;
    use std::sync::Arc;

    fn delay_s(region: Region) -> f64 {
        delay_with_s(region, None)
    }

    fn delay_with_s(region: Region, known_path: Option<(Point3<f64>, f64)>) -> f64 {
        let ends = [Point3::new(0.0, 0.0, 50.0), Point3::new(3000.0, 0.0, 50.0)];
        let edge = Edge::undirected(0, 1, Task::TRANSIT);
        let network = Network::new(&ends.map(Waypoint::at), &[edge], 3.0).unwrap();
        let mission = Mission::new(
            Arc::new(network),
            NodeId(0),
            NodeId(1),
            2000.0,
            Vehicle::paper(),
        );
        let regions = [region];
        let mut settings = SyncSettings::default();
        settings.margins.hysteresis_m = 0.0;
        let forecast = FieldForecast::new(&mission, &settings, &regions);
        let forecast = FieldForecast {
            known_path,
            ..forecast
        };
        forecast.delay_s(ends, 0.0, 1000.0)
    }

    #[test]
    fn a_ball_in_the_middle_costs_the_way_round_it() {
        // 3000 m straight; round a circle of 100 m: two tangents of 1496.66 m and 13.35 m of arc.
        let delay = delay_s(Region::ball(Point3::new(1500.0, 0.0, 50.0), 100.0));
        assert!((delay * 3.0 - 6.671).abs() < 0.01, "{delay}");
        let beside = delay_s(Region::ball(Point3::new(1500.0, 101.0, 50.0), 100.0));
        assert_eq!(beside, 0.0);
    }

    #[test]
    fn the_longest_delay_of_any_region_counts() {
        let settings = SyncSettings::default();
        let fixture = crate::fixture::Fixture::new();
        let ball = |y: f64| Region::ball(Point3::new(450.0, y, 20.0), 100.0);
        let delay_s = |regions: &[Region]| {
            let forecast = FieldForecast::new(&fixture.mission, &settings, regions);
            let ends = [0.0, 900.0].map(crate::fixture::place);
            forecast.delay_s(ends, 0.0, 300.0)
        };
        let (near_s, far_s) = (delay_s(&[ball(0.0)]), delay_s(&[ball(60.0)]));
        assert!(near_s > far_s && far_s > 0.0);
        assert_eq!(delay_s(&[ball(60.0), ball(0.0), ball(-60.0)]), near_s);
    }

    #[test]
    fn a_covered_target_costs_the_wait() {
        let target = Point3::new(3000.0, 0.0, 50.0);
        assert_eq!(delay_s(Region::ball(target, 100.0)), 600.0);
        let mut passing = Region::ball(Point3::new(3000.0, -1000.0, 50.0), 100.0);
        passing.velocity_mps.y = 1.0;
        assert_eq!(delay_s(passing), 120.0);
        passing.velocity_mps.y = 2.0;
        assert_eq!(delay_s(passing), 0.0);
    }

    #[test]
    fn a_known_path_costs_what_it_takes() {
        let far = Region::ball(Point3::new(0.0, 9000.0, 50.0), 100.0);
        let target = Point3::new(3000.0, 0.0, 50.0);
        assert_eq!(delay_with_s(far, Some((target, 1100.0))), 100.0);
        assert_eq!(delay_with_s(far, Some((target, 900.0))), 0.0);
        assert_eq!(delay_with_s(far, Some((Point3::origin(), 1100.0))), 0.0);
    }
}
