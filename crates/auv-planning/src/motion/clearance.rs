//! How near a trajectory comes to predicted regions.

use crate::Trajectory;
use auv_obstacles::{Region, RegionShape, TimedPoint};
use auv_types::{Bounds, Point3};

/// The least clearance found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Least distance to a surface in metres (negative inside), or the cap.
    pub clearance_m: f64,
    /// Index of the region it belongs to; the lowest of several. `None` at the cap.
    pub region: Option<usize>,
}

impl Nearest {
    fn consider(&mut self, clearance_m: f64, region: usize) {
        let ties = || clearance_m <= self.clearance_m && self.region.is_some_and(|i| region < i);
        if clearance_m < self.clearance_m || ties() {
            *self = Self {
                clearance_m,
                region: Some(region),
            };
        }
    }
}

/// The times from the start of any trajectory to its end.
pub const ALWAYS: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Least clearance of a trajectory to any region between two times, exact below `cap_m`.
///
/// After its end (and before its start) the vehicle rests there: then it is the distance at the
/// moment of the end (or start).
#[must_use]
pub fn least_clearance(
    trajectory: &Trajectory,
    regions: &[Region],
    (from_s, until_s): (f64, f64),
    cap_m: f64,
) -> Nearest {
    let points = trajectory.points();
    let first = points
        .partition_point(|point| point.time_s <= from_s)
        .saturating_sub(1);
    let last = points
        .partition_point(|point| point.time_s < until_s)
        .min(points.len() - 1);
    let mut nearest = Nearest {
        clearance_m: cap_m,
        region: None,
    };
    if first >= last {
        for (i, region) in regions.iter().enumerate() {
            nearest.consider(region.distance_m(&points[last]), i);
        }
        return nearest;
    }
    let clipped = |pair: &[TimedPoint]| {
        let from = if pair[0].time_s < from_s {
            between(pair, from_s)
        } else {
            pair[0]
        };
        let to = if pair[1].time_s > until_s {
            between(pair, until_s)
        } else {
            pair[1]
        };
        (from, to)
    };
    search(&points[first..=last], regions, &mut nearest, clipped);
    nearest
}

/// Visits the segments in stretches of 16; a region that stays away from all of them, from a
/// stretch or from a segment costs one comparison.
fn search(
    points: &[TimedPoint],
    regions: &[Region],
    nearest: &mut Nearest,
    clipped: impl Fn(&[TimedPoint]) -> (TimedPoint, TimedPoint),
) {
    const STRETCH: usize = 16;
    let whole = Sweep::of(points);
    let near: Vec<usize> = (0..regions.len())
        .filter(|&i| whole.may_touch(&regions[i], nearest.clearance_m))
        .collect();
    let last = points.len() - 1;
    for begin in (0..last).step_by(STRETCH) {
        let part = &points[begin..=(begin + STRETCH).min(last)];
        let stretch = Sweep::of(part);
        for &i in &near {
            if !stretch.may_touch(&regions[i], nearest.clearance_m) {
                continue;
            }
            for pair in part.windows(2) {
                if Sweep::of(pair).may_touch(&regions[i], nearest.clearance_m) {
                    let (from, to) = clipped(pair);
                    nearest.consider(regions[i].clearance(&from, &to).clearance_m, i);
                }
            }
        }
    }
}

/// The place on a segment at a time within it.
fn between(pair: &[TimedPoint], time_s: f64) -> TimedPoint {
    let share = (time_s - pair[0].time_s) / (pair[1].time_s - pair[0].time_s);
    let position = pair[0].position + (pair[1].position - pair[0].position) * share;
    TimedPoint::new(position, time_s)
}

/// Least distance from a place at a time to any region, metres, at most `cap_m`.
#[must_use]
pub fn distance_to_regions_m(place: &TimedPoint, regions: &[Region], cap_m: f64) -> f64 {
    regions
        .iter()
        .map(|region| region.distance_m(place))
        .fold(cap_m, f64::min)
}

/// Where and when a stretch of a trajectory lies, to pass over regions that are far from it.
#[derive(Clone, Copy, Debug)]
struct Sweep {
    bounds: Bounds,
    begin_s: f64,
    end_s: f64,
}

impl Sweep {
    /// The box and the times of a polyline with at least one point.
    fn of(points: &[TimedPoint]) -> Self {
        let (first, last) = (points[0], points[points.len() - 1]);
        let mut bounds = Bounds::new(first.position, first.position);
        for point in &points[1..] {
            let at = point.position.coords;
            bounds.low = Point3::from(bounds.low.coords.zip_map(&at, f64::min));
            bounds.high = Point3::from(bounds.high.coords.zip_map(&at, f64::max));
        }
        Self {
            bounds,
            begin_s: first.time_s,
            end_s: last.time_s,
        }
    }

    /// Whether a region may come within `margin_m` of the stretch. A region that does is never
    /// missed.
    fn may_touch(&self, region: &Region, margin_m: f64) -> bool {
        let (begin_s, end_s) = (
            self.begin_s.max(region.from_s),
            self.end_s.min(region.until_s),
        );
        if begin_s > end_s {
            return false;
        }
        let (a, b) = (region.centre_at(begin_s), region.centre_at(end_s));
        let radius_m = region.radius_at(begin_s).max(region.radius_at(end_s));
        let reach_m = (radius_m + margin_m) * (1.0 + 1e-9) + 1e-6;
        let gap = |k: usize| {
            (a[k].min(b[k]) - self.bounds.high[k])
                .max(self.bounds.low[k] - a[k].max(b[k]))
                .max(0.0)
        };
        let across = gap(0) * gap(0) + gap(1) * gap(1);
        if reach_m < 0.0 || across > reach_m * reach_m {
            return false;
        }
        match region.shape {
            RegionShape::Ball => across + gap(2) * gap(2) <= reach_m * reach_m,
            RegionShape::Cylinder { top_m, bottom_m } => {
                let slack_m = margin_m + 1e-6;
                top_m - slack_m <= self.bounds.high.z && self.bounds.low.z <= bottom_m + slack_m
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::{Seed, Vector3, rand::RngExt};

    fn drawn(seed: u64) -> (Trajectory, Vec<Region>) {
        let mut random = Seed(5).stream(seed);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let regions = (0..40)
            .map(|i| {
                let centre = Point3::new(draw(0.0, 2e3), draw(-300.0, 300.0), draw(0.0, 200.0));
                let mut region = if i % 3 == 0 {
                    Region::cylinder(centre, draw(5.0, 100.0), 0.0, draw(10.0, 150.0))
                } else {
                    Region::ball(centre, draw(5.0, 100.0))
                };
                region.velocity_mps = Vector3::new(draw(-1.0, 1.0), draw(-1.0, 1.0), 0.0);
                region.growth_mps = draw(-0.05, 0.1);
                region.from_s = draw(-100.0, 500.0);
                region.until_s = region.from_s + draw(50.0, 900.0);
                region
            })
            .collect();
        let points = (0..60)
            .map(|i| {
                let place = Point3::new(34.0 * f64::from(i), draw(-60.0, 60.0), draw(20.0, 80.0));
                TimedPoint::new(place, 12.0 * f64::from(i))
            })
            .collect();
        (Trajectory::new(points).unwrap(), regions)
    }

    /// Every segment of the part between two times against every region.
    fn slow_m(trajectory: &Trajectory, regions: &[Region], from_s: f64, until_s: f64) -> f64 {
        let part = trajectory.until(until_s).after(from_s);
        let each = regions
            .iter()
            .flat_map(|region| part.segments().map(|(a, b)| region.clearance(a, b)));
        each.map(|closest| closest.clearance_m)
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn equals_brute_force_over_segments_and_regions() {
        let mut random = Seed(6).stream(0);
        let mut capped = 0;
        for k in 0..200 {
            let (trajectory, regions) = drawn(k);
            let from_s = random.random_range(-50.0..650.0);
            let until_s = from_s + random.random_range(60.0..800.0);
            let cap_m = random.random_range(-20.0..60.0);
            let slow_m = slow_m(&trajectory, &regions, from_s, until_s);
            let nearest = least_clearance(&trajectory, &regions, (from_s, until_s), cap_m);
            assert!((nearest.clearance_m - slow_m.min(cap_m)).abs() < 1e-9);
            capped += usize::from(nearest.region.is_none());
            if let Some(i) = nearest.region {
                let alone = &regions[i..=i];
                let alone = least_clearance(&trajectory, alone, (from_s, until_s), cap_m);
                assert_eq!(alone.clearance_m, nearest.clearance_m);
            }
        }
        assert!((20..180).contains(&capped), "{capped}");
    }

    #[test]
    fn the_first_of_equals_is_named() {
        let at = |x: f64| Region::ball(Point3::new(x, 30.0, 0.0), 10.0);
        let points = [0.0, 1e3, 2e3].map(|x| TimedPoint::new(Point3::new(x, 0.0, 0.0), x));
        let line = Trajectory::new(points.to_vec()).unwrap();
        let regions = [at(1500.0), at(500.0)];
        let nearest = least_clearance(&line, &regions, ALWAYS, 1e9);
        assert_eq!((nearest.clearance_m, nearest.region), (20.0, Some(0)));
    }

    #[test]
    fn the_vehicle_rests_at_both_ends() {
        let (trajectory, _) = drawn(0);
        let mut region = Region::ball(trajectory.end().position, 3.0);
        let after = (1e4, 2e4);
        let nearest = least_clearance(&trajectory, &[region], after, 1e9);
        assert_eq!((nearest.clearance_m, nearest.region), (-3.0, Some(0)));
        assert_eq!(
            distance_to_regions_m(&trajectory.end(), &[region], 1e9),
            -3.0
        );
        region.until_s = 1.0;
        let nearest = least_clearance(&trajectory, &[region], after, 50.0);
        assert_eq!((nearest.clearance_m, nearest.region), (50.0, None));
    }
}
