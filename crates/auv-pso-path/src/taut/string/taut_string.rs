//! A finished string.

use auv_obstacles::TimedPoint;
use auv_types::Point3;

/// A taut string that is kept.
#[derive(Clone, Debug)]
pub(crate) struct TautString {
    /// Timed vertices.
    pub(crate) points: Vec<TimedPoint>,
    /// The regions that it touches, by index, each with the time, in order along the string.
    pub(crate) contacts: Vec<(usize, f64)>,
}

impl TautString {
    /// Times of start and end, seconds.
    pub(crate) fn times(&self) -> (f64, f64) {
        (
            self.points[0].time_s,
            self.points[self.points.len() - 1].time_s,
        )
    }

    /// Position at a time.
    pub(crate) fn at(&self, time_s: f64) -> Point3<f64> {
        let next = self.points.partition_point(|p| p.time_s <= time_s);
        if next == 0 {
            return self.points[0].position;
        }
        if next == self.points.len() {
            return self.points[next - 1].position;
        }
        let (a, b) = (&self.points[next - 1], &self.points[next]);
        a.position + (b.position - a.position) * ((time_s - a.time_s) / (b.time_s - a.time_s))
    }
}
