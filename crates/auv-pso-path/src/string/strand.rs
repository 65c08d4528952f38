//! A finished string.

use super::StringMaker;
use auv_obstacles::TimedPoint;
use auv_types::Point3;

/// A string that is kept: timed vertices, and the contacts it has.
#[derive(Clone, Debug)]
pub(crate) struct Strand {
    pub(crate) points: Vec<TimedPoint>,
    pub(crate) contacts: Vec<(usize, f64)>,
}

impl Strand {
    pub(crate) fn of(maker: &StringMaker<'_>) -> Self {
        let points = maker.points().to_vec();
        let mut contacts: Vec<(usize, f64)> = Vec::new();
        for (region, time_s, _) in maker.touched() {
            if contacts.last().is_none_or(|last| last.0 != region) {
                contacts.push((region, time_s));
            }
        }
        Self { points, contacts }
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
