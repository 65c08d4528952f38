//! Staying at a place: hovering, or loitering for a vehicle that cannot stop.

use auv_obstacles::TimedPoint;
use auv_planning::polyline::rounded;
use auv_planning::{PathProblem, Trajectory, motion};
use auv_types::{Point3, Vector3, libm};
use std::f64::consts::TAU;

/// Radii of the circles that are tried, in turn radii.
const RADIUS_FACTORS: [f64; 2] = [1.05, 2.0];

/// Trajectories that start at a place with a velocity and stay near it for at least about `duration_s`,
/// in order of preference. A vehicle that hovers has one. Another circles to the right or to the left,
/// as tightly as it can or twice as wide, a whole number of times.
pub(crate) fn stays<'p>(
    problem: &PathProblem<'p>,
    place: TimedPoint,
    velocity: Vector3<f64>,
    duration_s: f64,
) -> impl Iterator<Item = Trajectory> + use<'p> {
    let rests = duration_s <= 0.0 || problem.vehicle.can_hover();
    let rest = rests.then(|| Trajectory::hover(place, duration_s));
    let length_m = problem.vehicle.speed_mps * duration_s;
    let mut shapes = Vec::new();
    for factor in RADIUS_FACTORS {
        let least_m = circle_radius_m(problem, factor);
        let circles = (length_m / (TAU * least_m)).floor().max(1.0);
        shapes.push((least_m.max(length_m / (TAU * circles)), circles));
    }
    // Where these have no room: as tight as it can, for longer than asked.
    let tight_m = circle_radius_m(problem, RADIUS_FACTORS[0]);
    if tight_m < shapes[0].0 {
        shapes.push((tight_m, (length_m / (TAU * tight_m)).ceil()));
    }
    if rests {
        shapes.clear();
    }
    rest.into_iter()
        .chain(circling(problem, place, velocity, shapes))
}

/// Trajectories that start at a place with a velocity and stay near it for at least `lasts_s`, in order
/// of preference. Each can be kept: it rests, or ends with whole circles that can be repeated.
pub(crate) fn holds<'p>(
    problem: &PathProblem<'p>,
    place: TimedPoint,
    velocity: Vector3<f64>,
    lasts_s: f64,
) -> impl Iterator<Item = Trajectory> + use<'p> {
    let hovers = problem.vehicle.can_hover();
    let rest = hovers.then(|| Trajectory::hover(place, lasts_s));
    let length_m = problem.vehicle.speed_mps * lasts_s;
    let factors = RADIUS_FACTORS.iter().filter(|_| !hovers);
    let shapes = factors.map(|&factor| {
        let radius_m = circle_radius_m(problem, factor);
        (radius_m, (length_m / (TAU * radius_m)).ceil().max(1.0))
    });
    let shapes = shapes.collect();
    rest.into_iter()
        .chain(circling(problem, place, velocity, shapes))
}

/// Circles of radius and number as listed, each to the right and to the left. Each is timed when it is asked
/// for: the first is often the one that is taken.
fn circling<'p>(
    problem: &PathProblem<'p>,
    place: TimedPoint,
    velocity: Vector3<f64>,
    shapes: Vec<(f64, f64)>,
) -> impl Iterator<Item = Trajectory> + use<'p> {
    let there = PathProblem {
        departure_s: place.time_s,
        ..*problem
    };
    let sides = |shape| [(shape, 1.0), (shape, -1.0)];
    let all = shapes.into_iter().flat_map(sides);
    all.filter_map(move |((radius_m, circles), side)| {
        let turn_radius_m = there.vehicle.turn_radius_m;
        let (at, radius_m) = (place.position, side * radius_m);
        let points = loiter(at, velocity, radius_m, circles, turn_radius_m);
        there.timed(&points).ok()
    })
}

/// The radius of a circle as a multiple of the turn radius, metres.
fn circle_radius_m(problem: &PathProblem<'_>, factor: f64) -> f64 {
    factor * problem.vehicle.turn_radius_m.max(5.0)
}

/// Levels out, then flies `circles` to the right (positive radius) or left.
fn loiter(
    place: Point3<f64>,
    velocity: Vector3<f64>,
    radius_m: f64,
    circles: f64,
    turn_radius_m: f64,
) -> Vec<Point3<f64>> {
    let level = level_heading(&velocity);
    let mut points = vec![place];
    if !motion::begins_level(&velocity, radius_m) {
        let lead_m = motion::LEVELLING_RADII * turn_radius_m;
        let knee = place + velocity.normalize() * lead_m;
        points = rounded(&[place, knee, knee + level * lead_m], turn_radius_m);
    }
    points.extend(arc(
        points[points.len() - 1],
        level,
        radius_m,
        TAU * circles,
    ));
    points
}

/// The horizontal unit vector of a velocity; north for one that has none.
pub(crate) fn level_heading(velocity: &Vector3<f64>) -> Vector3<f64> {
    motion::level_heading(velocity).unwrap_or_else(Vector3::x)
}

/// Points of a horizontal arc that leaves `place` along the level unit vector `heading` and turns
/// by `angle_rad` to the right (positive radius) or left, the first point excluded.
pub(crate) fn arc(
    place: Point3<f64>,
    heading: Vector3<f64>,
    radius_m: f64,
    angle_rad: f64,
) -> impl Iterator<Item = Point3<f64>> {
    let right = Vector3::new(-heading.y, heading.x, 0.0);
    let centre = place + right * radius_m;
    let size_m = radius_m.abs().max(1e-6);
    let step_rad = motion::arc_step_rad(size_m);
    let count = (angle_rad / step_rad).ceil().max(1.0);
    (1..=count as usize).map(move |k| {
        let turned = angle_rad * k as f64 / count;
        centre - right * (radius_m * libm::cos(turned)) + heading * (size_m * libm::sin(turned))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_planning::Vehicle;

    #[test]
    fn a_vehicle_that_cannot_stop_loiters_for_the_task_and_returns() {
        let vehicle = Vehicle::default();
        let problem = PathProblem::new(Point3::origin(), Point3::new(100.0, 0.0, 20.0), &vehicle);
        let place = TimedPoint::new(problem.target, 70.0);
        for (velocity, home) in [
            (Vector3::new(1.5, 0.0, 0.0), 1e-6),
            (Vector3::new(1.45, 0.0, 0.38), 50.0),
        ] {
            for way in stays(&problem, place, velocity, 600.0) {
                assert!(way.duration_s() >= 600.0 - 1.0 && way.duration_s() < 800.0);
                assert!((way.end().position - place.position).norm() < home);
                for triple in way.points().windows(3) {
                    let [a, b, c] = [triple[0].position, triple[1].position, triple[2].position];
                    assert!(auv_planning::polyline::turn_radius_m(&a, &b, &c) > 19.8);
                }
            }
        }
    }

    #[test]
    fn hovering_is_one_place() {
        let vehicle = Vehicle::paper();
        let problem = PathProblem::new(Point3::origin(), Point3::new(100.0, 0.0, 20.0), &vehicle);
        let ways: Vec<_> = stays(
            &problem,
            TimedPoint::new(problem.target, 10.0),
            Vector3::x(),
            60.0,
        )
        .collect();
        assert_eq!(
            (ways.len(), ways[0].duration_s(), ways[0].length_m()),
            (1, 60.0, 0.0)
        );
    }

    #[test]
    fn an_arc_turns_by_its_angle_at_its_radius() {
        let (place, quarter) = (Point3::new(5.0, -3.0, 20.0), std::f64::consts::FRAC_PI_2);
        for (radius_m, side) in [(40.0, 1.0), (-40.0, -1.0)] {
            let points: Vec<_> = arc(place, Vector3::x(), radius_m, quarter).collect();
            let centre = place + Vector3::y() * radius_m;
            for point in &points {
                assert!(((point - centre).norm() - 40.0).abs() < 1e-9);
            }
            let end = points[points.len() - 1];
            let expected = place + Vector3::new(40.0, 40.0 * side, 0.0);
            assert!((end - expected).norm() < 1e-9, "{end}");
            // The polyline leaves the arc by no more than the error of a chord.
            let half = (points[0] - place).norm() / 2.0;
            let error_m = 40.0 - libm::sqrt(40.0 * 40.0 - half * half);
            assert!(error_m <= Trajectory::CHORD_ERROR_M * 1.01, "{error_m} m");
        }
    }

    #[test]
    fn stays_are_to_the_right_and_left_tight_first_and_start_at_their_time() {
        let vehicle = Vehicle::default();
        let target = Point3::new(100.0, 0.0, 20.0);
        let problem = PathProblem::new(Point3::origin(), target, &vehicle);
        let place = TimedPoint::new(target, 70.0);
        let ways: Vec<_> = stays(&problem, place, Vector3::x() * 1.5, 600.0).collect();
        let reach: Vec<(f64, f64)> = ways
            .iter()
            .map(|way| {
                assert_eq!(way.start(), place);
                let east = way.points().iter().map(|p| p.position.y);
                east.fold((0.0, 0.0), |(low, high): (f64, f64), y| {
                    (low.min(y), high.max(y))
                })
            })
            .collect();
        let [right, left, wide_right, wide_left, ..] = reach[..] else {
            panic!("{reach:?}");
        };
        assert!(right.1 > 40.0 && right.0 > -1.0 && left.0 < -40.0 && left.1 < 1.0);
        assert!(wide_right.1 > 1.3 * right.1 && wide_left.0 < 1.3 * left.0);
        // Nothing is left to do: the place itself.
        assert_eq!(
            stays(&problem, place, Vector3::x(), 0.0)
                .map(|way| way.duration_s())
                .sum::<f64>(),
            0.0
        );
    }

    #[test]
    fn a_heading_is_level_and_north_where_there_is_none() {
        assert_eq!(level_heading(&Vector3::new(0.0, -2.0, 5.0)), -Vector3::y());
        assert_eq!(level_heading(&Vector3::z()), Vector3::x());
    }
}
