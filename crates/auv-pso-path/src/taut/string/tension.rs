//! Where tension and contact forces put a string.

use crate::taut::regions::GrownRegions;
use crate::taut::string::forces::ContactForces;
use crate::taut::string::segment_contact::SegmentContact;
use crate::taut::string::shape::StringShape;
use auv_types::Vector3;

/// Penetration that counts as none, metres: within the margin of the grown regions.
pub(crate) const CLEAR_M: f64 = 1e-3;
/// A place that yields less than this to a unit force, as a share of the string's length, is an end.
const FIXED: f64 = 1e-9;
/// The contacts leave no room between them where a vertex would move farther than this many lengths
/// of the string.
const NO_ROOM: f64 = 10.0;
/// Least divisors: of a length and of a move, metres.
const LEAST_LENGTH_M: f64 = 1e-9;
const LEAST_MOVE_M: f64 = 1e-12;
/// A region this close to a segment stiffens it, metres.
const LYING_ON_M: f64 = 0.1;
/// Most that contacts add to a segment's stiffness, as a multiple of its own.
const MOST_STIFFENING: f64 = 3.0;

/// Moves strings, a round at a time. Keeps its buffers from call to call.
#[derive(Debug, Default)]
pub(crate) struct Tension {
    moves: Vec<Vector3<f64>>,
    softened: Vec<f64>,
    free_gaps: Vec<f64>,
    forces: ContactForces,
}

impl Tension {
    /// One round: solves for all contact forces and moves the string to where they put it, no vertex
    /// farther than `trust_m`. Returns false where the contacts leave no room between them.
    pub(crate) fn release(
        &mut self,
        shape: &mut StringShape,
        contacts: &mut [SegmentContact],
        regions: &GrownRegions,
        trust_m: f64,
        work: &mut u64,
    ) -> bool {
        self.stiffen(shape, contacts, regions);
        self.relax(shape);
        self.push_off(shape, contacts, work);
        let farthest_m = self.add_contact_moves(shape, contacts);
        if !farthest_m.is_finite() || farthest_m > NO_ROOM * shape.length_m() {
            return false;
        }
        let scale = (trust_m / farthest_m.max(LEAST_MOVE_M)).min(1.0);
        for (point, step) in shape.points.iter_mut().zip(&self.moves) {
            point.position += step * scale;
        }
        true
    }

    /// Shortens the stations of segments that lie on a region. Such a segment comes closer to the
    /// centre when it tilts, so it is stiffer than its length says (the curvature of the contact in
    /// Newton's method).
    fn stiffen(
        &mut self,
        shape: &mut StringShape,
        contacts: &[SegmentContact],
        regions: &GrownRegions,
    ) {
        let mut touches = contacts.iter().peekable();
        let mut added_m = 0.0;
        let mut before_m = 0.0;
        for segment in 0..shape.last() {
            let length_m = shape.stations[segment + 1] - before_m;
            before_m = shape.stations[segment + 1];
            let mut curvature_m = 0.0_f64;
            while let Some(touch) = touches.next_if(|touch| touch.segment == segment) {
                if let Some(region) = touch.region
                    && touch.contact.gap_m < LYING_ON_M
                {
                    let (_, radius_m) = regions.at(region, shape.points[segment].time_s);
                    curvature_m = curvature_m.max(radius_m);
                }
            }
            let bend = 0.5 * (shape.bend(segment) + shape.bend(segment + 1));
            added_m += length_m / (1.0 + (bend * curvature_m / length_m).min(MOST_STIFFENING));
            self.softened.push(added_m);
        }
        shape.stations.truncate(1);
        shape.stations.append(&mut self.softened);
    }

    /// The moves of a string that nothing touches: Newton's step for the length.
    fn relax(&mut self, shape: &StringShape) {
        let last = shape.last();
        let tension = |k: usize| {
            let step = shape.position(k + 1) - shape.position(k);
            step / step.norm().max(LEAST_LENGTH_M)
        };
        let weight = |k: usize| 1.0 / (shape.stations[k + 1] - shape.stations[k]);
        self.moves.clear();
        self.moves.resize(last + 1, Vector3::zeros());
        self.softened.clear();
        self.softened.push(0.0);
        for k in 1..last {
            let (before, after) = (weight(k - 1), weight(k));
            let pivot = before + after - before * self.softened[k - 1];
            self.softened.push(after / pivot);
            self.moves[k] = (tension(k) - tension(k - 1) + self.moves[k - 1] * before) / pivot;
        }
        for k in (1..last).rev() {
            let next = self.moves[k + 1];
            self.moves[k] += next * self.softened[k];
        }
        self.softened.clear();
    }

    /// Solves for the forces of all contacts together.
    fn push_off(&mut self, shape: &StringShape, contacts: &mut [SegmentContact], work: &mut u64) {
        let (stations, moves, total_m) = (&shape.stations, &self.moves, shape.length_m());
        let at = |touch: &SegmentContact| {
            let (a, b) = (stations[touch.segment], stations[touch.segment + 1]);
            a + (b - a) * touch.contact.share
        };
        self.free_gaps.clear();
        for touch in &*contacts {
            let (a, b) = (&moves[touch.segment], &moves[touch.segment + 1]);
            let moved = a + (b - a) * touch.contact.share;
            // The ends stay where they are, whatever pushes there.
            let fixed = green(total_m, at(touch), at(touch)) <= FIXED * total_m;
            self.free_gaps.push(if fixed {
                f64::INFINITY
            } else {
                touch.contact.gap_m + touch.contact.normal.dot(&moved)
            });
        }
        let touches = &*contacts;
        let matrix = |c: usize, d: usize| {
            let (c, d) = (&touches[c], &touches[d]);
            let together = c.contact.normal.dot(&d.contact.normal);
            if c.segment != d.segment {
                return together * green(total_m, at(c), at(d));
            }
            // Within one segment the string stays straight.
            let (a, b) = (stations[c.segment], stations[c.segment + 1]);
            let (s, t) = (c.contact.share, d.contact.share);
            let bilinear = (1.0 - s) * (1.0 - t) * green(total_m, a, a)
                + (s + t - 2.0 * s * t) * green(total_m, a, b)
                + s * t * green(total_m, b, b);
            together * bilinear
        };
        let free_gaps = &self.free_gaps;
        let touching = |c: usize| touches[c].contact.gap_m < CLEAR_M && free_gaps[c] < 0.0;
        let forces = self.forces.solve(free_gaps, touching, matrix);
        for (touch, &force) in contacts.iter_mut().zip(forces) {
            touch.force = force;
        }
        *work += self.forces.take_work();
    }

    /// Adds to the moves what the forces do. Returns the farthest move, metres.
    fn add_contact_moves(&mut self, shape: &StringShape, contacts: &[SegmentContact]) -> f64 {
        let (stations, total_m) = (&shape.stations, shape.length_m());
        let mut farthest_m = 0.0_f64;
        for k in 1..shape.last() {
            let here = stations[k];
            let mut step = self.moves[k];
            for touch in contacts.iter().filter(|touch| touch.force > 0.0) {
                let (a, b) = (stations[touch.segment], stations[touch.segment + 1]);
                let share = touch.contact.share;
                let answer =
                    (1.0 - share) * green(total_m, here, a) + share * green(total_m, here, b);
                step += touch.contact.normal * (touch.force * answer);
            }
            farthest_m = farthest_m.max(step.norm());
            self.moves[k] = step;
        }
        farthest_m
    }
}

/// How far a string of `total_m` yields at one station to a unit force at another (its Green
/// function).
fn green(total_m: f64, a: f64, b: f64) -> f64 {
    a.min(b) * (total_m - a.max(b)) / total_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::taut::contact::Contact;
    use auv_planning::{PathProblem, Vehicle};
    use auv_types::Point3;

    /// One round of a string of 300 m with a vertex at 100 m, `off_m` off the line.
    fn released(off_m: f64, contacts: &mut [SegmentContact]) -> Option<StringShape> {
        let vehicle = Vehicle::paper();
        let target = Point3::new(300.0, 0.0, 0.0);
        let problem = PathProblem::new(Point3::origin(), target, &vehicle);
        let regions = GrownRegions::new(&problem, 0.0, false);
        let mut shape = StringShape::default();
        shape.reset(
            &[problem.start, Point3::new(100.0, off_m, 0.0), target],
            0.0,
        );
        shape.time(&problem);
        let mut work = 0;
        Tension::default()
            .release(&mut shape, contacts, &regions, f64::INFINITY, &mut work)
            .then_some(shape)
    }

    fn vertex_contact(gap_m: f64, sign: f64) -> SegmentContact {
        SegmentContact {
            region: None,
            segment: 0,
            contact: Contact {
                share: 1.0,
                normal: Vector3::y() * sign,
                gap_m,
            },
            force: 0.0,
        }
    }

    #[test]
    fn a_free_string_becomes_straight() {
        let straight = released(3.0, &mut []).unwrap();
        assert!(straight.position(1).y.abs() < 1e-2);
    }

    #[test]
    fn a_contact_holds_the_string_where_its_gap_closes() {
        // The vertex lies 3 m off and may come back by 1 m only.
        let mut contacts = [vertex_contact(1.0, 1.0)];
        let held = released(3.0, &mut contacts).unwrap();
        assert!((held.position(1).y - 2.0).abs() < 1e-2);
        // Equilibrium: the force is the sum of the slopes of both sides.
        assert!((contacts[0].force - (2.0 / 100.0 + 2.0 / 200.0)).abs() < 1e-3);
        let mut open = [vertex_contact(5.0, 1.0)];
        assert!(released(3.0, &mut open).unwrap().position(1).y.abs() < 1e-2);
        assert_eq!(open[0].force, 0.0);
    }

    #[test]
    fn the_yield_is_mutual_and_that_of_a_triangle() {
        for (a, b) in [(20.0, 70.0), (50.0, 50.0), (0.0, 30.0)] {
            assert_eq!(green(100.0, a, b), green(100.0, b, a));
        }
        // A unit force in the middle of a unit tension: both sides have slope one half.
        assert_eq!(green(100.0, 50.0, 50.0), 25.0);
        assert_eq!(green(100.0, 50.0, 25.0), 12.5);
        assert_eq!(green(100.0, 100.0, 40.0), 0.0);
    }
}
