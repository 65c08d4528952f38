//! When the vehicle passes the points of a polyline.

use crate::motion::{NotFlyable, speed_over_ground_mps};
use crate::{PathProblem, Trajectory};
use auv_obstacles::TimedPoint;
use auv_types::{Point3, Vector3};

/// A piece that is no longer is not halved, metres.
const SHORTEST_PIECE_M: f64 = 2.0;

impl PathProblem<'_> {
    /// Speed over ground in m/s on a straight piece entered at `time_s`, reduced so that the vehicle
    /// needs no more than its greatest speed anywhere on it. A slower vehicle meets the current of a
    /// later time, so the reduction repeats until the speed no longer changes.
    fn slowed(
        &self,
        mut speed: f64,
        [from, to]: [Point3<f64>; 2],
        (direction, piece_m): (&Vector3<f64>, f64),
        time_s: f64,
    ) -> Result<f64, NotFlyable> {
        let Some(field) = self.current else {
            return Ok(speed);
        };
        for _ in 0..8 {
            let before = speed;
            let elapsed_s = piece_m / speed;
            // Ends and middle; more where the vehicle is slow over ground.
            let travelled_m = elapsed_s * self.vehicle.speed_mps;
            let samples = 2.0 * (travelled_m / 100.0).ceil().clamp(1.0, 100.0);
            for k in 0..=samples as usize {
                let share = k as f64 / samples;
                let place = from + (to - from) * share;
                let water = field.velocity_at(&place, time_s + elapsed_s * share);
                let most = self.vehicle.max_speed_mps;
                let limit = speed_over_ground_mps(most, direction, &water);
                speed = speed.min(limit.ok_or(NotFlyable { place })?);
            }
            if speed >= before * (1.0 - 1e-6) {
                break;
            }
        }
        Ok(speed)
    }

    /// Whether a piece might need more than the vehicle's greatest speed at one of its ends when its
    /// speed over ground is set for the current at its middle. A cautious bound for the whole field:
    /// twice its greatest current exceeds the greatest speed minus the cruising speed.
    fn may_exceed_max_speed(&self) -> bool {
        let spare_mps = self.vehicle.max_speed_mps - self.vehicle.speed_mps;
        self.current
            .is_some_and(|field| 2.0 * field.max_speed_mps() > spare_mps)
    }

    /// Times a polyline from the departure on, at cruising speed through the water (Eq. 17).
    ///
    /// With a current, segments are cut into pieces of at most 50 m. Each piece is travelled in the
    /// current at its middle. A piece on which a vehicle with speed to spare would exceed its greatest
    /// speed is halved until it is at most 2 m long; then it is travelled slower. Repeated points are merged.
    ///
    /// # Errors
    /// [`NotFlyable`] where the current is too strong.
    pub fn timed(&self, points: &[Point3<f64>]) -> Result<Trajectory, NotFlyable> {
        let first = points.first().copied().unwrap_or(self.start);
        let mut timed = vec![TimedPoint::new(first, self.departure_s)];
        let mut at = first;
        let may_exceed_max_speed = self.may_exceed_max_speed();
        for &point in points.iter().skip(1) {
            let length_m = (point - at).norm();
            if length_m <= 1e-9 {
                continue;
            }
            let direction = (point - at) / length_m;
            let pieces = if self.current.is_some() {
                (length_m / 50.0).ceil().max(1.0)
            } else {
                1.0
            };
            let piece_m = length_m / pieces;
            let begin = at;
            for k in 1..=pieces as usize {
                at = if k == pieces as usize {
                    point
                } else {
                    begin + direction * (piece_m * k as f64)
                };
                let middle = begin + direction * (piece_m * (k as f64 - 0.5));
                self.travel(
                    &mut timed,
                    [middle, at],
                    (&direction, piece_m),
                    may_exceed_max_speed,
                )?;
            }
        }
        Ok(Trajectory::from_ordered(timed))
    }

    /// Adds the end of a piece, and the ends of its halves where the current changes too much along it.
    fn travel(
        &self,
        timed: &mut Vec<TimedPoint>,
        [middle, end]: [Point3<f64>; 2],
        (direction, piece_m): (&Vector3<f64>, f64),
        may_exceed_max_speed: bool,
    ) -> Result<(), NotFlyable> {
        let TimedPoint {
            position: from,
            time_s,
        } = timed[timed.len() - 1];
        let guess_s = time_s + 0.5 * piece_m / self.vehicle.speed_mps;
        let mut speed = self
            .ground_speed_mps(direction, &middle, guess_s)
            .ok_or(NotFlyable { place: middle })?;
        if may_exceed_max_speed {
            let slowed = self.slowed(speed, [from, end], (direction, piece_m), time_s);
            let changes = slowed.as_ref().map_or(true, |&slowed| slowed < speed);
            // Without speed to spare a piece is slowed however short it is.
            let spare = self.vehicle.max_speed_mps > self.vehicle.speed_mps;
            if changes && spare && piece_m > SHORTEST_PIECE_M {
                let half_m = 0.5 * piece_m;
                for (middle, end) in [
                    (from + direction * (0.5 * half_m), middle),
                    (middle + direction * (0.5 * half_m), end),
                ] {
                    self.travel(timed, [middle, end], (direction, half_m), true)?;
                }
                return Ok(());
            }
            speed = slowed?;
        }
        timed.push(TimedPoint::new(end, time_s + piece_m / speed));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vehicle;
    use auv_ocean::{AnalyticCurrent, CurrentField, LambVortex, TidalConstituent};

    fn eddy() -> AnalyticCurrent {
        AnalyticCurrent {
            mean_mps: [0.2, -0.1],
            tide: vec![TidalConstituent::turning_at(1e3, [0.4, 0.3])],
            gains: Vec::new(),
            vortices: vec![LambVortex {
                centre: [800.0, 100.0],
                circulation_m2ps: 900.0,
                core_radius_m: 150.0,
            }],
        }
    }

    const WAY: [(f64, f64); 4] = [(0.0, 0.0), (600.0, 200.0), (900.0, -50.0), (1.6e3, 300.0)];

    fn way() -> [Point3<f64>; 4] {
        WAY.map(|(x, y)| Point3::new(x, y, 20.0))
    }

    #[test]
    fn travel_time_equals_steps_of_one_second() {
        let vehicle = Vehicle {
            max_speed_mps: 9.0,
            ..Vehicle::default()
        };
        let (current, way) = (eddy(), way());
        let problem = PathProblem {
            current: Some(&current),
            departure_s: 300.0,
            ..PathProblem::new(way[0], way[3], &vehicle)
        };
        let found = problem.timed(&way).unwrap();
        let mut slow_s = 300.0;
        for pair in way.windows(2) {
            let length_m = (pair[1] - pair[0]).norm();
            let direction = (pair[1] - pair[0]) / length_m;
            let mut gone_m = 0.0;
            while gone_m < length_m {
                let place = pair[0] + direction * gone_m;
                gone_m += problem
                    .ground_speed_mps(&direction, &place, slow_s)
                    .unwrap();
                slow_s += 1.0;
            }
        }
        let difference_s = found.end().time_s - slow_s;
        assert!(difference_s.abs() < 5.0, "{difference_s}");
        assert!((found.length_m() - way_m(&way)).abs() < 1e-9);
    }

    fn way_m(way: &[Point3<f64>]) -> f64 {
        way.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
    }

    #[test]
    fn never_needs_more_than_the_greatest_speed() {
        let (current, way) = (eddy(), way());
        for max_speed_mps in [1.5, 1.6, 2.0] {
            let vehicle = Vehicle {
                max_speed_mps,
                ..Vehicle::default()
            };
            let problem = PathProblem {
                current: Some(&current),
                ..PathProblem::new(way[0], way[3], &vehicle)
            };
            let found = problem.timed(&way).unwrap();
            for (from, to) in found.segments() {
                let ground = (to.position - from.position) / (to.time_s - from.time_s);
                for at in [from, to] {
                    let water = current.velocity_at(&at.position, at.time_s);
                    let speed_mps = (ground - water).norm();
                    assert!(speed_mps <= max_speed_mps * (1.0 + 1e-4), "{speed_mps}");
                }
            }
        }
    }

    #[test]
    fn still_water_adds_no_points_to_the_corners() {
        let vehicle = Vehicle::paper();
        let mut points = way().to_vec();
        points.insert(2, points[1]);
        let problem = PathProblem::new(points[0], points[4], &vehicle);
        let found = problem.timed(&points).unwrap();
        assert_eq!(found.points().len(), 4);
        assert!((found.duration_s() - way_m(&points) / 3.0).abs() < 1e-9);
        assert_eq!(problem.timed(&[]).unwrap().points().len(), 1);
    }
}
