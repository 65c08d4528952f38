//! One leg ahead: how much longer the edges from here take because of what is in the way.

use crate::{Mission, SyncSettings};
use auv_obstacles::{Region, TimedPoint};
use auv_types::{Point3, libm};

/// How far apart the times are at which a covered waypoint is looked at again, seconds.
const LOOK_S: f64 = 60.0;

/// The predicted obstacles, as far as they delay a leg that begins soon.
///
/// A prediction says little of the time after the next leg, so later edges keep their times.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldForecast<'a> {
    regions: &'a [Region],
    clearance_m: f64,
    speed_mps: f64,
    longest_s: f64,
    /// A place that a path is known to, and how long it takes.
    way: Option<(Point3<f64>, f64)>,
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
            way: None,
        }
    }

    /// Knows what the path in force takes from here to a place: a leg given up because of that is not
    /// believed to be shorter.
    pub(crate) fn with_way(self, place: Point3<f64>, takes_s: f64) -> Self {
        Self {
            way: Some((place, takes_s)),
            ..self
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.regions.is_empty() && self.way.is_none()
    }

    /// Delay of a leg between two places that begins at a time and takes `travel_s` undisturbed:
    /// the longest that any one region causes, seconds.
    pub(crate) fn delay_s(&self, ends: [Point3<f64>; 2], time_s: f64, travel_s: f64) -> f64 {
        let from = TimedPoint::new(ends[0], time_s);
        let to = TimedPoint::new(ends[1], time_s + travel_s);
        let known_s = self.way.filter(|(place, _)| *place == ends[1]);
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
        round_m(radius_m, offset_m, [before_m, after_m]) / self.speed_mps
    }

    /// How long a region goes on to cover a place, at most as long as it would be waited for.
    fn covered_for_s(&self, region: &Region, place: &TimedPoint) -> f64 {
        let looks = (self.longest_s / LOOK_S).floor() as usize;
        (1..=looks)
            .map(|k| LOOK_S * k as f64)
            .find(|wait_s| {
                let later = TimedPoint::new(place.position, place.time_s + wait_s);
                region.distance_m(&later) >= self.clearance_m
            })
            .unwrap_or(self.longest_s)
    }
}

/// How much longer the way round a ball is than the straight way that passes its centre at
/// `offset_m`, with `ends_m` of way before and after: two tangents and the arc between.
fn round_m(radius_m: f64, offset_m: f64, ends_m: [f64; 2]) -> f64 {
    let mut longer_m = 0.0;
    for end_m in ends_m {
        let away_m = libm::hypot(end_m, offset_m);
        if away_m <= radius_m {
            // The way begins or ends at the ball itself.
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

    fn delay_with_s(region: Region, way: Option<(Point3<f64>, f64)>) -> f64 {
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
        FieldForecast { way, ..forecast }.delay_s(ends, 0.0, 1000.0)
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
    fn a_known_way_costs_what_it_takes() {
        let far = Region::ball(Point3::new(0.0, 9000.0, 50.0), 100.0);
        let target = Point3::new(3000.0, 0.0, 50.0);
        assert_eq!(delay_with_s(far, Some((target, 1100.0))), 100.0);
        assert_eq!(delay_with_s(far, Some((target, 900.0))), 0.0);
        assert_eq!(delay_with_s(far, Some((Point3::origin(), 1100.0))), 0.0);
    }
}
