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

    /// A plane that rises to the north, and how often it was asked.
    #[derive(Debug)]
    struct Plane {
        slope: f64,
        soundings: std::sync::atomic::AtomicUsize,
    }

    impl SeaBed for Plane {
        fn depth_at(&self, north_m: f64, _east_m: f64) -> f64 {
            use std::sync::atomic::Ordering;
            self.soundings.fetch_add(1, Ordering::Relaxed);
            100.0 - self.slope * north_m
        }

        fn max_slope_near(&self, _north_m: f64, _east_m: f64, _radius_m: f64) -> f64 {
            self.slope.abs()
        }
    }

    /// 400 m north from 10 s to 210 s at these depths, over a plane, at least 5 m above it; and the soundings.
    fn over_a_plane(slope: f64, depths_m: [f64; 2]) -> (AltitudeCheck, usize) {
        let vehicle = Vehicle::paper();
        let bed = Plane {
            slope,
            soundings: 0.into(),
        };
        let [start, target] =
            [(0.0, depths_m[0]), (400.0, depths_m[1])].map(|(x, z)| Point3::new(x, 0.0, z));
        let problem = PathProblem {
            sea_bed: Some(&bed),
            min_altitude_m: 5.0,
            ..PathProblem::new(start, target, &vehicle)
        };
        let mut altitude = AltitudeCheck::new();
        let ends = [(start, 10.0), (target, 210.0)].map(|(at, time_s)| TimedPoint::new(at, time_s));
        altitude.check(&problem, &ends[0], &ends[1]);
        (altitude, bed.soundings.into_inner())
    }

    #[test]
    fn over_a_plane_the_lowest_place_is_an_end() {
        // The bed rises or falls, the way climbs or dives less or more: it is lowest at an end.
        for (slope, climb) in [
            (0.1, 0.0),
            (0.1, 0.05),
            (0.1, 0.3),
            (-0.1, 0.0),
            (-0.1, -0.3),
            (-0.3, 0.1),
            (0.0, 0.2),
            (0.0, -0.2),
        ] {
            let at_end = slope > climb;
            let lowest_m = if at_end { 400.0 } else { 0.0 };
            for (spare_m, kept) in [
                (20.0, true),
                (0.5, true),
                (0.0, true),
                (-0.009, true),
                (-0.02, false),
                (-3.0, false),
                // Below the bed.
                (-9.0, false),
            ] {
                let depth_m = |x: f64| 95.0 - spare_m - slope * lowest_m + climb * (lowest_m - x);
                let (found, _) = over_a_plane(slope, [0.0, 400.0].map(depth_m));
                let told = format!("{slope} {climb} {spare_m}: {found:?}");
                assert_eq!(found.lowest.is_none(), kept, "{told}");
                // The least altitude sampled is none of another place.
                assert!(found.least_m >= 5.0 + spare_m - 1e-9, "{told}");
                let Some(low) = found.lowest else { continue };
                let (x, rate) = (low.place.x, (slope - climb).abs());
                assert!((x - lowest_m).abs() <= 1.0, "{told}");
                let altitude_m = 5.0 + spare_m + rate * (x - lowest_m).abs();
                assert!((low.altitude_m - altitude_m).abs() < 1e-9, "{told}");
                assert!((low.place.z - depth_m(x)).abs() < 1e-9, "{told}");
                assert!((low.time_s - 10.0 - 0.5 * x).abs() < 1e-9, "{told}");
                assert!(
                    low.required_m == 5.0 && found.least_m == low.altitude_m,
                    "{told}"
                );
            }
        }
    }

    #[test]
    fn no_more_soundings_are_asked_than_are_needed() {
        // Far above: one. Over a flat bed on the level: one. Near a slope: to within the tolerance, near its end.
        assert_eq!(over_a_plane(0.1, [30.0; 2]).1, 1);
        assert_eq!(over_a_plane(0.0, [95.0; 2]).1, 1);
        assert_eq!(over_a_plane(0.0, [96.0; 2]).1, 1);
        let (found, soundings) = over_a_plane(0.1, [95.0 - 40.0; 2]);
        assert!(found.lowest.is_none() && soundings < 40, "{soundings}");
        // Along a slope, 3 cm above the least altitude: pieces of 0.4 m, of which there are 1,024.
        let (found, soundings) = over_a_plane(0.1, [94.97, 54.97]);
        assert!(found.lowest.is_none() && soundings < 2_100, "{soundings}");
        // All of it too low: to within a metre.
        let (found, soundings) = over_a_plane(0.1, [96.0, 56.0]);
        assert!(found.lowest.is_some() && soundings < 1_100, "{soundings}");
    }

    /// A flat bed that might be as steep as this.
    #[derive(Debug)]
    struct Steep(f64);

    impl SeaBed for Steep {
        fn depth_at(&self, _north_m: f64, _east_m: f64) -> f64 {
            100.0
        }

        fn max_slope_near(&self, _north_m: f64, _east_m: f64, _radius_m: f64) -> f64 {
            self.0
        }
    }

    #[test]
    fn pieces_below_a_millimetre_are_not_halved() {
        // A bed that may rise by 15 mm in half a millimetre, at the least altitude: proven from 0.5 mm pieces on.
        let vehicle = Vehicle::paper();
        let is_proven = |slope: f64, length_m: f64| {
            let [start, target] = [0.0, length_m].map(|x| Point3::new(x, 0.0, 95.0));
            let bed = Steep(slope);
            let problem = PathProblem {
                sea_bed: Some(&bed),
                min_altitude_m: 5.0,
                ..PathProblem::new(start, target, &vehicle)
            };
            let mut altitude = AltitudeCheck::new();
            let ends = [start, target].map(|at| TimedPoint::new(at, 0.0));
            altitude.check(&problem, &ends[0], &ends[1]);
            altitude.lowest.is_none()
        };
        assert!(is_proven(30.0, 1e-3) && is_proven(30.0, 2e-3));
        assert!(!is_proven(30.0, 0.9e-3) && !is_proven(50.0, 1e-3) && !is_proven(1e5, 0.01));
    }
}
