//! Evasion without a planner: to the nearest place that stays clear, to wait there.

use crate::check;
use crate::station_keeping::{arc, level_heading, stays};
use auv_obstacles::TimedPoint;
use auv_planning::motion::{distance_to_regions_m, least_clearance};
use auv_planning::polyline::rounded;
use auv_planning::{PathProblem, Trajectory};
use auv_types::{Point3, Vector3, libm};

/// How far ahead candidates are compared, seconds. Beyond this a prediction says little.
const COMPARED_S: f64 = 120.0;

/// A trajectory of `duration_s` that stays here, or goes a short distance in some direction and stays
/// there.
///
/// The shortest candidate that keeps the problem's clearance is taken; if there is none, the candidate
/// with the least [`shortfall`]. Every candidate obeys box, bed, turn radius and pitch; `None` if there
/// is no such candidate.
pub(crate) fn evade(
    problem: &PathProblem<'_>,
    velocity: Vector3<f64>,
    duration_s: f64,
) -> Option<Trajectory> {
    let here = TimedPoint::new(problem.start, problem.departure_s);
    let mut best: Option<(f64, Trajectory)> = None;
    // Candidates come in order of length: a longer one must be strictly better.
    let is_better = |best: &Option<(f64, Trajectory)>, shortfall: f64| {
        best.as_ref().is_none_or(|(least, _)| shortfall < *least)
    };
    let consider = |best: &mut Option<(f64, Trajectory)>, way: Trajectory| {
        let shortfall = shortfall(problem, &way);
        if is_better(best, shortfall) && check::is_flyable(problem, &way) {
            *best = Some((shortfall, way));
        }
        best.as_ref().is_some_and(|(least, _)| *least <= 0.0)
    };
    for way in stays(problem, here, velocity, duration_s) {
        if consider(&mut best, way) {
            return best.map(|(_, way)| way);
        }
    }
    for length_m in [25.0, 50.0, 100.0, 200.0, 400.0, 800.0] {
        for direction in directions() {
            let points = way_towards(problem, velocity, &direction, length_m);
            let Ok(way) = problem.timed(&points) else {
                continue;
            };
            // No stay at the end can make up for what is lost on the way there.
            if !is_better(&best, least_shortfall(problem, &way, duration_s)) {
                continue;
            }
            let rest_s = (here.time_s + duration_s - way.end().time_s).max(1.0);
            for stay in stays(problem, way.end(), way.end_velocity(), rest_s) {
                let whole = way.clone().then(&stay);
                if whole.is_ok_and(|whole| consider(&mut best, whole)) {
                    return best.map(|(_, way)| way);
                }
            }
        }
    }
    best.map(|(_, way)| way)
}

/// How far and for how long a trajectory falls short of the problem's clearance, in metres summed over
/// samples; 0 if it keeps the clearance. Leading deeper into a region than the vehicle is now adds
/// [`DEEPER`] times that depth for every sample.
fn shortfall(problem: &PathProblem<'_>, way: &Trajectory) -> f64 {
    let start_s = problem.departure_s;
    let end_s = way.end().time_s.min(start_s + COMPARED_S);
    let wanted_m = problem.clearance_m;
    let nearest = least_clearance(way, problem.regions, (start_s, end_s), wanted_m);
    if nearest.clearance_m >= wanted_m {
        return 0.0;
    }
    sampled(problem, way, end_s).max(1e-9)
}

/// A lower bound on [`shortfall`] for all candidates of `duration_s` that start with `way`.
fn least_shortfall(problem: &PathProblem<'_>, way: &Trajectory, duration_s: f64) -> f64 {
    let end_s = problem.departure_s + COMPARED_S;
    if way.end().time_s >= end_s {
        shortfall(problem, way)
    } else if duration_s > COMPARED_S + 1.0 {
        sampled(problem, way, end_s)
    } else {
        0.0
    }
}

/// Samples of a candidate over the time compared.
const SAMPLES: u32 = 24;
/// A vehicle that is too near to a region rather stays there than crosses it.
const DEEPER: f64 = 5.0;

/// The sum of metres by which a trajectory is too near at even times from departure to `end_s` (or its
/// end), and [`DEEPER`] times how much deeper it leads than the vehicle is now, for every sample.
fn sampled(problem: &PathProblem<'_>, way: &Trajectory, end_s: f64) -> f64 {
    let (start_s, wanted_m) = (problem.departure_s, problem.clearance_m);
    let (mut sum_m, mut here_m, mut worst_m) = (0.0, 0.0, 0.0_f64);
    for k in 0..=SAMPLES {
        let time_s = start_s + (end_s - start_s) * f64::from(k) / f64::from(SAMPLES);
        if time_s > way.end().time_s + 1e-9 {
            break;
        }
        let place = TimedPoint::new(way.at(time_s).0, time_s);
        let depth_m = wanted_m - distance_to_regions_m(&place, problem.regions, wanted_m);
        if k == 0 {
            here_m = depth_m;
        }
        sum_m += depth_m;
        worst_m = worst_m.max(depth_m - here_m);
    }
    sum_m + DEEPER * f64::from(SAMPLES) * worst_m
}

/// Sixteen level directions, then steeply up and down.
pub(crate) fn directions() -> impl Iterator<Item = Vector3<f64>> {
    (0..16)
        .map(|k| {
            let heading = std::f64::consts::TAU * f64::from(k) / 16.0;
            Vector3::new(libm::cos(heading), libm::sin(heading), 0.0)
        })
        .chain([-Vector3::z(), Vector3::z()])
}

/// A turn into the direction, as tight as the vehicle can, and straight on; or a climb or dive. For a
/// vehicle that turns on the spot, a straight line that ends within the box.
fn way_towards(
    problem: &PathProblem<'_>,
    velocity: Vector3<f64>,
    direction: &Vector3<f64>,
    length_m: f64,
) -> Vec<Point3<f64>> {
    let start = problem.start;
    let radius_m = problem.vehicle.turn_radius_m;
    let mut points = vec![start];
    if radius_m > 0.0 && velocity.norm() > 0.0 && direction.z != 0.0 {
        // Straight on, as steeply up or down as the vehicle may.
        let pitch_rad = 0.95 * problem.vehicle.max_pitch_rad.min(1.0);
        let slope =
            level_heading(&velocity) * libm::cos(pitch_rad) + direction * libm::sin(pitch_rad);
        let ahead = velocity.normalize();
        let knee = start + ahead * radius_m;
        points = rounded(
            &[start, knee, knee + slope * length_m.max(radius_m)],
            radius_m,
        );
    } else if radius_m > 0.0 && velocity.norm() > 0.0 {
        let heading = level_heading(&velocity);
        let across = heading.x * direction.y - heading.y * direction.x;
        let side = if across >= 0.0 { 1.0 } else { -1.0 };
        points.extend(turn_towards(start, velocity, direction, side * radius_m));
        points.push(points[points.len() - 1] + direction * length_m);
    } else {
        let end = start + direction * length_m;
        points.push(problem.bounds.map_or(end, |bounds| bounds.clamp(&end)));
    }
    points
}

/// A level turn from a velocity into a direction, to the right (positive radius) or left, the first
/// point excluded.
pub(crate) fn turn_towards(
    start: Point3<f64>,
    velocity: Vector3<f64>,
    direction: &Vector3<f64>,
    radius_m: f64,
) -> impl Iterator<Item = Point3<f64>> {
    let heading = level_heading(&velocity);
    let across = heading.x * direction.y - heading.y * direction.x;
    let to_the_right_rad = libm::atan2(across, heading.dot(direction));
    let angle_rad = (to_the_right_rad * radius_m.signum()).rem_euclid(std::f64::consts::TAU);
    arc(start, heading, 1.05 * radius_m, angle_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_obstacles::Region;
    use auv_planning::Vehicle;

    #[test]
    fn evades_a_ball_and_waits() {
        for vehicle in [Vehicle::paper(), Vehicle::default()] {
            let mut ball = Region::ball(Point3::new(-150.0, 0.0, 50.0), 60.0);
            ball.velocity_mps = Vector3::new(1.0, 0.0, 0.0);
            let regions = [ball];
            let problem = PathProblem {
                regions: &regions,
                clearance_m: 10.0,
                ..PathProblem::new(
                    Point3::new(0.0, 0.0, 50.0),
                    Point3::new(500.0, 0.0, 50.0),
                    &vehicle,
                )
            };
            let way = evade(&problem, Vector3::x() * vehicle.speed_mps, 300.0).unwrap();
            let nearest = least_clearance(&way, &regions, (0.0, COMPARED_S), 1e9);
            assert!(nearest.clearance_m >= 10.0, "{nearest:?}");
        }
    }

    #[test]
    fn leaves_a_region_that_contains_the_vehicle() {
        let vehicle = Vehicle::paper();
        let regions = [Region::ball(Point3::new(0.0, -40.0, 50.0), 60.0)];
        let problem = PathProblem {
            regions: &regions,
            clearance_m: 5.0,
            ..PathProblem::new(
                Point3::new(0.0, 0.0, 50.0),
                Point3::new(500.0, 0.0, 50.0),
                &vehicle,
            )
        };
        let way = evade(&problem, Vector3::zeros(), 300.0).unwrap();
        assert!(distance_to_regions_m(&way.end(), &regions, 1e9) >= 5.0);
    }

    #[test]
    fn stays_within_a_margin_rather_than_go_through_a_wall() {
        let vehicle = Vehicle::paper();
        let regions: Vec<Region> = (0..8)
            .map(|k| {
                let bearing = std::f64::consts::TAU * f64::from(k) / 8.0;
                let (sin, cos) = libm::sincos(bearing);
                Region::cylinder(Point3::new(21.0 * cos, 21.0 * sin, 50.0), 20.0, 0.0, 100.0)
            })
            .collect();
        let problem = PathProblem {
            regions: &regions,
            clearance_m: 10.0,
            bounds: Some(auv_types::Bounds::new(
                Point3::new(-900.0, -900.0, 0.0),
                Point3::new(900.0, 900.0, 100.0),
            )),
            ..PathProblem::new(
                Point3::new(0.0, 0.0, 50.0),
                Point3::new(500.0, 0.0, 50.0),
                &vehicle,
            )
        };
        let way = evade(&problem, Vector3::zeros(), 300.0).unwrap();
        let nearest = least_clearance(&way, &regions, (0.0, COMPARED_S), 1e9);
        assert!(nearest.clearance_m >= 0.99, "{nearest:?}");
    }
}
