//! Movers in view, and whether a trajectory crosses their bows.

use auv_obstacles::{ObstacleId, Region, TimedPoint};
use auv_types::Vector3;
use std::collections::BTreeSet;

/// What is slower has no bow to cross, m/s.
const SLOWEST_MPS: f64 = 0.2;
/// A mover that comes by later than this after the vehicle is not crossed, seconds.
const NEAR_S: f64 = 60.0;

/// Something that moves.
pub(crate) struct Mover {
    region: Region,
    /// Its course, a unit vector.
    course: Vector3<f64>,
    speed_mps: f64,
}

impl Mover {
    /// The movers among regions that exist at a time, each once.
    pub(crate) fn of(regions: &[Region], now_s: f64) -> Vec<Self> {
        let mut known: BTreeSet<ObstacleId> = BTreeSet::new();
        let mut movers = Vec::new();
        for region in regions.iter().filter(|region| region.exists_at(now_s)) {
            let level = Vector3::new(region.velocity_mps.x, region.velocity_mps.y, 0.0);
            let speed_mps = level.norm();
            if speed_mps > SLOWEST_MPS && known.insert(region.obstacle) {
                movers.push(Self {
                    region: *region,
                    course: level / speed_mps,
                    speed_mps,
                });
            }
        }
        movers
    }

    /// Whether the vehicle changes from one side of the mover's course to the other, ahead of it, between two
    /// moments, and the mover comes by soon after.
    pub(crate) fn is_crossed(&self, step: &[TimedPoint]) -> bool {
        let seen = |moment: &TimedPoint| {
            let offset = moment.position - self.region.centre_at(moment.time_s);
            let across_m = self.course.x * offset.y - self.course.y * offset.x;
            (offset.dot(&self.course), across_m)
        };
        let [(before_m, from_m), (after_m, to_m)] = [seen(&step[0]), seen(&step[1])];
        let ahead_m = 0.5 * (before_m + after_m);
        let radius_m = self.region.radius_at(step[1].time_s);
        let soon = ahead_m > 0.0 && ahead_m < radius_m + NEAR_S * self.speed_mps;
        soon && from_m * to_m < 0.0
    }
}
