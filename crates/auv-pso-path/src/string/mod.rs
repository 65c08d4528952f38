//! A string under tension among the regions: the shortest polyline of its kind.
//!
//! Without contacts a taut string is straight; every contact pushes it along the contact's normal.
//! For small steps the positions are linear in the contact forces (the string's Green function), so
//! one round finds all forces together as a linear complementarity problem. Rounds repeat until
//! contacts, times and lengths agree; then vertices are added where the string wraps a region.

mod contacts;
mod strand;
mod tension;

pub(crate) use strand::Strand;

use crate::complementarity::Forces;
use crate::field::{Contact, Field};
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
        if pull.deadline.passed() {
            // As it is, and nothing more is asked about it.
            self.time();
            self.pushes.clear();
            return Pulled {
                clear: false,
                work: 0,
            };
        }
        loop {
            self.time();
            self.touch(pull.deadline);
            if self.pushes.len() <= MOST_CONTACTS && self.split_where_inside() {
                self.time();
                self.touch(pull.deadline);
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
                    self.touch(pull.deadline);
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

#[cfg(test)]
mod tests {
    use super::*;
    use auv_obstacles::Region;
    use auv_planning::{Budget, Run, Vehicle};
    use auv_types::{Bounds, Seed, libm};

    /// Pulls the straight line of a problem taut and returns the string's points.
    fn taut(problem: &PathProblem<'_>, seed: &[Point3<f64>]) -> Vec<TimedPoint> {
        let field = Field::new(problem, 0.0, false);
        let run = Run::new(Seed(0), Budget::to_the_cap());
        let pull = Pull {
            rounds: 40,
            trust_m: f64::INFINITY,
            tolerance: 1e-6,
            limit_s: f64::INFINITY,
            work: u64::MAX,
            deadline: run.deadline(),
        };
        let mut maker = StringMaker::new(problem, &field);
        assert!(maker.pull(seed, problem.departure_s, &pull).clear);
        maker.points().to_vec()
    }

    fn length_m(points: &[TimedPoint]) -> f64 {
        let pairs = points.windows(2);
        pairs
            .map(|pair| (pair[1].position - pair[0].position).norm())
            .sum()
    }

    /// Length of the taut string round discs, each kept on the left (positive radius) or on the
    /// right (negative): tangents and arcs. The ends are discs without radius.
    fn tangents_and_arcs_m(discs: &[(f64, f64, f64)]) -> f64 {
        let mut total_m = 0.0;
        let mut before_rad = None;
        for pair in discs.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let (dx, dy, lift) = (b.0 - a.0, b.1 - a.1, b.2 - a.2);
            let apart_m = libm::hypot(dx, dy);
            let course_rad = libm::atan2(dy, dx) - libm::asin(lift / apart_m);
            total_m += libm::sqrt(apart_m * apart_m - lift * lift);
            if let Some(before_rad) = before_rad {
                let turn_rad: f64 = course_rad - before_rad;
                total_m += (turn_rad * a.2).abs();
            }
            before_rad = Some(course_rad);
        }
        total_m
    }

    /// The polygon round an arc is longer than the arc, by little after three refinements.
    fn assert_close(found_m: f64, exact_m: f64) {
        let excess_m = found_m - exact_m;
        assert!(
            (-1e-6..2e-4 * exact_m).contains(&excess_m),
            "{found_m} m, exact {exact_m} m"
        );
    }

    const MARGIN_M: f64 = 2e-3;

    fn leg<'a>(vehicle: &'a Vehicle, regions: &'a [Region]) -> PathProblem<'a> {
        PathProblem {
            regions,
            clearance_m: 5.0,
            ..PathProblem::new(
                Point3::new(0.0, 0.0, 50.0),
                Point3::new(1_000.0, 0.0, 50.0),
                vehicle,
            )
        }
    }

    #[test]
    fn round_one_ball_it_is_two_tangents_and_an_arc() {
        let vehicle = Vehicle::paper();
        for (x, y, radius_m) in [
            (500.0, 20.0, 100.0),
            (200.0, -60.0, 80.0),
            (850.0, 5.0, 40.0),
        ] {
            let regions = [Region::ball(Point3::new(x, y, 50.0), radius_m)];
            let problem = leg(&vehicle, &regions);
            let points = taut(&problem, &[problem.start, problem.target]);
            let grown_m = libm::copysign(radius_m + 5.0 + MARGIN_M, y);
            let exact_m =
                tangents_and_arcs_m(&[(0.0, 0.0, 0.0), (x, y, grown_m), (1_000.0, 0.0, 0.0)]);
            assert_close(length_m(&points), exact_m);
            let flown_s = points[points.len() - 1].time_s - points[0].time_s;
            assert!((flown_s - length_m(&points) / vehicle.speed_mps).abs() < 1e-9);
        }
    }

    #[test]
    fn between_two_balls_it_is_their_inner_or_outer_tangent() {
        let vehicle = Vehicle::paper();
        for second_y in [-40.0, 40.0] {
            let regions = [
                Region::ball(Point3::new(300.0, 30.0, 50.0), 90.0),
                Region::ball(Point3::new(700.0, second_y, 50.0), 110.0),
            ];
            let problem = leg(&vehicle, &regions);
            let points = taut(&problem, &[problem.start, problem.target]);
            let discs = [
                (0.0, 0.0, 0.0),
                (300.0, 30.0, 95.0 + MARGIN_M),
                (700.0, second_y, libm::copysign(115.0 + MARGIN_M, second_y)),
                (1_000.0, 0.0, 0.0),
            ];
            assert_close(length_m(&points), tangents_and_arcs_m(&discs));
        }
    }

    #[test]
    fn round_a_cylinder_it_descends_evenly() {
        let vehicle = Vehicle::paper();
        let regions = [Region::cylinder(
            Point3::new(400.0, 30.0, 0.0),
            100.0,
            f64::NEG_INFINITY,
            f64::INFINITY,
        )];
        let problem = PathProblem {
            target: Point3::new(1_000.0, 0.0, 250.0),
            ..leg(&vehicle, &regions)
        };
        let points = taut(&problem, &[problem.start, problem.target]);
        let discs = [
            (0.0, 0.0, 0.0),
            (400.0, 30.0, 105.0 + MARGIN_M),
            (1_000.0, 0.0, 0.0),
        ];
        let exact_m = libm::hypot(tangents_and_arcs_m(&discs), 200.0);
        assert_close(length_m(&points), exact_m);
        for pair in points.windows(2) {
            let step = pair[1].position - pair[0].position;
            assert!((step.z / step.norm() - 200.0 / exact_m).abs() < 1e-3);
        }
    }

    #[test]
    fn a_moving_ball_is_met_where_it_is_at_the_time_of_arrival() {
        let vehicle = Vehicle::paper();
        // It crosses the line at 500 m half a minute before the vehicle gets there.
        let mut crossing = Region::ball(Point3::new(500.0, -200.0, 50.0), 60.0);
        crossing.velocity_mps = Vector3::new(0.0, 1.5, 0.0);
        let regions = [crossing];
        let problem = leg(&vehicle, &regions);
        let points = taut(&problem, &[problem.start, problem.target]);
        let closest_m = points
            .windows(2)
            .map(|pair| crossing.clearance(&pair[0], &pair[1]).clearance_m)
            .fold(f64::INFINITY, f64::min);
        assert!((closest_m - 5.0).abs() < 0.01, "touches it: {closest_m}");
        let passed = points.iter().map(|p| p.position.y).fold(0.0, f64::min);
        assert!(passed < -1.0, "behind it: {passed}");
    }

    #[test]
    fn it_rounds_a_ball_within_the_box_where_the_shorter_way_leaves_it() {
        let vehicle = Vehicle::paper();
        // Over the ball is shortest, but the box ends at the depth of start and target.
        let regions = [Region::ball(Point3::new(500.0, 3.0, 70.0), 80.0)];
        let problem = PathProblem {
            bounds: Some(Bounds::new(
                Point3::new(0.0, -300.0, 50.0),
                Point3::new(1_000.0, 300.0, 300.0),
            )),
            ..leg(&vehicle, &regions)
        };
        let points = taut(&problem, &[problem.start, problem.target]);
        let grown_m = 85.0 + MARGIN_M;
        let exact_m = tangents_and_arcs_m(&[
            (0.0, 0.0, 0.0),
            (500.0, 3.0, libm::sqrt(grown_m * grown_m - 400.0)),
            (1_000.0, 0.0, 0.0),
        ]);
        assert!(points.iter().all(|p| p.position.z >= 50.0 - CLEAR_M));
        assert_close(length_m(&points), exact_m);
    }
}
