//! The exact check of a finished trajectory, between its vertices as well as at them.

use crate::error::not_flyable;
use auv_obstacles::{ObstacleId, TimedPoint};
use auv_planning::motion::{ALWAYS, least_clearance};
use auv_planning::polyline::turn_radius_m;
use auv_planning::{PathProblem, PlanError, Planned, Stats, Trajectory};
use auv_types::libm;

/// A clearance may miss the one asked for by this rounding, metres.
const ROUNDING_M: f64 = 1e-7;
/// A change of depth may exceed the pitch limit by this rounding, metres.
const PITCH_ROUNDING_M: f64 = 1e-6;
/// The steepest slope may be exceeded by this rounding, as a share.
const SLOPE_ROUNDING: f64 = 1e-6;
/// Share of the vehicle's turn radius that every vertex must keep. Where an arc is sampled, its
/// vertices turn a little tighter than the arc.
const TURN_RADIUS_SHARE: f64 = 0.99;
/// A start slower than this has no direction, m/s.
const LEAST_SPEED_MPS: f64 = 1e-6;

/// A trajectory with what it breaks.
#[derive(Clone, Debug)]
pub(crate) struct Examined {
    pub(crate) trajectory: Trajectory,
    pub(crate) shortfall: Shortfall,
}

impl Examined {
    pub(crate) fn new(problem: &PathProblem<'_>, trajectory: Trajectory) -> Self {
        Self {
            shortfall: examine(problem, &trajectory),
            trajectory,
        }
    }

    pub(crate) fn is_clear(&self) -> bool {
        self.shortfall.metres <= 0.0
    }

    /// The answer: whatever the cost measures, its violation is in metres.
    pub(crate) fn planned(
        self,
        problem: &PathProblem<'_>,
        cost: f64,
        stats: Stats,
    ) -> Planned<Trajectory> {
        let mut planned = Planned::new(self.trajectory, cost, self.shortfall.metres, stats);
        planned.blocked_by = self.shortfall.blocked_by(problem);
        planned
    }
}

/// The straight line to the target.
pub(crate) fn straight(problem: &PathProblem<'_>) -> Result<Examined, PlanError> {
    let ends = [problem.start, problem.target];
    let trajectory = problem.timed(&ends).map_err(not_flyable)?;
    Ok(Examined::new(problem, trajectory))
}

/// By how much a trajectory falls short of what the problem asks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Shortfall {
    /// The worst of clearance to regions, box, sea bed, turn radius and pitch, metres; 0 when nothing
    /// is broken.
    pub(crate) metres: f64,
    /// Index of the region that it intrudes upon most, if that is the worst of all.
    pub(crate) region: Option<usize>,
}

impl Shortfall {
    fn worsen(&mut self, metres: f64, region: Option<usize>) {
        if metres > self.metres {
            *self = Self { metres, region };
        }
    }

    /// The obstacle that blocks.
    pub(crate) fn blocked_by(&self, problem: &PathProblem<'_>) -> Option<ObstacleId> {
        self.region.map(|i| problem.regions[i].obstacle)
    }
}

/// Examines a trajectory in closed form against everything the problem asks.
fn examine(problem: &PathProblem<'_>, trajectory: &Trajectory) -> Shortfall {
    let points = trajectory.points();
    let mut shortfall = worst_intrusion(problem, trajectory);
    if let Some(bounds) = &problem.bounds {
        let excess = points.iter().map(|p| bounds.excess_m(&p.position));
        let excess_m = excess.fold(0.0, f64::max);
        if excess_m > ROUNDING_M {
            shortfall.worsen(excess_m, None);
        }
    }
    if let Some(floor) = problem.floor() {
        // A stay has no segments.
        if let [TimedPoint { position: p, .. }] = points {
            shortfall.worsen(p.z - floor.deepest_at(p.x, p.y), None);
        }
        for (from, to) in trajectory.segments() {
            let short_m = floor.grounding_m(&from.position, &to.position);
            shortfall.worsen(short_m, None);
        }
    }
    manoeuvres(problem, points, &mut shortfall);
    shortfall
}

/// Checks turn radius (as the metres that it lacks), pitch (as metres of depth beyond its limit) and
/// whether the start continues in the direction flown.
fn manoeuvres(problem: &PathProblem<'_>, points: &[TimedPoint], shortfall: &mut Shortfall) {
    let vehicle = problem.vehicle;
    let moving = || {
        points
            .windows(2)
            .filter(|pair| pair[0].position != pair[1].position)
    };
    if vehicle.turn_radius_m > 0.0 {
        let least_m = vehicle.turn_radius_m * TURN_RADIUS_SHARE;
        for triple in points.windows(3) {
            let radius_m = turn_radius_m(
                &triple[0].position,
                &triple[1].position,
                &triple[2].position,
            );
            shortfall.worsen(least_m - radius_m, None);
        }
        if let (Some(velocity), Some(first)) = (problem.start_velocity, moving().next()) {
            let ahead = first[1].position - first[0].position;
            if velocity.norm() > LEAST_SPEED_MPS {
                let before = first[0].position - velocity.normalize() * ahead.norm();
                let radius_m = turn_radius_m(&before, &first[0].position, &first[1].position);
                shortfall.worsen(least_m - radius_m, None);
            }
        }
    }
    if vehicle.max_pitch_rad < std::f64::consts::FRAC_PI_2 {
        let slope = libm::tan(vehicle.max_pitch_rad) * (1.0 + SLOPE_ROUNDING);
        for pair in moving() {
            let step = pair[1].position - pair[0].position;
            let short_m = step.z.abs() - slope * step.xy().norm();
            if short_m > PITCH_ROUNDING_M {
                shortfall.worsen(short_m, None);
            }
        }
    }
}

/// The region that a trajectory intrudes upon most.
fn worst_intrusion(problem: &PathProblem<'_>, trajectory: &Trajectory) -> Shortfall {
    let nearest = least_clearance(trajectory, problem.regions, ALWAYS, problem.clearance_m);
    let mut worst = Shortfall::default();
    let short_m = problem.clearance_m - nearest.clearance_m;
    if short_m > ROUNDING_M {
        worst.worsen(short_m, nearest.region);
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_obstacles::Region;
    use auv_ocean::{AnalyticBed, SeaBed, Undulation};
    use auv_planning::Vehicle;
    use auv_types::{Bounds, Point3, Seed, Vector3, rand::RngExt};

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
            let found_m = examine(&problem, &trajectory).metres;
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
            examine(&problem, &problem.timed(&points).unwrap()).metres
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
