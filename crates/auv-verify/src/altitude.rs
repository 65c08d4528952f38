//! Altitude above the sea bed, proven between samples.

use auv_obstacles::TimedPoint;
use auv_planning::{PathProblem, Trajectory};
use auv_types::{Point3, libm};

/// How much lower than required a place may be, metres: the chord error of a trajectory.
const TOLERANCE_M: f64 = Trajectory::CHORD_ERROR_M;

/// A place that is too low, or not proven high enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Low {
    pub(crate) place: Point3<f64>,
    pub(crate) time_s: f64,
    pub(crate) altitude_m: f64,
    pub(crate) required_m: f64,
}

/// What the segments looked at showed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Altitude {
    /// Least altitude of all places looked at.
    pub(crate) least_m: f64,
    /// The place that falls short most.
    pub(crate) low: Option<Low>,
}

impl Altitude {
    pub(crate) fn unknown() -> Self {
        Self {
            least_m: f64::INFINITY,
            low: None,
        }
    }

    /// Looks at one segment: a piece is cleared when the bed, at its steepest, cannot rise to it;
    /// else it is halved, until what is left of doubt is below the tolerance.
    pub(crate) fn look_at(
        &mut self,
        problem: &PathProblem<'_>,
        from: &TimedPoint,
        to: &TimedPoint,
    ) {
        let Some(bed) = problem.sea_bed else {
            return;
        };
        let middle = TimedPoint::new(
            from.position + (to.position - from.position) * 0.5,
            0.5 * (from.time_s + to.time_s),
        );
        let (x, y) = (middle.position.x, middle.position.y);
        let across = to.position - from.position;
        let reach_m = 0.5 * libm::hypot(across.x, across.y);
        let sigma_m = bed.depth_sigma_m(x, y);
        let required_m = problem.min_altitude_m + problem.altitude_sigmas * sigma_m;
        let depth_m = bed.depth_at(x, y);
        let altitude_m = depth_m - middle.position.z;
        self.least_m = self.least_m.min(altitude_m);
        let doubt_m = 0.5 * across.z.abs()
            + if reach_m > 0.0 {
                bed.max_slope_near(x, y, reach_m) * reach_m
            } else {
                0.0
            };
        if altitude_m - doubt_m >= required_m - TOLERANCE_M {
            return;
        }
        let is_low = !(altitude_m >= required_m - TOLERANCE_M);
        // A bed without a bound of its slope proves nothing.
        let is_last = across.norm() < 1e-3 || !doubt_m.is_finite();
        if is_low || (is_last && !(doubt_m <= TOLERANCE_M)) {
            let short_m = |low: &Low| low.required_m - low.altitude_m;
            let low = Low {
                place: middle.position,
                time_s: middle.time_s,
                altitude_m,
                required_m,
            };
            if self
                .low
                .is_none_or(|worst| !(short_m(&low) <= short_m(&worst)))
            {
                self.low = Some(low);
            }
        }
        // Where it is too low already, the worst place is sought no closer than a metre.
        if doubt_m > TOLERANCE_M && !is_last && !(is_low && across.norm() < 1.0) {
            self.look_at(problem, from, &middle);
            self.look_at(problem, &middle, to);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_ocean::SeaBed;
    use auv_planning::Vehicle;

    /// A pinnacle 2 m wide that no coarse sampling meets.
    #[derive(Debug)]
    struct Pinnacle;

    impl SeaBed for Pinnacle {
        fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
            let aside_m = libm::hypot(north_m - 333.3, east_m);
            100.0 - (90.0 - 90.0 * aside_m).max(0.0)
        }

        fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
            let aside_m = libm::hypot(north_m - 333.3, east_m);
            if aside_m - radius_m > 1.0 { 0.0 } else { 90.0 }
        }
    }

    fn look(depth_m: f64, east_m: f64) -> Altitude {
        let vehicle = Vehicle::paper();
        let start = Point3::new(0.0, east_m, depth_m);
        let target = Point3::new(1000.0, east_m, depth_m);
        let problem = PathProblem {
            sea_bed: Some(&Pinnacle),
            min_altitude_m: 5.0,
            ..PathProblem::new(start, target, &vehicle)
        };
        let mut altitude = Altitude::unknown();
        let to = TimedPoint::new(target, 300.0);
        altitude.look_at(&problem, &TimedPoint::new(start, 0.0), &to);
        altitude
    }

    #[test]
    fn finds_a_pinnacle_between_samples() {
        let low = look(40.0, 0.0).low.unwrap();
        assert!(
            (low.place.x - 333.3).abs() < 1.5 && low.altitude_m < 5.0,
            "{low:?}"
        );
        assert!(look(40.0, 1.5).low.is_none() && look(4.0, 0.0).low.is_none());
        assert!(look(96.0, 30.0).low.is_some());
    }
}
