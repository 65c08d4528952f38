//! The polyline of a string: vertices, arc length and arrival times.

use crate::taut::string::segment_contact::SegmentContact;
use auv_obstacles::TimedPoint;
use auv_planning::PathProblem;
use auv_planning::motion::LEAST_SPEED_SHARE;
use auv_types::{Point3, Vector3};

/// Vertices closer than this are one, metres.
const SHORTEST_M: f64 = 0.25;
/// Least length and product of lengths that are divided by.
const LEAST_LENGTH_M: f64 = 1e-9;
const LEAST_PRODUCT: f64 = 1e-12;
/// A vertex closer than this to the chord of its neighbours is straight, metres.
const STRAIGHT_M: f64 = 1e-4;
/// A segment is timed in pieces of this length where the water moves, metres.
const CURRENT_PIECE_M: f64 = 50.0;

/// A string's vertices, timed, and the arc length up to each.
#[derive(Debug, Default)]
pub(crate) struct StringShape {
    pub(crate) points: Vec<TimedPoint>,
    pub(crate) stations: Vec<f64>,
}

impl StringShape {
    /// Takes the vertices of a polyline. Only the first has its time.
    pub(crate) fn reset(&mut self, polyline: &[Point3<f64>], departure_s: f64) {
        self.points.clear();
        let vertices = polyline.iter().map(|&p| TimedPoint::new(p, departure_s));
        self.points.extend(vertices);
    }

    pub(crate) fn last(&self) -> usize {
        self.points.len() - 1
    }

    pub(crate) fn position(&self, vertex: usize) -> Point3<f64> {
        self.points[vertex].position
    }

    /// Total arc length, metres.
    pub(crate) fn length_m(&self) -> f64 {
        self.stations[self.last()]
    }

    /// Time from the start to the end, seconds.
    pub(crate) fn duration_s(&self) -> f64 {
        self.points[self.last()].time_s - self.points[0].time_s
    }

    /// Merges coinciding vertices, then computes stations and arrival times.
    pub(crate) fn time(&mut self, problem: &PathProblem<'_>) {
        let last = self.last();
        let end = self.points[last];
        let mut kept = 1;
        for i in 1..last {
            let step = self.points[i].position - self.points[kept - 1].position;
            if step.norm() > SHORTEST_M
                && (end.position - self.points[i].position).norm() > SHORTEST_M
            {
                self.points[kept] = self.points[i];
                kept += 1;
            }
        }
        self.points[kept] = end;
        self.points.truncate(kept + 1);
        self.stations.clear();
        self.stations.push(0.0);
        for i in 1..self.points.len() {
            let before = self.points[i - 1];
            let step = self.points[i].position - before.position;
            let length_m = step.norm().max(LEAST_LENGTH_M);
            self.stations.push(self.stations[i - 1] + length_m);
            self.points[i].time_s =
                before.time_s + segment_duration_s(problem, &before, &step, length_m);
        }
    }

    /// Turn of the string at a vertex, about in radians (0 at the ends).
    pub(crate) fn bend(&self, vertex: usize) -> f64 {
        if vertex == 0 || vertex + 1 >= self.points.len() {
            return 0.0;
        }
        let at = |i: usize| self.points[i].position;
        let (before, after) = (at(vertex) - at(vertex - 1), at(vertex + 1) - at(vertex));
        before.cross(&after).norm() / (before.norm() * after.norm()).max(LEAST_PRODUCT)
    }

    /// Adds a vertex at every chosen contact that is far enough from the vertex before and from the
    /// segment's end. Returns whether it added any. Contacts are in order along the string.
    pub(crate) fn split(
        &mut self,
        contacts: &[SegmentContact],
        chosen: impl Fn(&Self, &SegmentContact) -> bool,
    ) -> bool {
        let spacing_m = 2.0 * SHORTEST_M;
        let mut added: Vec<(usize, Point3<f64>)> = Vec::new();
        let (mut segment, mut last_m) = (usize::MAX, 0.0);
        for touch in contacts {
            if touch.segment != segment {
                (segment, last_m) = (touch.segment, 0.0);
            }
            let length_m = self.stations[segment + 1] - self.stations[segment];
            let share = touch.contact.share;
            let at_m = share * length_m;
            if at_m > last_m + spacing_m && at_m < length_m - spacing_m && chosen(self, touch) {
                let (a, b) = (self.position(segment), self.position(segment + 1));
                added.push((segment, a + (b - a) * share));
                last_m = at_m;
            }
        }
        for &(segment, position) in added.iter().rev() {
            self.points
                .insert(segment + 1, TimedPoint::new(position, 0.0));
        }
        !added.is_empty()
    }

    /// Drops vertices at which the string is straight.
    pub(crate) fn drop_straight_vertices(&mut self) {
        let last = self.last();
        let mut kept = 1;
        for i in 1..last {
            let (a, b) = (self.points[kept - 1].position, self.points[i + 1].position);
            let p = self.points[i].position;
            let chord = b - a;
            let off_m = (p - a).cross(&chord).norm() / chord.norm().max(LEAST_LENGTH_M);
            if off_m > STRAIGHT_M || (p - a).dot(&chord) < 0.0 {
                self.points[kept] = self.points[i];
                kept += 1;
            }
        }
        self.points[kept] = self.points[last];
        self.points.truncate(kept + 1);
    }
}

/// Duration of a segment.
fn segment_duration_s(
    problem: &PathProblem<'_>,
    from: &TimedPoint,
    step: &Vector3<f64>,
    length_m: f64,
) -> f64 {
    let speed_mps = problem.vehicle.speed_mps;
    if problem.current.is_none() {
        return length_m / speed_mps;
    }
    let direction = step / length_m;
    let pieces = (length_m / CURRENT_PIECE_M).ceil().max(1.0);
    let piece_m = length_m / pieces;
    let mut elapsed_s = 0.0;
    for k in 0..pieces as usize {
        let middle = from.position + direction * (piece_m * (k as f64 + 0.5));
        let now_s = from.time_s + elapsed_s + 0.5 * piece_m / speed_mps;
        let ground_mps = problem.ground_speed_mps(&direction, &middle, now_s);
        // Where no way is made, as slow as the slowest: every other course is quicker.
        elapsed_s += piece_m / ground_mps.unwrap_or(LEAST_SPEED_SHARE * speed_mps);
    }
    elapsed_s
}
