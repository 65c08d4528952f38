//! One detour: a stretch of the best string, replaced by another and tightened.

use crate::taut::candidate::Candidate;
use crate::taut::contact::sideways;
use crate::taut::search_context::SearchContext;
use crate::taut::string::{StringSolver, TautString, Tightening};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Point3, Vector3, libm};

/// Most rounds and evaluations of a detour.
const ROUNDS: u64 = 14;
const MOST_EVALUATIONS: u64 = 20;
/// Gain of a round below which a detour is taut, as a share of its line.
const TOLERANCE: f64 = 5e-6;
/// A detour that takes longer than what it replaces by this factor is given up.
const LIMIT: f64 = 1.002;
/// Least gain that counts, as a share of the flight.
const LEAST_GAIN: f64 = 1e-6;
/// Shortest stretch that is replaced, metres.
const SHORTEST_M: f64 = 1.0;
/// Half the length of a stretch that is straightened, as a share of the flight.
const STRAIGHTENED: std::ops::Range<f64> = 0.03..0.25;
/// Half the length of a stretch past a region: between so many radii of the region, plus metres.
const PAST_RADII: std::ops::Range<f64> = 1.5..5.0;
const PAST_M: f64 = 50.0;
/// One detour in four may pass a whole cluster of regions: its stretch is three times as long.
const WIDE_ONE_IN: i32 = 4;
const WIDE_FACTOR: f64 = 3.0;
/// Farthest point beside a region that a detour is bent through, in radii from its centre, plus
/// metres. The nearest is one radius away.
const FARTHEST_RADII: f64 = 1.6;
const FARTHEST_RADII_WIDE: f64 = 3.0;
const BESIDE_M: f64 = 1.0;

/// A stretch of the best string, and what replaces it.
#[derive(Debug, Default)]
pub(crate) struct Detour {
    /// Start and end of the stretch, seconds.
    pub(crate) from_s: f64,
    pub(crate) until_s: f64,
    /// Vertices of the replacement.
    pub(crate) points: Vec<Point3<f64>>,
    /// Seconds gained; 0 if it gains nothing or is not clear.
    pub(crate) gain_s: f64,
    /// Units of work it took.
    pub(crate) work: u64,
}

impl Detour {
    /// Draws a stretch and a point to bend it through, and tightens it.
    pub(crate) fn try_out(
        &mut self,
        best: &Candidate,
        solver: &mut StringSolver<'_>,
        context: &SearchContext<'_>,
        random: &mut ChaCha8Rng,
    ) {
        self.reset();
        if context.deadline.passed() {
            return;
        }
        let through = self.draw(best, context, random);
        let (a, b) = (best.string.at(self.from_s), best.string.at(self.until_s));
        if (b - a).norm() < SHORTEST_M {
            return;
        }
        let mut polyline = vec![a, b];
        if let Some(point) = through {
            polyline.insert(1, point);
        }
        let old_s = self.until_s - self.from_s;
        let limits = Tightening {
            rounds: ROUNDS,
            trust_m: f64::INFINITY,
            tolerance: TOLERANCE,
            limit_s: if best.is_clear() {
                old_s * LIMIT
            } else {
                f64::INFINITY
            },
            work: context.rate.units(MOST_EVALUATIONS),
            deadline: context.deadline,
        };
        let tightened = solver.tighten(&polyline, self.from_s, &limits);
        self.work = tightened.work;
        let points = solver.points();
        let gain_s = old_s - (points[points.len() - 1].time_s - self.from_s);
        // If the best is not clear, any clear stretch may mend it, however long it takes.
        let gain_s = if best.is_clear() {
            gain_s
        } else {
            gain_s + old_s
        };
        if tightened.clear && gain_s > LEAST_GAIN * best.duration_s() {
            self.gain_s = gain_s;
            self.points.clear();
            self.points.extend(points.iter().map(|p| p.position));
        }
    }

    /// Forgets gain and work.
    pub(crate) fn reset(&mut self) {
        (self.gain_s, self.work) = (0.0, 0);
    }

    /// Whether two stretches have no time in common.
    pub(crate) fn is_disjoint_from(&self, other: &Self) -> bool {
        self.until_s <= other.from_s || other.until_s <= self.from_s
    }

    /// Draws a stretch to straighten, or a touched region and a point beside it to pass through.
    fn draw(
        &mut self,
        best: &Candidate,
        context: &SearchContext<'_>,
        random: &mut ChaCha8Rng,
    ) -> Option<Point3<f64>> {
        let string = &best.string;
        let pick = random.random_range(0..=string.contacts.len());
        let Some(&(region, time_s)) = string.contacts.get(pick) else {
            self.draw_stretch(string, random);
            return None;
        };
        let (centre, radius_m) = context.regions.at(region, time_s);
        let (wide, farthest) = if random.random_range(0..WIDE_ONE_IN) == 0 {
            (WIDE_FACTOR, FARTHEST_RADII_WIDE)
        } else {
            (1.0, FARTHEST_RADII)
        };
        let half_m = wide * (radius_m * random.random_range(PAST_RADII) + PAST_M);
        self.take_stretch(string, time_s, half_m / context.problem.vehicle.speed_mps);
        let ahead = string.at(self.until_s) - string.at(self.from_s);
        if ahead.norm() < SHORTEST_M {
            return None;
        }
        let out = direction_across(&ahead, random.random_range(0.0..std::f64::consts::TAU));
        let beside_m = radius_m * random.random_range(1.0..farthest) + BESIDE_M;
        Some(centre + out * beside_m)
    }

    fn draw_stretch(&mut self, string: &TautString, random: &mut ChaCha8Rng) {
        let (start_s, end_s) = string.times();
        let share = random.random_range(0.0..1.0);
        let span_s = end_s - start_s;
        let half_s = span_s * random.random_range(STRAIGHTENED);
        self.take_stretch(string, start_s + span_s * share, half_s);
    }

    /// Takes the stretch round a time, within the string.
    fn take_stretch(&mut self, string: &TautString, middle_s: f64, half_s: f64) {
        let (start_s, end_s) = string.times();
        self.from_s = (middle_s - half_s).max(start_s);
        self.until_s = (middle_s + half_s).min(end_s);
    }
}

/// A unit vector across a direction, at an angle from the horizontal.
fn direction_across(ahead: &Vector3<f64>, angle: f64) -> Vector3<f64> {
    let side = sideways(ahead);
    let other = ahead.normalize().cross(&side);
    side * libm::cos(angle) + other * libm::sin(angle)
}
