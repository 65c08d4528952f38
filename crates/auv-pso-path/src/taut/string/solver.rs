//! Tightens strings, round after round.

use crate::taut::regions::GrownRegions;
use crate::taut::string::contacts::ContactFinder;
use crate::taut::string::segment_contact::{SegmentContact, deepest_m};
use crate::taut::string::shape::StringShape;
use crate::taut::string::taut_string::TautString;
use crate::taut::string::tension::{CLEAR_M, Tension};
use auv_obstacles::TimedPoint;
use auv_planning::{Deadline, PathProblem};
use auv_types::Point3;

/// A string with more contacts than this is tangled: one round takes the cube of their number.
const MOST_CONTACTS: usize = 100;
/// A contact this deep inside a region splits its segment, metres.
const INSIDE_M: f64 = 0.3;
/// A bend gets more vertices while it exceeds the arc that it stands for by this share of the straight
/// line.
const WRAP: f64 = 5e-6;
/// Most refinements of bends.
const MOST_REFINEMENTS: u64 = 3;
/// The deepest penetration must fall to this share within the patience: then the string is coming
/// free.
const PROGRESS: f64 = 0.7;
/// Patience in rounds, for a string with a time limit (one of many tries) and without.
const PATIENCE_LIMITED: u64 = 6;
const PATIENCE: u64 = 14;
/// A string that is not coming free and is deeper inside than this is tangled, metres.
const TANGLED_M: f64 = 0.5;
/// Rounds in which a string may exceed its time limit: they straighten it.
const ROUNDS_WITHOUT_LIMIT: u64 = 4;
/// The farthest move of a vertex in a round: at first at most this share of the straight line; then it
/// decays by a factor each round to this many metres, less than the band in which regions are seen.
const MOST_TRUST: f64 = 0.5;
const TRUST_DECAY: f64 = 0.8;
const LEAST_TRUST_M: f64 = 20.0;
/// Tolerances are shares of a straight line of at least this length, metres.
const LEAST_LINE_M: f64 = 1.0;
/// A finished string touches a region that is closer than this, metres.
const TOUCHING_M: f64 = 0.05;

/// How long and how exactly a string is tightened.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tightening<'a> {
    /// Most rounds.
    pub(crate) rounds: u64,
    /// Farthest move of a vertex in the first round, metres. Below the band in which regions are
    /// seen, a string stays on its side of them.
    pub(crate) trust_m: f64,
    /// Gain of a round, as a share of the straight line, below which the string is taut.
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
pub(crate) struct Tightened {
    /// Whether it ended clear of everything.
    pub(crate) clear: bool,
    /// Units of work that took.
    pub(crate) work: u64,
}

/// What one thread needs to tighten strings.
///
/// Without contacts a taut string is straight; every contact pushes it along the contact's normal.
/// For small moves the positions are linear in the contact forces (the string's Green function), so
/// one round finds all forces together as a linear complementarity problem. Rounds repeat until
/// contacts, times and lengths agree; then vertices are added where the string wraps a region.
#[derive(Debug)]
pub(crate) struct StringSolver<'a> {
    finder: ContactFinder<'a>,
    shape: StringShape,
    contacts: Vec<SegmentContact>,
    tension: Tension,
    /// The quickest clear state of the string.
    clear_points: Vec<TimedPoint>,
    /// Units of the string being tightened.
    work: u64,
}

/// What the rounds so far have shown.
#[derive(Clone, Copy, Debug)]
struct RoundRecord {
    round: u64,
    refinements: u64,
    /// Length after the round before, metres.
    length_m: f64,
    /// Duration of the quickest clear state, seconds; infinite without one.
    clear_s: f64,
    /// The last penetration that counted as progress, and its round.
    least_m: f64,
    least_round: u64,
}

impl<'a> StringSolver<'a> {
    pub(crate) fn new(problem: &'a PathProblem<'a>, regions: &'a GrownRegions) -> Self {
        Self {
            finder: ContactFinder { problem, regions },
            shape: StringShape::default(),
            contacts: Vec::new(),
            tension: Tension::default(),
            clear_points: Vec::new(),
            work: 0,
        }
    }

    /// Tightens a polyline whose ends are fixed and whose start is left at `departure_s`.
    ///
    /// Rounds end early when the string is clear and its length changes by less than the tolerance;
    /// when, after a few rounds, flying it takes longer than the limit; when its work or the deadline
    /// is used up; or when it is tangled: in contact with too many regions, or still inside one and not
    /// getting out. [`StringSolver::points`] holds the string whatever the outcome.
    pub(crate) fn tighten(
        &mut self,
        polyline: &[Point3<f64>],
        departure_s: f64,
        limits: &Tightening<'_>,
    ) -> Tightened {
        self.work = 0;
        self.shape.reset(polyline, departure_s);
        let line = self.shape.position(self.shape.last()) - self.shape.position(0);
        let line_m = line.norm().max(LEAST_LINE_M);
        let mut trust_m = limits.trust_m.min(MOST_TRUST * line_m);
        let mut record = RoundRecord {
            round: 0,
            refinements: 0,
            length_m: f64::INFINITY,
            clear_s: f64::INFINITY,
            least_m: f64::INFINITY,
            least_round: 0,
        };
        if limits.deadline.passed() {
            self.shape.time(self.finder.problem);
            self.contacts.clear();
            return self.ended(false);
        }
        loop {
            self.touch(limits.deadline);
            let deepest_m = deepest_m(&self.contacts);
            let clear = deepest_m < CLEAR_M;
            let settled = self.enter_round(&mut record, deepest_m, limits.tolerance * line_m);
            let wrapped = record.refinements < MOST_REFINEMENTS;
            if settled && !(wrapped && self.split_where_wrapped(WRAP * line_m)) {
                return self.ended(true);
            }
            if self.is_over(&record, deepest_m, limits) {
                let ended = self.ended(record.clear_s.is_finite());
                if !clear && ended.clear {
                    self.shape.points.clone_from(&self.clear_points);
                    self.time_and_find(limits.deadline);
                }
                return ended;
            }
            if settled {
                record.refinements += 1;
                continue;
            }
            let (shape, contacts) = (&mut self.shape, &mut self.contacts);
            let (tension, regions) = (&mut self.tension, self.finder.regions);
            if !tension.release(shape, contacts, regions, trust_m, &mut self.work) {
                return self.ended(false);
            }
            trust_m = (trust_m * TRUST_DECAY).max(limits.trust_m.min(LEAST_TRUST_M));
            self.shape.drop_straight_vertices();
        }
    }

    /// The string, timed.
    pub(crate) fn points(&self) -> &[TimedPoint] {
        &self.shape.points
    }

    /// The string with the regions that it touches.
    pub(crate) fn taut_string(&self) -> TautString {
        let points = &self.shape.points;
        let mut contacts: Vec<(usize, f64)> = Vec::new();
        for touch in &self.contacts {
            let Some(region) = touch.region else {
                continue;
            };
            if touch.contact.gap_m < TOUCHING_M
                && contacts.last().is_none_or(|last| last.0 != region)
            {
                let (a, b) = (&points[touch.segment], &points[touch.segment + 1]);
                let time_s = a.time_s + (b.time_s - a.time_s) * touch.contact.share;
                contacts.push((region, time_s));
            }
        }
        TautString {
            points: points.clone(),
            contacts,
        }
    }

    fn ended(&self, clear: bool) -> Tightened {
        Tightened {
            clear,
            work: self.work,
        }
    }

    /// Finds the contacts, and again after adding a vertex wherever a segment lies inside a region.
    fn touch(&mut self, deadline: Deadline<'_>) {
        self.time_and_find(deadline);
        let contacts = &self.contacts;
        let inside = |_: &StringShape, touch: &SegmentContact| touch.contact.gap_m < -INSIDE_M;
        if contacts.len() <= MOST_CONTACTS && self.shape.split(contacts, inside) {
            self.time_and_find(deadline);
        }
    }

    fn time_and_find(&mut self, deadline: Deadline<'_>) {
        self.shape.time(self.finder.problem);
        let (shape, contacts) = (&self.shape, &mut self.contacts);
        self.finder.find(shape, contacts, &mut self.work, deadline);
    }

    /// Records a round. Returns whether the string is clear and no longer gains.
    fn enter_round(&mut self, record: &mut RoundRecord, deepest_m: f64, tolerance_m: f64) -> bool {
        record.round += 1;
        let (length_m, duration_s) = (self.shape.length_m(), self.shape.duration_s());
        let clear = deepest_m < CLEAR_M;
        if deepest_m < PROGRESS * record.least_m {
            (record.least_m, record.least_round) = (deepest_m, record.round);
        }
        let settled = clear && (length_m - record.length_m).abs() < tolerance_m;
        record.length_m = length_m;
        if clear && duration_s < record.clear_s {
            record.clear_s = duration_s;
            self.clear_points.clone_from(&self.shape.points);
        }
        settled
    }

    /// Whether the string is given up or out of time.
    fn is_over(&self, record: &RoundRecord, deepest_m: f64, limits: &Tightening<'_>) -> bool {
        let patience = if limits.limit_s.is_finite() {
            PATIENCE_LIMITED
        } else {
            PATIENCE
        };
        let stuck = record.round > record.least_round + patience && deepest_m > TANGLED_M;
        let tangled = stuck || self.contacts.len() > MOST_CONTACTS;
        let late = record.round > ROUNDS_WITHOUT_LIMIT && self.shape.duration_s() > limits.limit_s;
        let spent = record.round >= limits.rounds || self.work >= limits.work;
        spent || late || tangled || limits.deadline.passed()
    }

    /// Adds vertices at the contacts of a bend that is longer than the arc it stands for.
    ///
    /// Two tangents of length t that meet at a small angle b are longer than the arc between their
    /// ends by t b^2 / 6.
    fn split_where_wrapped(&mut self, tolerance_m: f64) -> bool {
        self.shape.split(&self.contacts, |shape, touch| {
            let at = touch.segment;
            let length_m = shape.stations[at + 1] - shape.stations[at];
            let excess_m = |vertex: usize, tangent_m: f64| {
                let bend = shape.bend(vertex);
                tangent_m * bend * bend / 6.0
            };
            let share = touch.contact.share;
            touch.force > 0.0
                && (excess_m(at, share * length_m) > tolerance_m
                    || excess_m(at + 1, (1.0 - share) * length_m) > tolerance_m)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_obstacles::Region;
    use auv_planning::{Budget, Run, Vehicle};
    use auv_types::{Bounds, Seed, Vector3, libm};

    /// Tightens a polyline and returns the string's points.
    fn taut(problem: &PathProblem<'_>, polyline: &[Point3<f64>]) -> Vec<TimedPoint> {
        let regions = GrownRegions::new(problem, 0.0, false);
        let run = Run::new(Seed(0), Budget::to_the_cap());
        let limits = Tightening {
            rounds: 40,
            trust_m: f64::INFINITY,
            tolerance: 1e-6,
            limit_s: f64::INFINITY,
            work: u64::MAX,
            deadline: run.deadline(),
        };
        let mut solver = StringSolver::new(problem, &regions);
        let tightened = solver.tighten(polyline, problem.departure_s, &limits);
        assert!(tightened.clear);
        solver.points().to_vec()
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
