//! What touches the string: regions, box and sea bed.

use super::{NO_REGION, Push, StringMaker};
use crate::field::{BAND_M, Contact, sideways};
use crate::work::LOOK_UP;
use auv_obstacles::TimedPoint;
use auv_planning::Deadline;
use auv_types::{Point3, Vector3};

/// Units of work between two looks at the deadline.
const BETWEEN_LOOKS: u64 = 5_000;

impl StringMaker<'_> {
    /// Finds all contacts of all segments, in order; those of the first segments only where the
    /// deadline passes meanwhile.
    pub(super) fn touch(&mut self, deadline: Deadline<'_>) {
        self.pushes.clear();
        let mut asked = self.work;
        let pieces = |length_m: f64| (length_m / 50.0) as u64 + 1;
        let last_segment = self.points.len() - 2;
        for segment in 0..self.points.len() - 1 {
            if self.work > asked + BETWEEN_LOOKS {
                asked = self.work;
                if deadline.passed() {
                    return;
                }
            }
            let (from, to) = (&self.points[segment], &self.points[segment + 1]);
            if self.problem.current.is_some() {
                self.work += LOOK_UP * pieces((to.position - from.position).norm());
            }
            let begin = self.pushes.len();
            let pushes = &mut self.pushes;
            self.work += 4 + self.field.contacts(from, to, |region, contact| {
                // At a vertex the segment before has said it already.
                // The ends cannot move, whatever covers them.
                let repeated = contact.share <= 1e-9;
                let at_the_end = contact.share >= 1.0 - 1e-9 && segment == last_segment;
                if !repeated && !at_the_end {
                    pushes.push(Push {
                        region,
                        segment,
                        contact,
                        force: 0.0,
                    });
                }
            });
            for push in &mut self.pushes[begin..] {
                push.contact.normal = Self::across(&self.points, segment, &push.contact);
            }
            let shares = |push: &Push| push.contact.share;
            self.pushes[begin..].sort_by(|a, b| shares(a).total_cmp(&shares(b)));
            self.touch_box(segment);
            self.touch_bed(segment);
        }
    }

    /// The part of a contact's normal across the string. Along it a push is void: a vertex that is
    /// moved on along the string is reached later by as much.
    fn across(points: &[TimedPoint], segment: usize, contact: &Contact) -> Vector3<f64> {
        let at = |i: usize| points[i.min(points.len() - 1)].position;
        let ahead = (at(segment + 1) - at(segment)).normalize();
        let along = if contact.share > 1.0 - 1e-9 && segment + 2 < points.len() {
            (ahead + (at(segment + 2) - at(segment + 1)).normalize()).normalize()
        } else {
            ahead
        };
        let across = contact.normal - along * contact.normal.dot(&along);
        // Met head-on, any side will do.
        if across.norm() > 0.05 {
            across
        } else {
            sideways(&along) * 0.05
        }
    }

    /// The box, at the vertex that ends a segment.
    fn touch_box(&mut self, segment: usize) {
        let Some(bounds) = &self.problem.bounds else {
            return;
        };
        let at = self.points[segment + 1].position;
        for k in 0..3 {
            for (gap_m, sign) in [(at[k] - bounds.low[k], 1.0), (bounds.high[k] - at[k], -1.0)] {
                if gap_m < BAND_M {
                    let mut normal = Vector3::zeros();
                    normal[k] = sign;
                    self.push_fixed(
                        segment,
                        Contact {
                            share: 1.0,
                            normal,
                            gap_m,
                        },
                    );
                }
            }
        }
    }

    /// The sea bed, where the segment comes closest to it among points 10 m apart.
    fn touch_bed(&mut self, segment: usize) {
        if self.problem.sea_bed.is_none() {
            return;
        }
        const MARGIN_M: f64 = 0.05;
        const STEP_M: f64 = 5.0;
        let (from, to) = (
            self.points[segment].position,
            self.points[segment + 1].position,
        );
        let step = to - from;
        let count = (step.norm() / 10.0).ceil().max(1.0);
        self.work += LOOK_UP * count as u64;
        let water_m = |p: &Point3<f64>| self.problem.deepest_at(p.x, p.y);
        let mut worst = (f64::INFINITY, 0.0);
        for k in 1..=count as usize {
            let share = k as f64 / count;
            let p = from + step * share;
            let left_m = water_m(&p) - p.z;
            if left_m < worst.0 {
                worst = (left_m, share);
            }
        }
        let (left_m, share) = worst;
        if left_m - MARGIN_M < BAND_M {
            let p = from + step * share;
            let slope = |dx: f64, dy: f64| {
                let ahead = Point3::new(p.x + dx, p.y + dy, p.z);
                let behind = Point3::new(p.x - dx, p.y - dy, p.z);
                ((water_m(&ahead) - water_m(&behind)) / (2.0 * STEP_M)).clamp(-5.0, 5.0)
            };
            let away = Vector3::new(slope(STEP_M, 0.0), slope(0.0, STEP_M), -1.0);
            let steepness = away.norm();
            let contact = Contact {
                share,
                normal: away / steepness,
                gap_m: (left_m - MARGIN_M) / steepness,
            };
            self.push_fixed(segment, contact);
        }
    }

    fn push_fixed(&mut self, segment: usize, contact: Contact) {
        self.pushes.push(Push {
            region: NO_REGION,
            segment,
            contact,
            force: 0.0,
        });
    }
}
