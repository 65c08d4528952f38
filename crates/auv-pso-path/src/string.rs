//! A string under tension among the regions: the shortest polyline of its kind.
//!
//! Without contacts a taut string is straight; every contact pushes it along the contact's normal.
//! For small steps the positions are linear in the contact forces (the string's Green function), so
//! one round finds all forces together as a linear complementarity problem. Rounds repeat until
//! contacts, times and lengths agree; then vertices are added where the string wraps a region.

use crate::complementarity::Forces;
use crate::field::{Contact, Field, sideways};
use crate::work::LOOK_UP;
use auv_obstacles::TimedPoint;
use auv_planning::{Deadline, PathProblem};
use auv_types::{Point3, Vector3};

/// What one thread needs to pull strings taut.
#[derive(Debug)]
pub(crate) struct StringMaker<'a> {
    problem: &'a PathProblem<'a>,
    field: &'a Field,
    points: Vec<TimedPoint>,
    /// The quickest clear state of the string being pulled.
    clear_points: Vec<TimedPoint>,
    stations: Vec<f64>,
    softened: Vec<f64>,
    moves: Vec<Vector3<f64>>,
    pushes: Vec<Push>,
    free_gaps: Vec<f64>,
    forces: Forces,
    /// Units of the pull under way.
    work: u64,
}

/// A contact of one segment of the string.
#[derive(Clone, Copy, Debug)]
struct Push {
    region: usize,
    segment: usize,
    contact: Contact,
    force: f64,
}

/// How long a string is pulled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull<'a> {
    /// Most rounds.
    pub(crate) rounds: u64,
    /// Farthest move of a vertex in the first round, metres: below the band in which regions are
    /// seen, a string stays on its side of them.
    pub(crate) trust_m: f64,
    /// Gain of a round, as a share of the straight line, below which it is taut.
    pub(crate) tolerance: f64,
    /// A string that takes longer than this is given up, seconds.
    pub(crate) limit_s: f64,
    /// Units of work after which it is given up.
    pub(crate) work: u64,
    /// Asked between rounds.
    pub(crate) deadline: Deadline<'a>,
}

/// What became of a string.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pulled {
    /// Whether it ended clear of everything.
    pub(crate) clear: bool,
    /// Units of work that took.
    pub(crate) work: u64,
}

/// A string that is kept: timed vertices, and the contacts it has.
#[derive(Clone, Debug)]
pub(crate) struct Strand {
    pub(crate) points: Vec<TimedPoint>,
    pub(crate) contacts: Vec<(usize, f64)>,
}

/// A push that belongs to no region: the box or the sea bed.
const NO_REGION: usize = usize::MAX;
/// Penetration that counts as none while pulling, metres: within the field's margin.
const CLEAR_M: f64 = 1e-3;
/// Vertices closer than this are one, metres.
const SHORTEST_M: f64 = 0.25;
/// A string with more contacts than this is given up.
const MOST_CONTACTS: usize = 100;
/// Excess of a bend over the arc it stands for that is left, as a share of the straight line.
const WRAP: f64 = 5e-6;

impl<'a> StringMaker<'a> {
    pub(crate) fn new(problem: &'a PathProblem<'a>, field: &'a Field) -> Self {
        Self {
            problem,
            field,
            points: Vec::new(),
            clear_points: Vec::new(),
            stations: Vec::new(),
            softened: Vec::new(),
            moves: Vec::new(),
            pushes: Vec::new(),
            free_gaps: Vec::new(),
            forces: Forces::default(),
            work: 0,
        }
    }

    /// Pulls a polyline taut, its ends fixed and left at `departure_s`, in at most `rounds` rounds.
    ///
    /// Rounds end early when one gains less than the tolerance, when the string is slower than
    /// `limit_s`, when its work is spent, or when it is tangled: among too many regions, or no longer
    /// coming free of them.
    /// [`StringMaker::points`] holds the string whatever the outcome.
    pub(crate) fn pull(
        &mut self,
        seed: &[Point3<f64>],
        departure_s: f64,
        pull: &Pull<'_>,
    ) -> Pulled {
        self.work = 0;
        self.points.clear();
        self.points
            .extend(seed.iter().map(|&p| TimedPoint::new(p, departure_s)));
        let last = self.points.len() - 1;
        let line_m = (self.points[last].position - self.points[0].position)
            .norm()
            .max(1.0);
        let tolerance_m = pull.tolerance * line_m;
        let mut trust_m = pull.trust_m.min(0.5 * line_m);
        let mut refinements = 0;
        let mut before_m = f64::INFINITY;
        let mut clear_s = f64::INFINITY;
        // A bump is one of many; a seed is worth more.
        let patience = if pull.limit_s.is_finite() { 6 } else { 14 };
        let (mut least_m, mut least_round) = (f64::INFINITY, 0);
        let mut round = 0;
        loop {
            self.time();
            self.touch();
            if self.split_where_inside() {
                self.time();
                self.touch();
            }
            round += 1;
            let length_m = self.stations[self.points.len() - 1];
            let deepest_m = self.deepest_m();
            let clear = deepest_m < CLEAR_M;
            if deepest_m < 0.7 * least_m {
                (least_m, least_round) = (deepest_m, round);
            }
            let tangled = round > least_round + patience && deepest_m > 0.5
                || self.pushes.len() > MOST_CONTACTS;
            let work = self.work;
            let pulled = |clear| Pulled { clear, work };
            let flown_s = self.points[self.points.len() - 1].time_s - departure_s;
            let settled = clear && (length_m - before_m).abs() < tolerance_m;
            before_m = length_m;
            if clear && flown_s < clear_s {
                clear_s = flown_s;
                self.clear_points.clone_from(&self.points);
            }
            if settled && (refinements == 3 || !self.split_where_wrapped(WRAP * line_m)) {
                return pulled(true);
            }
            let hopeless = round > 4 && flown_s > pull.limit_s;
            let spent = round >= pull.rounds || work >= pull.work;
            if spent || hopeless || tangled || pull.deadline.passed() {
                if !clear && clear_s.is_finite() {
                    self.points.clone_from(&self.clear_points);
                    self.time();
                    self.touch();
                }
                return pulled(clear_s.is_finite());
            }
            if settled {
                refinements += 1;
                continue;
            }
            if !self.release(trust_m) {
                return Pulled {
                    clear: false,
                    work: self.work,
                };
            }
            trust_m = (trust_m * 0.8).max(pull.trust_m.min(20.0));
            self.drop_straight_vertices();
        }
    }

    /// The string, timed.
    pub(crate) fn points(&self) -> &[TimedPoint] {
        &self.points
    }

    /// Regions it touches, with the arrival time, in order along the string.
    pub(crate) fn touched(&self) -> impl Iterator<Item = (usize, f64, Vector3<f64>)> + '_ {
        self.pushes
            .iter()
            .filter(|push| push.region != NO_REGION && push.contact.gap_m < 0.05)
            .map(|push| {
                let (a, b) = (&self.points[push.segment], &self.points[push.segment + 1]);
                let time_s = a.time_s + (b.time_s - a.time_s) * push.contact.share;
                (push.region, time_s, push.contact.normal)
            })
    }

    fn deepest_m(&self) -> f64 {
        let gaps = self.pushes.iter().map(|push| -push.contact.gap_m);
        gaps.fold(0.0, f64::max)
    }

    /// Merges coinciding vertices, then stations (arc length) and arrival times.
    fn time(&mut self) {
        let last = self.points.len() - 1;
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
            let length_m = step.norm().max(1e-9);
            self.stations.push(self.stations[i - 1] + length_m);
            self.points[i].time_s = before.time_s + self.duration_s(&before, &step, length_m);
        }
    }

    /// Flight time of a segment, in pieces of 50 m where the water moves.
    fn duration_s(&self, from: &TimedPoint, step: &Vector3<f64>, length_m: f64) -> f64 {
        let problem = self.problem;
        let speed_mps = problem.vehicle.speed_mps;
        if problem.current.is_none() {
            return length_m / speed_mps;
        }
        let direction = step / length_m;
        let pieces = (length_m / 50.0).ceil().max(1.0);
        let piece_m = length_m / pieces;
        let mut elapsed_s = 0.0;
        for k in 0..pieces as usize {
            let middle = from.position + direction * (piece_m * (k as f64 + 0.5));
            let now_s = from.time_s + elapsed_s + 0.5 * piece_m / speed_mps;
            let ground = problem.ground_speed_mps(&direction, &middle, now_s);
            // No way made: slow enough that any other way is better.
            elapsed_s += piece_m / ground.unwrap_or(0.01 * speed_mps);
        }
        elapsed_s
    }

    /// Finds all contacts of all segments, in order.
    fn touch(&mut self) {
        self.pushes.clear();
        let pieces = |length_m: f64| (length_m / 50.0) as u64 + 1;
        let last_segment = self.points.len() - 2;
        for segment in 0..self.points.len() - 1 {
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
                if gap_m < crate::field::BAND_M {
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
        if left_m - MARGIN_M < crate::field::BAND_M {
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

    /// Adds a vertex where a segment is inside a region, away from its ends.
    fn split_where_inside(&mut self) -> bool {
        self.split(|_, push| push.contact.gap_m < -0.3)
    }

    /// Adds vertices at the contacts of a bend that is longer than the arc it stands for.
    fn split_where_wrapped(&mut self, tolerance_m: f64) -> bool {
        self.split(|string, push| {
            let at = push.segment;
            let length_m = string.stations[at + 1] - string.stations[at];
            let excess_m = |vertex: usize, tangent_m: f64| {
                let bend = string.bend(vertex);
                tangent_m * bend * bend / 6.0
            };
            let share = push.contact.share;
            push.force > 0.0
                && (excess_m(at, share * length_m) > tolerance_m
                    || excess_m(at + 1, (1.0 - share) * length_m) > tolerance_m)
        })
    }

    /// Adds a vertex at every chosen contact far enough from its segment's ends.
    fn split(&mut self, chosen: impl Fn(&Self, &Push) -> bool) -> bool {
        let spacing_m = 2.0 * SHORTEST_M;
        let mut added: Vec<(usize, Point3<f64>)> = Vec::new();
        let (mut segment, mut last_m) = (usize::MAX, 0.0);
        for push in &self.pushes {
            if push.segment != segment {
                (segment, last_m) = (push.segment, 0.0);
            }
            let length_m = self.stations[segment + 1] - self.stations[segment];
            let at_m = push.contact.share * length_m;
            if at_m > last_m + spacing_m && at_m < length_m - spacing_m && chosen(self, push) {
                let (a, b) = (
                    self.points[segment].position,
                    self.points[segment + 1].position,
                );
                added.push((segment, a + (b - a) * push.contact.share));
                last_m = at_m;
            }
        }
        for &(segment, position) in added.iter().rev() {
            self.points
                .insert(segment + 1, TimedPoint::new(position, 0.0));
        }
        !added.is_empty()
    }

    /// Angle of the string at a vertex, radians (0 at the ends).
    fn bend(&self, vertex: usize) -> f64 {
        if vertex == 0 || vertex + 1 >= self.points.len() {
            return 0.0;
        }
        let at = |i: usize| self.points[i].position;
        let (before, after) = (at(vertex) - at(vertex - 1), at(vertex + 1) - at(vertex));
        before.cross(&after).norm() / (before.norm() * after.norm()).max(1e-12)
    }

    /// One round: all contact forces, and the string where they put it, no vertex moving farther than
    /// `trust_m`. Returns false when the contacts leave no way between them.
    fn release(&mut self, trust_m: f64) -> bool {
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

    /// Drops vertices at which the string is straight.
    fn drop_straight_vertices(&mut self) {
        let last = self.points.len() - 1;
        let mut kept = 1;
        for i in 1..last {
            let (a, b) = (self.points[kept - 1].position, self.points[i + 1].position);
            let p = self.points[i].position;
            let chord = b - a;
            let off_m = (p - a).cross(&chord).norm() / chord.norm().max(1e-9);
            if off_m > 1e-4 || (p - a).dot(&chord) < 0.0 {
                self.points[kept] = self.points[i];
                kept += 1;
            }
        }
        self.points[kept] = self.points[last];
        self.points.truncate(kept + 1);
    }
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
