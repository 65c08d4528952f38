//! Altitude above the sea bed, proven between samples.

use auv_obstacles::TimedPoint;
use auv_planning::{PathProblem, Trajectory};
use auv_types::{Point3, libm};

/// How much lower than required a place may be, metres: the chord error of a trajectory.
const TOLERANCE_M: f64 = Trajectory::CHORD_ERROR_M;

/// A place that is too low, or not proven high enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LowPlace {
    pub(crate) place: Point3<f64>,
    pub(crate) time_s: f64,
    pub(crate) altitude_m: f64,
    pub(crate) required_m: f64,
}

/// What the segments checked so far show.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AltitudeCheck {
    /// Least altitude of all places sampled, metres.
    pub(crate) least_m: f64,
    /// The place that falls short most.
    pub(crate) lowest: Option<LowPlace>,
}

impl AltitudeCheck {
    /// Before the first segment.
    pub(crate) fn new() -> Self {
        Self {
            least_m: f64::INFINITY,
            lowest: None,
        }
    }

    /// Checks one segment. A piece is clear when the bed, at its steepest, cannot rise to it. Any
    /// other piece is halved until the remaining doubt is below the tolerance.
    pub(crate) fn check(&mut self, problem: &PathProblem<'_>, from: &TimedPoint, to: &TimedPoint) {
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
        let (depth_m, sigma_m) = bed.sounding_m(x, y);
        let required_m = problem.min_altitude_m + problem.altitude_sigmas * sigma_m;
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
            self.report(LowPlace {
                place: middle.position,
                time_s: middle.time_s,
                altitude_m,
                required_m,
            });
        }
        // Where a piece is too low already, its worst place is found to within a metre.
        if doubt_m > TOLERANCE_M && !is_last && !(is_low && across.norm() < 1.0) {
            self.check(problem, from, &middle);
            self.check(problem, &middle, to);
        }
    }

    /// Keeps the place that falls short most.
    fn report(&mut self, low: LowPlace) {
        let short_m = |low: &LowPlace| low.required_m - low.altitude_m;
        let is_worse = |worst: LowPlace| !(short_m(&low) <= short_m(&worst));
        if self.lowest.is_none_or(is_worse) {
            self.lowest = Some(low);
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

    fn checked(depth_m: f64, east_m: f64) -> AltitudeCheck {
        let vehicle = Vehicle::paper();
        let start = Point3::new(0.0, east_m, depth_m);
        let target = Point3::new(1000.0, east_m, depth_m);
        let problem = PathProblem {
            sea_bed: Some(&Pinnacle),
            min_altitude_m: 5.0,
            ..PathProblem::new(start, target, &vehicle)
        };
        let mut altitude = AltitudeCheck::new();
        let to = TimedPoint::new(target, 300.0);
        altitude.check(&problem, &TimedPoint::new(start, 0.0), &to);
        altitude
    }

    /// A flat bed that gives no bound of its slope.
    #[derive(Debug)]
    struct Unbounded;

    impl SeaBed for Unbounded {
        fn depth_at(&self, _north_m: f64, _east_m: f64) -> f64 {
            100.0
        }

        fn max_slope_near(&self, _north_m: f64, _east_m: f64, _radius_m: f64) -> f64 {
            f64::INFINITY
        }
    }

    #[test]
    fn a_vertical_dive_needs_no_bound_of_the_slope() {
        let vehicle = Vehicle::paper();
        let start = Point3::new(0.0, 0.0, 10.0);
        let lowest = |target: Point3<f64>| {
            let problem = PathProblem {
                sea_bed: Some(&Unbounded),
                min_altitude_m: 5.0,
                ..PathProblem::new(start, target, &vehicle)
            };
            let mut altitude = AltitudeCheck::new();
            let ends =
                [(start, 0.0), (target, 60.0)].map(|(at, time_s)| TimedPoint::new(at, time_s));
            altitude.check(&problem, &ends[0], &ends[1]);
            altitude.lowest
        };
        assert!(lowest(Point3::new(0.0, 0.0, 94.0)).is_none());
        assert!(lowest(Point3::new(0.0, 0.0, 99.0)).is_some());
        assert!(lowest(Point3::new(100.0, 0.0, 10.0)).is_some());
    }

    #[test]
    fn a_pinnacle_between_samples_is_found() {
        let low = checked(40.0, 0.0).lowest.unwrap();
        assert!(
            (low.place.x - 333.3).abs() < 1.5 && low.altitude_m < 5.0,
            "{low:?}"
        );
        let passed_s = 0.3 * low.place.x;
        assert!((low.time_s - passed_s).abs() < 1e-9, "{low:?}");
        assert!(checked(40.0, 1.5).lowest.is_none() && checked(4.0, 0.0).lowest.is_none());
        assert!(checked(96.0, 30.0).lowest.is_some());
    }
}
