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
    use auv_types::Seed;
    use auv_types::rand::RngExt;

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
            let regions: Vec<_> = (0..15)
                .map(|i| {
                    let centre =
                        Point3::new(draw(0.0, 700.0), draw(-300.0, 300.0), draw(0.0, 60.0));
                    let mut region = if i % 3 == 0 {
                        Region::cylinder(centre, draw(1.0, 60.0), 0.0, draw(5.0, 40.0))
                    } else {
                        Region::ball(centre, draw(1.0, 60.0))
                    };
                    region.velocity_mps = Vector3::new(draw(-1.0, 1.0), draw(-1.0, 1.0), 0.0);
                    region.growth_mps = draw(-0.02, 0.1);
                    region.at_s = draw(-50.0, 50.0);
                    if i % 2 == 0 {
                        region.from_s = draw(0.0, 300.0);
                        region.until_s = region.from_s + draw(0.0, 200.0);
                    }
                    region
                })
                .collect();
            let brute = |region: &Region| {
                let segments = points.windows(2);
                segments
                    .filter_map(|pair| closest(region, &pair[0], &pair[1]))
                    .map(|(clearance_m, _)| clearance_m)
                    .fold(f64::INFINITY, f64::min)
            };
            let mut reported = Vec::new();
            let nearest = closest_approach(&points, &regions, 10.0, |a| {
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
}
