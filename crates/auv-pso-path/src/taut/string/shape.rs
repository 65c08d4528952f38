//! The polyline of a string: vertices, arc length and arrival times.

use crate::taut::string::segment_contact::SegmentContact;
use auv_obstacles::TimedPoint;
use auv_planning::PathProblem;
use auv_planning::motion::LEAST_SPEED_SHARE;
use auv_types::{Point3, Vector3};

/// Vertices closer than this are one, metres.
const SHORTEST_M: f64 = 0.25;
/// Least divisors: of a length, metres, and of a product of two lengths.
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
    /// Takes the vertices of a polyline. All have the time of departure until [`StringShape::time`].
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

    /// Sine of the string's turn at a vertex: about the turn in radians. 0 at the ends.
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
        // Without headway: as slow as can be, so that every other course is quicker.
        elapsed_s += piece_m / ground_mps.unwrap_or(LEAST_SPEED_SHARE * speed_mps);
    }
    elapsed_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::taut::contact::Contact;
    use auv_ocean::{CurrentField, UniformCurrent};
    use auv_planning::Vehicle;

    fn shape(points: &[(f64, f64)], problem: &PathProblem<'_>) -> StringShape {
        let polyline: Vec<_> = points
            .iter()
            .map(|&(x, y)| Point3::new(x, y, 0.0))
            .collect();
        let mut shape = StringShape::default();
        shape.reset(&polyline, problem.departure_s);
        shape.time(problem);
        shape
    }

    fn problem(vehicle: &Vehicle) -> PathProblem<'_> {
        PathProblem {
            departure_s: 100.0,
            ..PathProblem::new(Point3::origin(), Point3::new(300.0, 0.0, 0.0), vehicle)
        }
    }

    #[test]
    fn times_follow_lengths_and_the_current() {
        let vehicle = Vehicle::paper();
        let still = problem(&vehicle);
        let bent = shape(
            &[(0.0, 0.0), (30.0, 40.0), (30.0, 40.1), (300.0, 40.0)],
            &still,
        );
        assert_eq!(bent.stations, [0.0, 50.0, 320.0], "close vertices are one");
        assert_eq!(bent.points[1].time_s, 100.0 + 50.0 / 3.0);
        assert_eq!(bent.duration_s(), bent.points[2].time_s - 100.0);
        let ahead = UniformCurrent::new(Vector3::new(1.0, 0.0, 0.0));
        let carried = PathProblem {
            current: Some(&ahead),
            ..still
        };
        let straight = shape(&[(0.0, 0.0), (300.0, 0.0)], &carried);
        assert!((straight.duration_s() - 75.0).abs() < 1e-9);
        let against = UniformCurrent::new(Vector3::new(-9.0, 0.0, 0.0));
        let stopped = PathProblem {
            current: Some(&against),
            ..still
        };
        let straight = shape(&[(0.0, 0.0), (300.0, 0.0)], &stopped);
        assert!((straight.duration_s() - 10_000.0).abs() < 1e-6);
    }

    /// A current along x that grows by 1 m/s in 300 m.
    #[derive(Debug)]
    struct Growing;

    impl CurrentField for Growing {
        fn velocity_at(&self, place: &Point3<f64>, _time_s: f64) -> Vector3<f64> {
            Vector3::new(place.x / 300.0, 0.0, 0.0)
        }
        fn max_speed_mps(&self) -> f64 {
            1.0
        }
    }

    #[test]
    fn a_piece_is_timed_in_the_current_at_its_middle() {
        let vehicle = Vehicle::paper();
        let carried = PathProblem {
            current: Some(&Growing),
            ..problem(&vehicle)
        };
        let found_s = shape(&[(0.0, 0.0), (300.0, 0.0)], &carried).duration_s();
        // Speed 3 + x / 300 over 300 m.
        let exact_s = 300.0 * auv_types::libm::log(4.0 / 3.0);
        assert!((found_s - exact_s).abs() < 0.05, "{found_s} {exact_s}");
    }

    #[test]
    fn vertices_are_added_at_contacts_and_dropped_where_straight() {
        let vehicle = Vehicle::paper();
        let problem = problem(&vehicle);
        let mut string = shape(&[(0.0, 0.0), (100.0, 0.0), (300.0, 0.0)], &problem);
        let at = |segment: usize, share: f64| SegmentContact {
            region: None,
            segment,
            contact: Contact {
                share,
                normal: Vector3::z(),
                gap_m: 0.0,
            },
            force: 1.0,
        };
        // Too close to the start, chosen, too close to it, not chosen, chosen.
        let contacts = [
            at(0, 0.001),
            at(0, 0.5),
            at(0, 0.502),
            at(1, 0.25),
            at(1, 0.5),
        ];
        assert!(string.split(&contacts, |_, touch| touch.contact.share != 0.25));
        let places: Vec<f64> = string.points.iter().map(|p| p.position.x).collect();
        assert_eq!(places, [0.0, 50.0, 100.0, 200.0, 300.0]);
        string.drop_straight_vertices();
        assert_eq!(string.last(), 1);
        assert!(!string.split(&contacts[..1], |_, _| true));
    }

    #[test]
    fn a_bend_is_the_turn_of_the_string() {
        let vehicle = Vehicle::paper();
        let string = shape(
            &[(0.0, 0.0), (100.0, 0.0), (200.0, 10.0)],
            &problem(&vehicle),
        );
        assert!((string.bend(1) - 0.1).abs() < 1e-3);
        assert_eq!((string.bend(0), string.bend(2)), (0.0, 0.0));
    }
}
