//! What touches a string: regions, box and sea bed.

use crate::taut::contact::{BAND_M, Contact, sideways};
use crate::taut::regions::GrownRegions;
use crate::taut::string::segment_contact::SegmentContact;
use crate::taut::string::shape::StringShape;
use crate::taut::work::LOOK_UP;
use auv_planning::{Deadline, PathProblem};
use auv_types::{Point3, Vector3};

/// Units of work between two looks at the deadline.
const BETWEEN_LOOKS: u64 = 5_000;
/// Units of work of a segment beside its regions.
const SEGMENT_WORK: u64 = 4;
/// The current is looked up once for this length of a segment, metres.
const CURRENT_PIECE_M: f64 = 50.0;
/// A share of a segment this close to 0 or 1 is its end.
const END_SHARE: f64 = 1e-9;
/// A region is met head-on where less of its normal than this lies across the string.
const HEAD_ON: f64 = 0.05;
/// Distance of the places at which a segment is compared with the sea bed, metres.
const BED_SPACING_M: f64 = 10.0;
/// Metres kept above the deepest allowed, because the bed is only sampled.
const BED_MARGIN_M: f64 = 0.05;
/// Half the base of the difference that gives the bed's slope, metres.
const SLOPE_BASE_M: f64 = 5.0;
/// Slopes of the bed are limited to this: at a cliff the normal would be level.
const STEEPEST: f64 = 5.0;

/// Finds the contacts of strings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactFinder<'a> {
    pub(crate) problem: &'a PathProblem<'a>,
    pub(crate) regions: &'a GrownRegions,
}

impl ContactFinder<'_> {
    /// Finds the contacts of all segments, in order along the string, and adds its work to `work`. If
    /// the deadline passes, the last segments are left out.
    pub(crate) fn find(
        &self,
        shape: &StringShape,
        contacts: &mut Vec<SegmentContact>,
        work: &mut u64,
        deadline: Deadline<'_>,
    ) {
        contacts.clear();
        let mut asked = *work;
        for segment in 0..shape.last() {
            if *work > asked + BETWEEN_LOOKS {
                asked = *work;
                if deadline.passed() {
                    return;
                }
            }
            self.touch_regions(shape, segment, contacts, work);
            self.touch_box(shape, segment, contacts);
            self.touch_bed(shape, segment, contacts, work);
        }
    }

    /// The regions near a segment, in order along it.
    fn touch_regions(
        &self,
        shape: &StringShape,
        segment: usize,
        contacts: &mut Vec<SegmentContact>,
        work: &mut u64,
    ) {
        let (from, to) = (&shape.points[segment], &shape.points[segment + 1]);
        if self.problem.current.is_some() {
            let length_m = (to.position - from.position).norm();
            *work += LOOK_UP * ((length_m / CURRENT_PIECE_M) as u64 + 1);
        }
        let first = contacts.len();
        *work += SEGMENT_WORK
            + self.regions.contacts(from, to, |region, contact| {
                // The segment before has the contacts of the vertex between. The ends of the string
                // cannot move, whatever covers them.
                let repeated = contact.share <= END_SHARE;
                let at_the_end = contact.share >= 1.0 - END_SHARE && segment + 1 == shape.last();
                if !repeated && !at_the_end {
                    contacts.push(SegmentContact {
                        region: Some(region),
                        segment,
                        contact,
                        force: 0.0,
                    });
                }
            });
        for touch in &mut contacts[first..] {
            touch.contact.normal = across(shape, segment, &touch.contact);
        }
        let share = |touch: &SegmentContact| touch.contact.share;
        contacts[first..].sort_by(|a, b| share(a).total_cmp(&share(b)));
    }

    /// The box, at the vertex that ends a segment.
    fn touch_box(&self, shape: &StringShape, segment: usize, contacts: &mut Vec<SegmentContact>) {
        let Some(bounds) = &self.problem.bounds else {
            return;
        };
        let at = shape.position(segment + 1);
        for k in 0..3 {
            for (gap_m, sign) in [(at[k] - bounds.low[k], 1.0), (bounds.high[k] - at[k], -1.0)] {
                if gap_m < BAND_M {
                    let mut normal = Vector3::zeros();
                    normal[k] = sign;
                    let contact = Contact {
                        share: 1.0,
                        normal,
                        gap_m,
                    };
                    contacts.push(fixed(segment, contact));
                }
            }
        }
    }

    /// The sea bed, at the sample of the segment that comes closest to it.
    fn touch_bed(
        &self,
        shape: &StringShape,
        segment: usize,
        contacts: &mut Vec<SegmentContact>,
        work: &mut u64,
    ) {
        if self.problem.sea_bed.is_none() {
            return;
        }
        let from = shape.position(segment);
        let step = shape.position(segment + 1) - from;
        let count = (step.norm() / BED_SPACING_M).ceil().max(1.0);
        *work += LOOK_UP * count as u64;
        let deepest_m = |p: &Point3<f64>| self.problem.deepest_at(p.x, p.y);
        let mut worst = (f64::INFINITY, 0.0);
        for k in 1..=count as usize {
            let share = k as f64 / count;
            let p = from + step * share;
            let left_m = deepest_m(&p) - p.z;
            if left_m < worst.0 {
                worst = (left_m, share);
            }
        }
        let (left_m, share) = worst;
        if left_m - BED_MARGIN_M < BAND_M {
            let p = from + step * share;
            let slope = |dx: f64, dy: f64| {
                let ahead = Point3::new(p.x + dx, p.y + dy, p.z);
                let behind = Point3::new(p.x - dx, p.y - dy, p.z);
                let rise_m = deepest_m(&ahead) - deepest_m(&behind);
                (rise_m / (2.0 * SLOPE_BASE_M)).clamp(-STEEPEST, STEEPEST)
            };
            let away = Vector3::new(slope(SLOPE_BASE_M, 0.0), slope(0.0, SLOPE_BASE_M), -1.0);
            let steepness = away.norm();
            let contact = Contact {
                share,
                normal: away / steepness,
                gap_m: (left_m - BED_MARGIN_M) / steepness,
            };
            contacts.push(fixed(segment, contact));
        }
    }
}

/// A contact with the box or the bed.
fn fixed(segment: usize, contact: Contact) -> SegmentContact {
    SegmentContact {
        region: None,
        segment,
        contact,
        force: 0.0,
    }
}

/// The part of a contact's normal across the string. A push along the string opens no gap, because
/// the vertex is then reached later by as much.
fn across(shape: &StringShape, segment: usize, contact: &Contact) -> Vector3<f64> {
    let at = |i: usize| shape.position(i.min(shape.last()));
    let ahead = (at(segment + 1) - at(segment)).normalize();
    let along = if contact.share > 1.0 - END_SHARE && segment + 2 < shape.points.len() {
        (ahead + (at(segment + 2) - at(segment + 1)).normalize()).normalize()
    } else {
        ahead
    };
    let across = contact.normal - along * contact.normal.dot(&along);
    // Head-on, both sides are as good.
    if across.norm() > HEAD_ON {
        across
    } else {
        sideways(&along) * HEAD_ON
    }
}
