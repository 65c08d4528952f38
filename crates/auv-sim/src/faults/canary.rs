//! A fault that every run must report: it tests the judge itself.

use super::injection::Injection;
use auv_obstacles::TimedPoint;
use auv_planning::Trajectory;
use auv_types::Vector3;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of trajectories replaced so far. It makes two flights of one mission differ, which the double
/// check must find.
static REPLACED: AtomicU64 = AtomicU64::new(1);

/// Replaces the trajectory in force by an unverified one.
pub(super) struct Canary;

impl Injection for Canary {
    fn tamper(&mut self, trajectory: Arc<Trajectory>) -> Arc<Trajectory> {
        let mut points = trajectory.points().to_vec();
        let jump_m = 500.0 + REPLACED.fetch_add(1, Ordering::Relaxed) as f64;
        for point in points.iter_mut().skip(1) {
            *point = TimedPoint::new(point.position + Vector3::x() * jump_m, point.time_s);
        }
        Trajectory::new(points).map_or(trajectory, Arc::new)
    }
}
