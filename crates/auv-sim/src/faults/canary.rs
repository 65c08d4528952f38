//! The fault that must be found: if it is not, the judge is asleep.

use super::injection::Injection;
use auv_obstacles::TimedPoint;
use auv_planning::Trajectory;
use auv_types::Vector3;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// How often it has sung, by which two flights of one mission differ: that must be found too.
static SUNG: AtomicU64 = AtomicU64::new(1);

/// Swaps the trajectory in force for one that nobody verified.
pub(super) struct Canary;

impl Injection for Canary {
    fn tamper(&mut self, trajectory: Arc<Trajectory>) -> Arc<Trajectory> {
        let mut points = trajectory.points().to_vec();
        let jump_m = 500.0 + SUNG.fetch_add(1, Ordering::Relaxed) as f64;
        for point in points.iter_mut().skip(1) {
            *point = TimedPoint::new(point.position + Vector3::x() * jump_m, point.time_s);
        }
        Trajectory::new(points).map_or(trajectory, Arc::new)
    }
}
