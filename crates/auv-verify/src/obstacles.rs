//! Clearance of a whole trajectory to all regions.

use crate::clearance::closest;
use auv_obstacles::{ObstacleId, Region, RegionShape, TimedPoint};
use auv_types::{Point3, Vector3};

/// The closest approach of a trajectory to a region.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ClosestApproach {
    /// Signed distance to its surface in metres, negative inside.
    pub clearance_m: f64,
    /// When, seconds.
    pub time_s: f64,
    /// Where the vehicle is then, metres.
    pub place: Point3<f64>,
    /// The obstacle.
    pub obstacle: ObstacleId,
    /// The region's index in the problem.
    pub region: usize,
}

/// Segments of a part. A region that the bounds of a part rule out is not compared with its segments.
const PART: usize = 8;

/// The closest approach to any region. Calls `too_close` for each region that comes nearer than
/// `required_m`.
pub(crate) fn closest_approach(
    points: &[TimedPoint],
    regions: &[Region],
    required_m: f64,
    mut too_close: impl FnMut(ClosestApproach),
) -> Option<ClosestApproach> {
    let whole = PartBounds::of(points)?;
    let parts: Vec<_> = parts(points).filter_map(PartBounds::of).collect();
    let mut overall: Option<ClosestApproach> = None;
    for (index, region) in regions.iter().enumerate() {
        // A region further away neither comes too close nor is the closest of all.
        let matters_m =
            overall.map_or(f64::INFINITY, |nearest| nearest.clearance_m.max(required_m));
        if whole.gap_m(region) > matters_m {
            continue;
        }
        let Some(approach) = closest_to((points, &parts), index, region, matters_m) else {
            continue;
        };
        if !(approach.clearance_m >= required_m) {
            too_close(approach);
        }
        if overall.is_none_or(|nearest| approach.clearance_m < nearest.clearance_m) {
            overall = Some(approach);
        }
    }
    overall
}

/// The points in parts of [`PART`] segments; neighbours share a point.
fn parts(points: &[TimedPoint]) -> impl Iterator<Item = &[TimedPoint]> {
    let last = points.len() - 1;
    let begins = (0..last.max(1)).step_by(PART);
    begins.map(move |begin| &points[begin..=(begin + PART).min(last)])
}

/// The closest approach to one region where it is nearer than `matters_m`.
fn closest_to(
    (points, parts): (&[TimedPoint], &[PartBounds]),
    index: usize,
    region: &Region,
    matters_m: f64,
) -> Option<ClosestApproach> {
    // The segments within the region's window; a single point counts as a segment of no length.
    let first = points.partition_point(|point| point.time_s < region.from_s);
    let end = points.partition_point(|point| point.time_s <= region.until_s);
    let first = first.saturating_sub(1);
    let last = end.min(points.len() - 1).max(first);
    let end = last.max(first + usize::from(points.len() == 1));
    let segment = |i: usize| (&points[i], &points[(i + 1).min(points.len() - 1)]);
    // Every segment that may come within a limit, with a lower bound of its clearance.
    let bounds = |limit_m: f64| {
        let parts = parts.iter().enumerate().skip(first / PART);
        let near = parts.filter(move |(k, part)| k * PART < end && !(part.gap_m(region) > limit_m));
        near.flat_map(move |(k, _)| first.max(k * PART)..end.min((k + 1) * PART))
            .filter_map(move |i| {
                let (from, to) = segment(i);
                let gap_m = PartBounds::of(&[*from, *to])?.gap_m(region);
                (!(gap_m > limit_m)).then_some((gap_m, i))
            })
    };
    // The segment with the least bound comes first: its clearance rules out most of the others.
    let (_, nearest) = bounds(matters_m).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let clearance_of = |i: usize| {
        let (from, to) = segment(i);
        closest(region, from, to).map(|(clearance_m, time_s)| (clearance_m, time_s, i))
    };
    let mut best = clearance_of(nearest);
    let limit_m = best.map_or(matters_m, |(clearance_m, ..)| clearance_m.min(matters_m));
    for (gap_m, i) in bounds(limit_m).filter(|&(_, i)| i != nearest) {
        if best.is_some_and(|(clearance_m, ..)| gap_m > clearance_m) {
            continue;
        }
        if let Some(other) = clearance_of(i)
            && best.is_none_or(|(clearance_m, ..)| !(other.0 >= clearance_m))
        {
            best = Some(other);
        }
    }
    let (clearance_m, time_s, i) = best?;
    let (from, to) = segment(i);
    let whole_s = to.time_s - from.time_s;
    let share = if whole_s > 0.0 {
        (time_s - from.time_s) / whole_s
    } else {
        0.0
    };
    Some(ClosestApproach {
        clearance_m,
        time_s,
        place: from.position + (to.position - from.position) * share,
        obstacle: region.obstacle,
        region: index,
    })
}

/// A box around a part of a trajectory, and its time span.
struct PartBounds {
    middle: Point3<f64>,
    half: Vector3<f64>,
    from_s: f64,
    until_s: f64,
}

impl PartBounds {
    fn of(points: &[TimedPoint]) -> Option<Self> {
        let (first, last) = (points.first()?, points.last()?);
        let (mut low, mut high) = (first.position.coords, first.position.coords);
        for point in points {
            low = low.inf(&point.position.coords);
            high = high.sup(&point.position.coords);
        }
        Some(Self {
            middle: Point3::from((low + high) * 0.5),
            half: (high - low) * 0.5,
            from_s: first.time_s,
            until_s: last.time_s,
        })
    }

    /// A lower bound of the clearance to a region, metres: the distance from the box to the box of
    /// the region's centre, less the largest radius.
    fn gap_m(&self, region: &Region) -> f64 {
        let begin_s = self.from_s.max(region.from_s);
        let end_s = self.until_s.min(region.until_s);
        if begin_s > end_s {
            return f64::INFINITY;
        }
        let middle_s = 0.5 * (begin_s + end_s) - region.at_s;
        let half_s = 0.5 * (end_s - begin_s);
        let centre = region.centre + region.velocity_mps * middle_s;
        let between = (self.middle - centre).abs() - self.half - region.velocity_mps.abs() * half_s;
        let radius_m =
            region.radius_m + region.growth_mps * middle_s + region.growth_mps.abs() * half_s;
        let outside = between.sup(&Vector3::zeros());
        match region.shape {
            RegionShape::Ball => outside.norm() - radius_m,
            RegionShape::Cylinder { top_m, bottom_m } => {
                let (z, half) = (self.middle.z, self.half.z);
                let over_m = (top_m - z - half).max(z - half - bottom_m);
                (outside.xy().norm() - radius_m).max(over_m)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::rand::RngExt;
    use auv_types::{Seed, libm};

    /// A region that moves and grows; one of two within a window, or for the moment of a vertex.
    fn drawn(i: usize, points: &[TimedPoint], draw: &mut impl FnMut(f64, f64) -> f64) -> Region {
        let centre = Point3::new(draw(0.0, 700.0), draw(-300.0, 300.0), draw(0.0, 60.0));
        let mut region = if i.is_multiple_of(3) {
            Region::cylinder(centre, draw(1.0, 60.0), 0.0, draw(5.0, 40.0))
        } else {
            Region::ball(centre, draw(1.0, 60.0))
        };
        region.velocity_mps = Vector3::new(draw(-1.0, 1.0), draw(-1.0, 1.0), 0.0);
        region.growth_mps = draw(-0.02, 0.1);
        region.at_s = draw(-50.0, 50.0);
        if i.is_multiple_of(2) {
            region.from_s = draw(0.0, 300.0);
            region.until_s = region.from_s + draw(0.0, 200.0);
        } else if i.is_multiple_of(5) {
            let vertex = draw(0.0, points.len() as f64) as usize;
            region.from_s = points[vertex].time_s;
            region.until_s = region.from_s;
        }
        region
    }

    #[test]
    fn equals_brute_force_over_segments_and_regions() {
        for case in 0..200 {
            let mut random = Seed(5).stream(case);
            let mut draw = |low: f64, high: f64| random.random_range(low..high);
            let mut points = vec![TimedPoint::new(Point3::new(0.0, 0.0, 20.0), 0.0)];
            for i in 0..30 {
                let step = Vector3::new(draw(10.0, 90.0), draw(-60.0, 60.0), draw(-5.0, 5.0));
                let last = points[i];
                let time_s = last.time_s + step.norm() / 2.0;
                points.push(TimedPoint::new(last.position + step, time_s));
            }
            let regions: Vec<_> = (0..15).map(|i| drawn(i, &points, &mut draw)).collect();
            let brute = |region: &Region| {
                let segments = points.windows(2);
                segments
                    .filter_map(|pair| closest(region, &pair[0], &pair[1]))
                    .map(|(clearance_m, _)| clearance_m)
                    .fold(f64::INFINITY, f64::min)
            };
            let mut reported = Vec::new();
            let nearest = closest_approach(&points, &regions, 10.0, |a| {
                let there = TimedPoint::new(a.place, a.time_s);
                let there_m = regions[a.region].distance_m(&there);
                assert!((there_m - a.clearance_m).abs() < 1e-9);
                reported.push((a.region, a.clearance_m));
            });
            let all: Vec<_> = regions.iter().map(brute).collect();
            let least = all.iter().copied().fold(f64::INFINITY, f64::min);
            assert_eq!(nearest.map_or(f64::INFINITY, |a| a.clearance_m), least);
            let short: Vec<_> = all
                .iter()
                .copied()
                .enumerate()
                .filter(|a| a.1 < 10.0)
                .collect();
            assert_eq!(reported, short);
        }
    }

    fn at(x: f64, y: f64, z: f64, time_s: f64) -> TimedPoint {
        TimedPoint::new(Point3::new(x, y, z), time_s)
    }

    #[test]
    fn a_region_is_met_in_the_one_moment_that_it_shares() {
        // A ball of 5 m that moves north with the vehicle, 7 m east of it.
        let points = [
            at(0.0, 0.0, 9.0, 10.0),
            at(20.0, 0.0, 9.0, 20.0),
            at(60.0, 0.0, 9.0, 40.0),
        ];
        let met = |points: &[TimedPoint], from_s: f64, until_s: f64| {
            let region = Region {
                velocity_mps: Vector3::new(2.0, 0.0, 0.0),
                at_s: 10.0,
                from_s,
                until_s,
                ..Region::ball(Point3::new(0.0, 12.0, 9.0), 5.0)
            };
            let closest = closest_approach(points, &[region], 0.0, |_| {})?;
            assert!((closest.clearance_m - 7.0).abs() < 1e-12, "{closest:?}");
            assert!((closest.place.x - 2.0 * (closest.time_s - 10.0)).abs() < 1e-9);
            Some(closest.time_s)
        };
        assert_eq!(met(&points, 0.0, 10.0), Some(10.0));
        assert_eq!(met(&points, 20.0, 20.0), Some(20.0));
        assert_eq!(met(&points, 27.0, 27.0), Some(27.0));
        assert_eq!(met(&points, 40.0, 99.0), Some(40.0));
        assert_eq!(met(&points, 0.0, 9.9), None);
        assert_eq!(met(&points, 40.1, 99.0), None);
        // A single place, and a rest of no duration.
        assert_eq!(met(&points[1..2], 20.0, 99.0), Some(20.0));
        assert_eq!(met(&points[1..2], 0.0, 20.0), Some(20.0));
        assert_eq!(met(&points[1..2], 0.0, 19.0), None);
        assert_eq!(met(&[points[1], points[1]], 20.0, 99.0), Some(20.0));
    }

    #[test]
    fn the_first_of_equals_is_the_closest() {
        let points = [at(0.0, 0.0, 9.0, 0.0), at(90.0, 0.0, 9.0, 45.0)];
        let regions = [20.0, 40.0, 70.0].map(|x| Region::ball(Point3::new(x, 12.0, 9.0), 5.0));
        let mut too_close = Vec::new();
        let closest = closest_approach(&points, &regions, 8.0, |a| too_close.push(a.region));
        assert_eq!((closest.unwrap().region, too_close), (0, vec![0, 1, 2]));
        let none = closest_approach(&points, &regions, 7.0, |_| unreachable!());
        assert_eq!(none.unwrap().clearance_m, 7.0);
    }

    /// The bound for a part from 10 s to 30 s in a box of 40 m by 20 m by 4 m about (20, 10, 12).
    fn bound_m(region: &Region) -> f64 {
        let corners = [
            at(0.0, 20.0, 10.0, 10.0),
            at(40.0, 0.0, 14.0, 20.0),
            at(9.0, 9.0, 11.0, 30.0),
        ];
        PartBounds::of(&corners).unwrap().gap_m(region)
    }

    fn is_bounded_by(region: Region, wanted_m: f64) {
        let found_m = bound_m(&region);
        assert!(
            (found_m - wanted_m).abs() < 1e-12,
            "{found_m} {wanted_m} {region:?}"
        );
    }

    #[test]
    fn the_bound_of_a_part_is_the_distance_of_its_box() {
        // 30 m north and 40 m east of a corner; above and below; within.
        let ball = |x: f64, y: f64, z: f64| Region::ball(Point3::new(x, y, z), 10.0);
        is_bounded_by(ball(70.0, 60.0, 12.0), 40.0);
        is_bounded_by(ball(-30.0, -40.0, 12.0), 40.0);
        is_bounded_by(ball(20.0, 10.0, 44.0), 20.0);
        is_bounded_by(ball(20.0, 10.0, -6.0), 6.0);
        is_bounded_by(ball(70.0, 10.0, 54.0), 40.0);
        is_bounded_by(ball(20.0, 10.0, 12.0), -10.0);
        // A cylinder is beside, above or below.
        let cylinder = |x: f64, y: f64, top_m: f64, bottom_m: f64| {
            Region::cylinder(Point3::new(x, y, 0.0), 10.0, top_m, bottom_m)
        };
        is_bounded_by(cylinder(70.0, 60.0, 0.0, 50.0), 40.0);
        is_bounded_by(cylinder(20.0, 10.0, 20.0, 50.0), 6.0);
        is_bounded_by(cylinder(20.0, 10.0, 0.0, 3.0), 7.0);
        is_bounded_by(cylinder(20.0, 10.0, 0.0, 50.0), -10.0);
        is_bounded_by(cylinder(70.0, 60.0, 60.0, 90.0), 46.0);
    }

    #[test]
    fn the_bound_of_a_part_holds_for_the_time_that_both_share() {
        // It moves from (65, 65) to (85, 45), its place at 15 s being (70, 60), and grows or shrinks by 2 m: the box
        // of its centre counts, and the greatest radius.
        let moving = |growth_mps: f64| Region {
            velocity_mps: Vector3::new(1.0, -1.0, 0.0),
            growth_mps,
            at_s: 15.0,
            ..Region::ball(Point3::new(70.0, 60.0, 12.0), 10.0)
        };
        is_bounded_by(moving(0.0), libm::hypot(25.0, 25.0) - 10.0);
        is_bounded_by(moving(0.1), libm::hypot(25.0, 25.0) - 11.5);
        is_bounded_by(moving(-0.1), libm::hypot(25.0, 25.0) - 10.5);
        // From 20 s to 26 s.
        let brief = Region {
            from_s: 20.0,
            until_s: 26.0,
            ..moving(0.1)
        };
        is_bounded_by(brief, libm::hypot(35.0, 29.0) - 11.1);
        // At 30 s alone, and never.
        let touching = Region {
            from_s: 30.0,
            until_s: 99.0,
            ..Region::ball(Point3::new(70.0, 60.0, 12.0), 10.0)
        };
        is_bounded_by(touching, 40.0);
        let later = Region {
            from_s: 30.1,
            ..touching
        };
        assert_eq!(bound_m(&later), f64::INFINITY);
    }
}
