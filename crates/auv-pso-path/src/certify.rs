//! The exact check of a finished trajectory: nothing slips through between samples.

use auv_obstacles::{ObstacleId, Region, RegionShape, TimedPoint};
use auv_planning::polyline::turn_radius_m;
use auv_planning::{PathProblem, Trajectory};
use auv_types::{Bounds, Point3, libm};

/// Rounding that a clearance of exactly the one asked for may lose, metres.
pub(crate) const ROUNDING_M: f64 = 1e-7;

/// What a trajectory breaks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Verdict {
    /// Metres by which it falls short, the worst of regions, box, sea bed, turns and pitch; 0 when
    /// it breaks nothing.
    pub(crate) short_m: f64,
    /// Index of the region it intrudes upon most.
    pub(crate) region: Option<usize>,
}

impl Verdict {
    fn worsen(&mut self, short_m: f64, region: Option<usize>) {
        if short_m > self.short_m {
            *self = Self { short_m, region };
        }
    }

    /// The obstacle that blocks.
    pub(crate) fn blocked_by(&self, problem: &PathProblem<'_>) -> Option<ObstacleId> {
        self.region.map(|i| problem.regions[i].obstacle)
    }
}

/// Examines a trajectory in closed form against everything the problem asks.
pub(crate) fn examine(problem: &PathProblem<'_>, trajectory: &Trajectory) -> Verdict {
    let points = trajectory.points();
    let mut verdict = worst_intrusion(problem, points);
    if let Some(bounds) = &problem.bounds {
        let excess = points.iter().map(|p| bounds.excess_m(&p.position));
        let excess_m = excess.fold(0.0, f64::max);
        if excess_m > ROUNDING_M {
            verdict.worsen(excess_m, None);
        }
    }
    if problem.sea_bed.is_some() {
        for (from, to) in trajectory.segments() {
            let short_m = grounding_m(problem, &from.position, &to.position);
            verdict.worsen(short_m, None);
        }
    }
    manoeuvres(problem, points, &mut verdict);
    verdict
}

/// Turns tighter than the vehicle's (as the metres that the radius lacks), pitch beyond its limit
/// (as metres of depth), and a start that does not go on in the direction flown.
fn manoeuvres(problem: &PathProblem<'_>, points: &[TimedPoint], verdict: &mut Verdict) {
    let vehicle = problem.vehicle;
    let moving = || {
        points
            .windows(2)
            .filter(|pair| pair[0].position != pair[1].position)
    };
    if vehicle.turn_radius_m > 0.0 {
        let least_m = vehicle.turn_radius_m * 0.99;
        for triple in points.windows(3) {
            let radius_m = turn_radius_m(
                &triple[0].position,
                &triple[1].position,
                &triple[2].position,
            );
            verdict.worsen(least_m - radius_m, None);
        }
        if let (Some(velocity), Some(first)) = (problem.start_velocity, moving().next()) {
            let ahead = first[1].position - first[0].position;
            if velocity.norm() > 1e-6 {
                let before = first[0].position - velocity.normalize() * ahead.norm();
                let radius_m = turn_radius_m(&before, &first[0].position, &first[1].position);
                verdict.worsen(least_m - radius_m, None);
            }
        }
    }
    if vehicle.max_pitch_rad < std::f64::consts::FRAC_PI_2 {
        let slope = libm::tan(vehicle.max_pitch_rad) * (1.0 + 1e-6);
        for pair in moving() {
            let step = pair[1].position - pair[0].position;
            let short_m = step.z.abs() - slope * step.xy().norm();
            if short_m > 1e-6 {
                verdict.worsen(short_m, None);
            }
        }
    }
}

/// How far a segment dips below the deepest allowed, metres (0: nowhere). Halved until the bed's
/// slope bound proves a piece clear or the piece is short.
pub(crate) fn grounding_m(problem: &PathProblem<'_>, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
    const SHORTEST_M: f64 = 0.5;
    let Some(bed) = problem.sea_bed else {
        return 0.0;
    };
    let length_m = (to - from).norm();
    let across_m = (to.xy() - from.xy()).norm();
    let middle = from + (to - from) * 0.5;
    let below = |p: &Point3<f64>| p.z - problem.deepest_at(p.x, p.y);
    let worst_m = below(from).max(below(to)).max(below(&middle));
    let slope = bed.max_slope_near(middle.x, middle.y, 0.5 * across_m)
        * (1.0 + 0.05 * problem.altitude_sigmas);
    let could_m = below(&middle) + slope * 0.5 * across_m + 0.5 * (to.z - from.z).abs();
    if could_m <= 0.0 || length_m <= SHORTEST_M {
        return worst_m.max(0.0);
    }
    grounding_m(problem, from, &middle)
        .max(grounding_m(problem, &middle, to))
        .max(worst_m)
}

/// The region that a polyline intrudes upon most. Regions far from a stretch of it, or that cannot
/// be intruded upon more than the worst so far, cost one comparison.
fn worst_intrusion(problem: &PathProblem<'_>, points: &[TimedPoint]) -> Verdict {
    const STRETCH: usize = 16;
    let mut worst = Verdict::default();
    let mut check = |i: usize, from: &TimedPoint, to: &TimedPoint| -> f64 {
        let short_m = problem.clearance_m - problem.regions[i].clearance(from, to).clearance_m;
        if short_m > ROUNDING_M {
            worst.worsen(short_m, Some(i));
        }
        problem.clearance_m - worst.short_m
    };
    let mut margin_m = problem.clearance_m;
    if let [only] = points {
        for i in 0..problem.regions.len() {
            check(i, only, only);
        }
        return worst;
    }
    let whole = Stretch::of(points);
    let near: Vec<usize> = (0..problem.regions.len())
        .filter(|&i| whole.may_touch(&problem.regions[i], margin_m))
        .collect();
    let last = points.len() - 1;
    for begin in (0..last).step_by(STRETCH) {
        let end = (begin + STRETCH).min(last);
        let stretch = Stretch::of(&points[begin..=end]);
        for &i in &near {
            if stretch.may_touch(&problem.regions[i], margin_m) {
                for pair in points[begin..=end].windows(2) {
                    if Stretch::of(pair).may_touch(&problem.regions[i], margin_m) {
                        margin_m = check(i, &pair[0], &pair[1]);
                    }
                }
            }
        }
    }
    worst
}

/// Where and when a stretch of a trajectory lies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    bounds: Bounds,
    begin_s: f64,
    end_s: f64,
}

impl Stretch {
    pub(crate) fn of(points: &[TimedPoint]) -> Self {
        let first = points[0];
        let mut bounds = Bounds::new(first.position, first.position);
        for point in &points[1..] {
            let at = point.position.coords;
            bounds.low = bounds.low.coords.zip_map(&at, f64::min).into();
            bounds.high = bounds.high.coords.zip_map(&at, f64::max).into();
        }
        Self {
            bounds,
            begin_s: first.time_s,
            end_s: points[points.len() - 1].time_s,
        }
    }

    /// Whether a region may come within `margin_m` of the stretch; never a false no.
    pub(crate) fn may_touch(&self, region: &Region, margin_m: f64) -> bool {
        let (begin_s, end_s) = (
            self.begin_s.max(region.from_s),
            self.end_s.min(region.until_s),
        );
        if begin_s > end_s {
            return false;
        }
        let (a, b) = (region.centre_at(begin_s), region.centre_at(end_s));
        let radius_m = region.radius_at(begin_s).max(region.radius_at(end_s));
        let reach_m = (radius_m + margin_m) * (1.0 + 1e-9) + 1e-6;
        let gap = |k: usize| {
            (a[k].min(b[k]) - self.bounds.high[k])
                .max(self.bounds.low[k] - a[k].max(b[k]))
                .max(0.0)
        };
        let across = gap(0) * gap(0) + gap(1) * gap(1);
        if reach_m < 0.0 || across > reach_m * reach_m {
            return false;
        }
        match region.shape {
            RegionShape::Ball => across + gap(2) * gap(2) <= reach_m * reach_m,
            RegionShape::Cylinder { top_m, bottom_m } => {
                let slack_m = margin_m + 1e-6;
                top_m - slack_m <= self.bounds.high.z && self.bounds.low.z <= bottom_m + slack_m
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_ocean::{AnalyticBed, BedFeature, SeaBed, Undulation};
    use auv_planning::Vehicle;
    use auv_types::{Seed, Vector3, rand::RngExt};

    #[test]
    fn culling_never_hides_an_intrusion() {
        let mut random = Seed(5).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let vehicle = Vehicle::paper();
        for _ in 0..50 {
            let regions: Vec<_> = (0..40)
                .map(|i| {
                    let centre =
                        Point3::new(draw(0.0, 2000.0), draw(-300.0, 300.0), draw(0.0, 200.0));
                    let mut region = if i % 3 == 0 {
                        Region::cylinder(centre, draw(5.0, 100.0), 0.0, draw(10.0, 150.0))
                    } else {
                        Region::ball(centre, draw(5.0, 100.0))
                    };
                    region.velocity_mps = Vector3::new(draw(-1.0, 1.0), draw(-1.0, 1.0), 0.0);
                    region.growth_mps = draw(-0.05, 0.1);
                    region.from_s = draw(-100.0, 500.0);
                    region
                })
                .collect();
            let problem = PathProblem {
                regions: &regions,
                clearance_m: 10.0,
                ..PathProblem::new(Point3::origin(), Point3::new(2000.0, 0.0, 50.0), &vehicle)
            };
            let points: Vec<_> = (0..60)
                .map(|i| Point3::new(f64::from(i) * 34.0, draw(-60.0, 60.0), draw(20.0, 80.0)))
                .collect();
            let trajectory = problem.timed(&points).unwrap();
            let mut slow = 0.0_f64;
            for region in &regions {
                for (from, to) in trajectory.segments() {
                    slow = slow.max(10.0 - region.clearance(from, to).clearance_m);
                }
            }
            let verdict = examine(&problem, &trajectory);
            assert!(
                (verdict.short_m - slow.max(0.0)).abs() < 1e-6,
                "{verdict:?} {slow}"
            );
        }
    }

    /// A level polyline of `length_m` along x with the given depths.
    fn along_x(depths_m: &[f64], length_m: f64) -> Vec<Point3<f64>> {
        let last = (depths_m.len() - 1) as f64;
        let point = |(i, &z): (usize, &f64)| Point3::new(length_m * i as f64 / last, 0.0, z);
        depths_m.iter().enumerate().map(point).collect()
    }

    #[test]
    fn dense_samples_come_close_to_the_worst_and_never_beyond() {
        let mut random = Seed(8).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let vehicle = Vehicle::paper();
        for round in 0..40 {
            let mut bed = AnalyticBed::new(60.0);
            bed.undulations.push(Undulation {
                amplitude_m: draw(0.0, 15.0),
                wavelength: [draw(60.0, 300.0), 0.0],
            });
            let mut moving = Region::ball(
                Point3::new(draw(100.0, 300.0), draw(-60.0, 60.0), 40.0),
                draw(20.0, 60.0),
            );
            moving.velocity_mps = Vector3::new(draw(-1.0, 1.0), draw(-1.0, 1.0), 0.0);
            let regions = [moving];
            let problem = PathProblem {
                regions: if round % 2 == 0 { &regions } else { &[] },
                clearance_m: 5.0,
                sea_bed: (round % 3 > 0).then_some(&bed as &dyn SeaBed),
                min_altitude_m: 2.0,
                bounds: Some(Bounds::new(
                    Point3::new(0.0, -100.0, draw(20.0, 50.0)),
                    Point3::new(400.0, 100.0, 100.0),
                )),
                ..PathProblem::new(Point3::origin(), Point3::new(400.0, 0.0, 40.0), &vehicle)
            };
            let depths_m: Vec<f64> = (0..5).map(|_| draw(30.0, 60.0)).collect();
            let trajectory = problem.timed(&along_x(&depths_m, 400.0)).unwrap();
            let found_m = examine(&problem, &trajectory).short_m;
            let mut sampled_m = 0.0_f64;
            for k in 0..=40_000 {
                let time_s = trajectory.duration_s() * f64::from(k) / 40_000.0;
                let point = TimedPoint::new(trajectory.at(time_s).0, time_s);
                let p = point.position;
                for region in problem.regions {
                    sampled_m = sampled_m.max(5.0 - region.distance_m(&point));
                }
                sampled_m = sampled_m
                    .max(problem.bounds.unwrap().excess_m(&p))
                    .max(p.z - problem.deepest_at(p.x, p.y));
            }
            assert!(
                found_m >= sampled_m - 0.02 && found_m <= sampled_m + 0.02,
                "round {round}: {found_m} m, sampled {sampled_m} m"
            );
        }
    }

    #[test]
    fn a_peak_between_the_vertices_is_found() {
        let vehicle = Vehicle::paper();
        let line = vec![[137.0, -50.0], [137.0, 50.0]];
        let ridge = auv_ocean::Footprint::Line {
            points: line,
            half_width_m: 2.0,
        };
        let bed = AnalyticBed::new(80.0).with(BedFeature::new("ridge", ridge, 20.0, 25.0));
        let problem = PathProblem {
            sea_bed: Some(&bed),
            ..PathProblem::new(Point3::origin(), Point3::new(400.0, 0.0, 0.0), &vehicle)
        };
        let at = |x: f64, z: f64| Point3::new(x, 0.0, z);
        assert!((grounding_m(&problem, &at(0.0, 30.0), &at(400.0, 30.0)) - 10.0).abs() < 0.2);
        assert_eq!(grounding_m(&problem, &at(0.0, 19.0), &at(400.0, 19.0)), 0.0);
    }

    /// A ridge whose crest lies 45 m deep at 85 m north and whose flanks fall by 1 m a metre.
    #[derive(Debug)]
    struct Ridge;

    impl SeaBed for Ridge {
        fn depth_at(&self, north_m: f64, _east_m: f64) -> f64 {
            45.0 + (north_m - 85.0).abs()
        }
        fn max_slope_near(&self, _: f64, _: f64, _: f64) -> f64 {
            1.0
        }
    }

    #[test]
    fn a_descent_into_a_rising_bed_is_found() {
        let vehicle = Vehicle::paper();
        let problem = PathProblem {
            sea_bed: Some(&Ridge),
            ..PathProblem::new(Point3::origin(), Point3::new(100.0, 0.0, 0.0), &vehicle)
        };
        // Start, middle and end are clear; the bed's slope alone would not reach the path.
        let (from, to) = (Point3::new(0.0, 0.0, 5.0), Point3::new(100.0, 0.0, 55.0));
        let short_m = grounding_m(&problem, &from, &to);
        assert!((short_m - 2.5).abs() < 0.3, "{short_m}");
    }

    #[test]
    fn turns_pitch_and_the_first_course_are_held_to_the_vehicle() {
        let vehicle = Vehicle::default();
        let short_m = |points: &[(f64, f64, f64)], start_velocity: Option<Vector3<f64>>| {
            let points: Vec<_> = points
                .iter()
                .map(|&(x, y, z)| Point3::new(x, y, z))
                .collect();
            let problem = PathProblem {
                start_velocity,
                ..PathProblem::new(points[0], points[points.len() - 1], &vehicle)
            };
            examine(&problem, &problem.timed(&points).unwrap()).short_m
        };
        let straight = [(0.0, 0.0, 50.0), (100.0, 0.0, 50.0)];
        assert_eq!(short_m(&straight, None), 0.0);
        // The circle that touches the middles of two sides of 20 m at a right angle has 10 m.
        let tight = [(0.0, 0.0, 50.0), (20.0, 0.0, 50.0), (20.0, 20.0, 50.0)];
        assert!((short_m(&tight, None) - (0.99 * 20.0 - 10.0)).abs() < 1e-9);
        let steep = [(0.0, 0.0, 0.0), (100.0, 0.0, 50.0)];
        let allowed_m = 100.0 * libm::tan(vehicle.max_pitch_rad);
        assert!((short_m(&steep, None) - (50.0 - allowed_m)).abs() < 1e-4);
        assert_eq!(short_m(&straight, Some(Vector3::new(1.5, 0.0, 0.0))), 0.0);
        assert!(short_m(&straight, Some(Vector3::new(-1.5, 0.1, 0.0))) > 1.0);
    }
}
