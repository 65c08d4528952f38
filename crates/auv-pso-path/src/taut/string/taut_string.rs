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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_at_its_ends_before_and_after() {
        let at = |x: f64, time_s: f64| TimedPoint::new(Point3::new(x, 0.0, 5.0), time_s);
        let string = TautString {
            points: vec![at(0.0, 10.0), at(30.0, 20.0), at(90.0, 30.0)],
            contacts: Vec::new(),
        };
        assert_eq!(string.times(), (10.0, 30.0));
        let along = |time_s: f64| string.at(time_s).x;
        assert_eq!((along(0.0), along(15.0), along(20.0)), (0.0, 15.0, 30.0));
        assert_eq!((along(25.0), along(30.0), along(99.0)), (60.0, 90.0, 90.0));
    }
}
