//! How near a trajectory comes to the predicted regions.

use auv_obstacles::{ObstacleId, Region, RegionShape};
use auv_planning::Trajectory;
use auv_types::Point3;

/// The closest approach of a trajectory to any region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    /// Least distance to a surface in metres, or the cap.
    pub(crate) clearance_m: f64,
    /// The obstacle, when nearer than the cap.
    pub(crate) obstacle: Option<ObstacleId>,
}

/// Least clearance between `from_s` and `until_s`, exact below `cap_m`.
pub(crate) fn nearest(
    trajectory: &Trajectory,
    regions: &[Region],
    from_s: f64,
    until_s: f64,
    cap_m: f64,
) -> Nearest {
    let points = trajectory.points();
    let first = points
        .partition_point(|point| point.time_s <= from_s)
        .saturating_sub(1);
    let last = points
        .partition_point(|point| point.time_s < until_s)
        .min(points.len() - 1);
    let mut best = Nearest {
        clearance_m: cap_m,
        obstacle: None,
    };
    if first >= last {
        // The vehicle rests at one point of the trajectory.
        for region in regions {
            consider(&mut best, region.obstacle, region.distance_m(&points[last]));
        }
        return best;
    }
    let part = &points[first..=last];
    let (mut low, mut high) = (part[0].position, part[0].position);
    for point in part {
        low = Point3::from(low.coords.inf(&point.position.coords));
        high = Point3::from(high.coords.sup(&point.position.coords));
    }
    let (begin_s, end_s) = (part[0].time_s, part[part.len() - 1].time_s);
    for region in regions {
        if far_away(region, (&low, &high), (begin_s, end_s), best.clearance_m) {
            continue;
        }
        for pair in part.windows(2) {
            let from = if pair[0].time_s < from_s {
                cut(pair, from_s)
            } else {
                pair[0]
            };
            let to = if pair[1].time_s > until_s {
                cut(pair, until_s)
            } else {
                pair[1]
            };
            consider(
                &mut best,
                region.obstacle,
                region.clearance(&from, &to).clearance_m,
            );
        }
    }
    best
}

/// Least distance from a place at a time to any region, metres, at most `cap_m`.
pub(crate) fn distance_m(place: &auv_obstacles::TimedPoint, regions: &[Region], cap_m: f64) -> f64 {
    regions
        .iter()
        .map(|region| region.distance_m(place))
        .fold(cap_m, f64::min)
}

fn consider(best: &mut Nearest, obstacle: ObstacleId, clearance_m: f64) {
    if clearance_m < best.clearance_m {
        *best = Nearest {
            clearance_m,
            obstacle: Some(obstacle),
        };
    }
}

fn cut(pair: &[auv_obstacles::TimedPoint], time_s: f64) -> auv_obstacles::TimedPoint {
    let share = (time_s - pair[0].time_s) / (pair[1].time_s - pair[0].time_s);
    let position = pair[0].position + (pair[1].position - pair[0].position) * share;
    auv_obstacles::TimedPoint::new(position, time_s)
}

/// Whether the region's whole sweep stays further than `limit_m` from the box.
fn far_away(
    region: &Region,
    (low, high): (&Point3<f64>, &Point3<f64>),
    (begin_s, end_s): (f64, f64),
    limit_m: f64,
) -> bool {
    let begin_s = begin_s.max(region.from_s);
    let end_s = end_s.min(region.until_s);
    if begin_s > end_s {
        return true;
    }
    let (a, b) = (region.centre_at(begin_s), region.centre_at(end_s));
    let reach_m = region.radius_at(begin_s).max(region.radius_at(end_s)) + limit_m;
    let axes = if region.shape == RegionShape::Ball {
        3
    } else {
        2
    };
    (0..axes).any(|k| a[k].min(b[k]) - reach_m > high[k] || a[k].max(b[k]) + reach_m < low[k])
}
