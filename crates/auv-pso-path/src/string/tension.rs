//! Where tension and contact forces put the string.

use super::{CLEAR_M, NO_REGION, Push, StringMaker};
use auv_types::Vector3;

impl StringMaker<'_> {
    /// One round: all contact forces, and the string where they put it, no vertex moving farther than
    /// `trust_m`. Returns false when the contacts leave no way between them.
    pub(super) fn release(&mut self, trust_m: f64) -> bool {
        let last = self.points.len() - 1;
        self.stiffen();
        self.relax();
        let (stations, moves) = (&self.stations, &self.moves);
        let total_m = stations[last];
        // The string's answer at one station to a unit force at another.
        let green = |a: f64, b: f64| a.min(b) * (total_m - a.max(b)) / total_m;
        let at = |push: &Push| {
            let (a, b) = (stations[push.segment], stations[push.segment + 1]);
            a + (b - a) * push.contact.share
        };
        self.free_gaps.clear();
        for push in &self.pushes {
            let (a, b) = (&moves[push.segment], &moves[push.segment + 1]);
            let moved = a + (b - a) * push.contact.share;
            // The ends stay where they are, whatever pushes there.
            let fixed = green(at(push), at(push)) <= 1e-9 * total_m;
            self.free_gaps.push(if fixed {
                f64::INFINITY
            } else {
                push.contact.gap_m + push.contact.normal.dot(&moved)
            });
        }
        let pushes = &self.pushes;
        let matrix = |c: usize, d: usize| {
            let (c, d) = (&pushes[c], &pushes[d]);
            let together = c.contact.normal.dot(&d.contact.normal);
            if c.segment != d.segment {
                return together * green(at(c), at(d));
            }
            // Within one segment the string stays straight.
            let (a, b) = (stations[c.segment], stations[c.segment + 1]);
            let (s, t) = (c.contact.share, d.contact.share);
            let bilinear = (1.0 - s) * (1.0 - t) * green(a, a)
                + (s + t - 2.0 * s * t) * green(a, b)
                + s * t * green(b, b);
            together * bilinear
        };
        let touching = |c: usize| pushes[c].contact.gap_m < CLEAR_M && self.free_gaps[c] < 0.0;
        let force = self.forces.solve(&self.free_gaps, touching, matrix);
        for (push, &force) in self.pushes.iter_mut().zip(force) {
            push.force = force;
        }
        self.work += self.forces.take_work();
        let mut farthest_m = 0.0_f64;
        for k in 1..last {
            let here = self.stations[k];
            let mut step = self.moves[k];
            for push in self.pushes.iter().filter(|push| push.force > 0.0) {
                let (a, b) = (self.stations[push.segment], self.stations[push.segment + 1]);
                let share = push.contact.share;
                let answer = (1.0 - share) * green(here, a) + share * green(here, b);
                step += push.contact.normal * (push.force * answer);
            }
            farthest_m = farthest_m.max(step.norm());
            self.moves[k] = step;
        }
        if !farthest_m.is_finite() || farthest_m > 10.0 * total_m {
            return false;
        }
        let scale = (trust_m / farthest_m.max(1e-12)).min(1.0);
        for (point, step) in self.points.iter_mut().zip(&self.moves) {
            point.position += step * scale;
        }
        true
    }

    /// Shortens the stations of segments that lie on a region: a segment that tilts there comes
    /// closer to the centre, so it is stiffer than its length says (the curvature of the contact in
    /// Newton's method).
    fn stiffen(&mut self) {
        let mut push = self.pushes.iter().peekable();
        let mut added_m = 0.0;
        let mut before_m = 0.0;
        for segment in 0..self.points.len() - 1 {
            let length_m = self.stations[segment + 1] - before_m;
            before_m = self.stations[segment + 1];
            let mut curvature_m = 0.0_f64;
            while let Some(touch) = push.next_if(|push| push.segment == segment) {
                if touch.region != NO_REGION && touch.contact.gap_m < 0.1 {
                    let (_, radius_m) = self.field.at(touch.region, self.points[segment].time_s);
                    curvature_m = curvature_m.max(radius_m);
                }
            }
            let bend = 0.5 * (self.bend(segment) + self.bend(segment + 1));
            added_m += length_m / (1.0 + (bend * curvature_m / length_m).min(3.0));
            self.softened.push(added_m);
        }
        self.stations.truncate(1);
        self.stations.append(&mut self.softened);
    }

    /// The moves of a string that nothing touches: Newton's step for the length.
    fn relax(&mut self) {
        let last = self.points.len() - 1;
        let pull = |k: usize| {
            let step = self.points[k + 1].position - self.points[k].position;
            step / step.norm().max(1e-9)
        };
        let weight = |k: usize| 1.0 / (self.stations[k + 1] - self.stations[k]);
        self.moves.clear();
        self.moves.resize(last + 1, Vector3::zeros());
        self.softened.clear();
        self.softened.push(0.0);
        for k in 1..last {
            let (before, after) = (weight(k - 1), weight(k));
            let pivot = before + after - before * self.softened[k - 1];
            self.softened.push(after / pivot);
            self.moves[k] = (pull(k) - pull(k - 1) + self.moves[k - 1] * before) / pivot;
        }
        for k in (1..last).rev() {
            let next = self.moves[k + 1];
            self.moves[k] += next * self.softened[k];
        }
        self.softened.clear();
    }
}
