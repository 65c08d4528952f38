//! What the vehicle would have to do: speed through the water, turns, pitch.

use auv_obstacles::TimedPoint;
use auv_planning::PathProblem;
use auv_types::{Vector3, libm};

/// The current is sampled at least this often, metres.
const CURRENT_STEP_M: f64 = 50.0;

/// A point nearer than this to the last one does not count as a vertex, metres: the direction between
/// them is rounding.
const SAME_PLACE_M: f64 = 1e-4;

/// Rounding of a position, metres.
const ROUNDING_M: f64 = 1e-9;

/// Least and greatest speed through the water on a segment, m/s.
pub(crate) fn water_speeds(
    problem: &PathProblem<'_>,
    from: &TimedPoint,
    to: &TimedPoint,
) -> (f64, f64) {
    let way = to.position - from.position;
    let elapsed_s = to.time_s - from.time_s;
    let ground = way / elapsed_s;
    let Some(current) = problem.current else {
        let speed = ground.norm();
        return (speed, speed);
    };
    // An even number of pieces: both ends and the middle are sampled. A stay is sampled as often as
    // a travel of the same duration.
    let travelled_m = way.norm().max(elapsed_s * problem.vehicle.speed_mps);
    let pieces = 2.0 * libm::ceil(travelled_m / (2.0 * CURRENT_STEP_M)).clamp(1.0, 1e4);
    let mut range = (f64::INFINITY, 0.0_f64);
    for k in 0..=pieces as usize {
        let share = k as f64 / pieces;
        let place = from.position + way * share;
        let water = current.velocity_at(&place, from.time_s + elapsed_s * share);
        let speed = (ground - water).norm();
        range = (range.0.min(speed), range.1.max(speed));
    }
    range
}

/// The error of a speed over a time that rounding of positions can cause, m/s.
pub(crate) fn speed_rounding_mps(elapsed_s: f64) -> f64 {
    ROUNDING_M / elapsed_s
}

/// The path's angle to the horizontal in radians, up or down.
pub(crate) fn pitch_rad(from: &TimedPoint, to: &TimedPoint) -> f64 {
    let way = to.position - from.position;
    let rise_m = (way.z.abs() - ROUNDING_M).max(0.0);
    libm::atan2(rise_m, libm::hypot(way.x, way.y))
}

/// Follows a trajectory from point to point and gives the turn radius at each vertex: the shorter of
/// the two segments over twice the tangent of half the angle between them.
pub(crate) struct Turns {
    /// Direction and length of the last segment that moved.
    before: Option<(Vector3<f64>, f64)>,
    /// Where it ended.
    at: TimedPoint,
}

impl Turns {
    /// Starts at the first point. `velocity`, if known, is the velocity of arrival there; the
    /// segment before is taken to be arbitrarily long. So is the first segment of a trajectory that
    /// is cut off at its start (`is_cut` of [`Turns::go_to`]).
    pub(crate) fn new(at: TimedPoint, velocity: Option<Vector3<f64>>) -> Self {
        let moving = velocity.filter(|v| v.norm() > 1e-6);
        Self {
            before: moving.map(|v| (v.normalize(), f64::INFINITY)),
            at,
        }
    }

    /// The turn radius at the last vertex in metres when the vehicle goes on to `next`; `None` where
    /// there is no turn.
    pub(crate) fn go_to(&mut self, next: &TimedPoint, is_cut: bool) -> Option<f64> {
        let way = next.position - self.at.position;
        let length_m = way.norm();
        if length_m < SAME_PLACE_M {
            return None;
        }
        let direction = way / length_m;
        let radius_m = self
            .before
            .map(|(before, before_m)| turn_radius_m(&before, &direction, before_m.min(length_m)));
        let is_first_of_cut = is_cut && self.before.is_none();
        let before_m = match (self.before, radius_m) {
            _ if is_first_of_cut => f64::INFINITY,
            // Straight on from the velocity of arrival: the segment before continues.
            (Some((_, before_m)), Some(radius_m)) if before_m.is_infinite() && radius_m > 1e7 => {
                f64::INFINITY
            }
            _ => length_m,
        };
        self.before = Some((direction, before_m));
        self.at = *next;
        radius_m
    }
}

/// Turn radius between two directions with the shorter adjacent segment `shorter_m`, metres. The
/// rounding of positions counts in the vehicle's favour.
fn turn_radius_m(before: &Vector3<f64>, after: &Vector3<f64>, shorter_m: f64) -> f64 {
    // |b + a| and |b - a| are twice cosine and sine of half the angle.
    let half_tangent = (after - before).norm() / (after + before).norm();
    let half_tangent = half_tangent - ROUNDING_M / shorter_m;
    if half_tangent > 0.0 {
        0.5 * shorter_m / half_tangent
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_planning::polyline;
    use auv_types::rand::RngExt;
    use auv_types::{Point3, Seed};

    #[test]
    fn turn_radius_is_that_of_the_documented_formula() {
        for case in 0..500 {
            let mut random = Seed(3).stream(case);
            let mut draw = || random.random_range(-50.0..50.0);
            let [a, b, c] = [(); 3].map(|()| Point3::new(draw(), draw(), draw()));
            let documented_m = polyline::turn_radius_m(&a, &b, &c);
            let mut turns = Turns::new(TimedPoint::new(a, 0.0), None);
            assert!(turns.go_to(&TimedPoint::new(b, 1.0), false).is_none());
            let radius_m = turns.go_to(&TimedPoint::new(c, 2.0), false).unwrap();
            assert!(
                (radius_m / documented_m - 1.0).abs() < 1e-4,
                "{radius_m} {documented_m}"
            );
        }
    }

    #[test]
    fn a_cut_first_segment_continues_backwards() {
        let at = |x: f64, y: f64| TimedPoint::new(Point3::new(x, y, 0.0), 0.0);
        for (is_cut, tight) in [(true, false), (false, true)] {
            let mut turns = Turns::new(at(-0.01, 0.0), None);
            turns.go_to(&at(0.0, 0.0), is_cut);
            let radius_m = turns.go_to(&at(10.0, 2.0), is_cut).unwrap();
            assert_eq!(radius_m < 1.0, tight, "{radius_m}");
        }
        let mut turns = Turns::new(at(-0.01, 0.0), Some(Vector3::new(1.0, 0.0, 0.0)));
        turns.go_to(&at(0.0, 0.0), false);
        assert!(turns.go_to(&at(10.0, 2.0), false).unwrap() > 20.0);
    }

    #[test]
    fn turning_back_has_no_radius() {
        let at = |x: f64| TimedPoint::new(Point3::new(x, 0.0, 0.0), 0.0);
        let mut turns = Turns::new(at(0.0), None);
        turns.go_to(&at(5.0), false);
        assert_eq!(turns.go_to(&at(0.0), false), Some(0.0));
    }

    #[test]
    fn a_short_segment_after_a_turn_or_on_a_straight_way_makes_the_next_turn_tight() {
        let at = |x: f64, y: f64| TimedPoint::new(Point3::new(x, y, 0.0), 0.0);
        // It turns a little at the start and more after a centimetre.
        let mut turns = Turns::new(at(-0.01, 0.0), Some(Vector3::new(1.0, 0.1, 0.0)));
        assert!(turns.go_to(&at(0.0, 0.0), false).unwrap() < 1.0);
        assert!(turns.go_to(&at(10.0, 2.0), false).unwrap() < 1.0);
        // The second centimetre of a straight way is as short as the first.
        let mut turns = Turns::new(at(-0.02, 0.0), None);
        turns.go_to(&at(-0.01, 0.0), false);
        assert_eq!(turns.go_to(&at(0.0, 0.0), false), Some(f64::INFINITY));
        assert!(turns.go_to(&at(10.0, 2.0), false).unwrap() < 1.0);
    }

    #[test]
    fn steps_below_a_tenth_of_a_millimetre_are_no_vertices() {
        let at = |x: f64, y: f64| TimedPoint::new(Point3::new(x, y, 0.0), 0.0);
        for (aside_m, is_vertex) in [(0.9e-4, false), (1.1e-4, true)] {
            let mut turns = Turns::new(at(0.0, 0.0), None);
            turns.go_to(&at(10.0, 0.0), false);
            let aside = turns.go_to(&at(10.0, aside_m), false);
            assert_eq!(aside.is_some(), is_vertex);
            let on = turns.go_to(&at(20.0, 0.0), false).unwrap();
            assert_eq!(on < 1.0, is_vertex, "{on}");
        }
        // Nor is a velocity below a micrometre a second a direction.
        for (speed_mps, counts) in [(0.9e-6, false), (1.1e-6, true)] {
            let mut turns = Turns::new(at(0.0, 0.0), Some(Vector3::new(0.0, speed_mps, 0.0)));
            assert_eq!(turns.go_to(&at(10.0, 0.0), false).is_some(), counts);
        }
    }

    #[test]
    fn rounding_of_positions_is_no_turn_and_no_climb() {
        let at = |x: f64, y: f64, z: f64| TimedPoint::new(Point3::new(x, y, z), 0.0);
        let radius_m = |aside_m: f64| {
            let mut turns = Turns::new(at(0.0, 0.0, 0.0), None);
            turns.go_to(&at(1e-3, 0.0, 0.0), false);
            turns.go_to(&at(2e-3, aside_m, 0.0), false).unwrap()
        };
        // An angle of twice what rounding makes of a millimetre.
        assert_eq!(radius_m(1.9e-9), f64::INFINITY);
        assert!(radius_m(2.1e-9).is_finite());
        let pitch_rad = |x: f64, z: f64| pitch_rad(&at(5.0, 0.0, 7.0), &at(5.0 + x, 0.0, 7.0 + z));
        assert_eq!(pitch_rad(0.0, 0.5e-9), 0.0);
        assert_eq!(pitch_rad(0.0, 0.0), 0.0);
        let up_rad = [pitch_rad(3.0, 3.0), pitch_rad(-3.0, -3.0)];
        assert!(
            up_rad
                .iter()
                .all(|rad| (rad - std::f64::consts::FRAC_PI_4).abs() < 1e-8)
        );
    }

    #[test]
    fn a_step_of_exactly_a_tenth_of_a_millimetre_is_a_vertex() {
        let at = |x: f64, y: f64| TimedPoint::new(Point3::new(x, y, 0.0), 0.0);
        let mut turns = Turns::new(at(0.0, 0.0), None);
        turns.go_to(&at(SAME_PLACE_M, 0.0), false);
        assert!(turns.go_to(&at(SAME_PLACE_M, 5.0), false).unwrap() < 1e-3);
    }
}
