//! A point that follows its trajectory through the true current.

use crate::{Guidance, SimulatedVehicle};
use auv_obstacles::TimedPoint;
use auv_ocean::CurrentField;
use auv_planning::{Trajectory, Vehicle};
use auv_types::rand::RngExt;
use auv_types::{Point3, Seed, Vector3, libm};

/// A point.
#[derive(Clone, Debug)]
pub(crate) struct PointVehicle {
    limits: Vehicle,
    position: Point3<f64>,
    velocity: Vector3<f64>,
    wander: Wander,
}

/// A slow, bounded guidance error: one sine per axis. It is zero at the start of a trajectory that starts
/// at the vehicle's position.
#[derive(Clone, Debug)]
struct Wander {
    amplitude_m: f64,
    /// The error at the start of the trajectory in force.
    at_start: Vector3<f64>,
    phases: [f64; 3],
    periods_s: [f64; 3],
}

impl Wander {
    fn new(amplitude_m: f64, seed: Seed) -> Self {
        let mut random = seed.stream(0);
        let phases = std::array::from_fn(|_| random.random_range(0.0..std::f64::consts::TAU));
        let periods_s = std::array::from_fn(|_| random.random_range(300.0..900.0));
        // The error is the difference of two values; it stays within a ball of the given radius. Depth
        // control is better than horizontal guidance.
        Self {
            amplitude_m: amplitude_m / 3.0,
            at_start: Vector3::zeros(),
            phases,
            periods_s,
        }
    }

    /// The error at a mission time.
    fn at(&self, time_s: f64) -> Vector3<f64> {
        self.absolute(time_s) - self.at_start
    }

    fn absolute(&self, time_s: f64) -> Vector3<f64> {
        let sine = |k: usize| {
            libm::sin(self.phases[k] + std::f64::consts::TAU * time_s / self.periods_s[k])
        };
        Vector3::new(sine(0), sine(1), 0.3 * sine(2)) * self.amplitude_m
    }
}

impl PointVehicle {
    pub(crate) fn new(
        limits: Vehicle,
        position: Point3<f64>,
        guidance_error_m: f64,
        seed: Seed,
    ) -> Self {
        Self {
            limits,
            position,
            velocity: Vector3::zeros(),
            wander: Wander::new(guidance_error_m, seed),
        }
    }

    fn follow_exactly(
        &mut self,
        trajectory: &Trajectory,
        from_s: f64,
        until_s: f64,
        track: &mut Vec<TimedPoint>,
    ) {
        let points = trajectory.points();
        let first = points.partition_point(|point| point.time_s <= from_s);
        let last = points.partition_point(|point| point.time_s < until_s);
        track.extend_from_slice(&points[first.min(last)..last]);
        let (position, velocity) = trajectory.at(until_s);
        let at_end = until_s >= trajectory.end().time_s;
        self.velocity = if at_end {
            trajectory.end_velocity()
        } else {
            velocity
        };
        self.position = position;
        track.push(TimedPoint::new(position, until_s));
    }

    /// Moves to the wanted position, or towards it as far as the speed through the water allows.
    fn steer_to(
        &mut self,
        wanted: Point3<f64>,
        step_s: f64,
        time_s: f64,
        water: Option<&dyn CurrentField>,
        pace: f64,
    ) {
        let drift = water.map_or_else(Vector3::zeros, |field| {
            field.velocity_at(&self.position, time_s - step_s)
        });
        let mut through = (wanted - self.position) / step_s - drift;
        let speed = through.norm();
        let most_mps = self.limits.max_speed_mps * pace;
        if speed > most_mps {
            through *= most_mps / speed;
        }
        self.velocity = drift + through;
        self.position += self.velocity * step_s;
    }
}

impl SimulatedVehicle for PointVehicle {
    fn position(&self) -> Point3<f64> {
        self.position
    }

    fn velocity(&self) -> Vector3<f64> {
        self.velocity
    }

    /// If the trajectory starts at the vehicle's position, the guidance error is zero there.
    fn take(&mut self, trajectory: &Trajectory, time_s: f64) {
        if (trajectory.at(time_s).0 - self.position).norm() < 1e-6 {
            self.wander.at_start = self.wander.absolute(time_s);
        }
    }

    /// Follows the trajectory at no more than `pace` times the greatest speed.
    fn advance(&mut self, guidance: &Guidance<'_>, track: &mut Vec<TimedPoint>) {
        let Guidance {
            trajectory,
            from_s,
            until_s,
            pace,
            water,
            ..
        } = *guidance;
        let exact = water.is_none() && pace >= 1.0 && self.wander.amplitude_m <= 0.0;
        if exact && (trajectory.at(from_s).0 - self.position).norm() < 1e-6 {
            return self.follow_exactly(trajectory, from_s, until_s, track);
        }
        let steps = (until_s - from_s).ceil().max(1.0);
        let step_s = (until_s - from_s) / steps;
        for k in 1..=steps as usize {
            let time_s = if k == steps as usize {
                until_s
            } else {
                from_s + step_s * k as f64
            };
            let wanted = trajectory.at(time_s).0 + self.wander.at(time_s);
            self.steer_to(wanted, step_s, time_s, water, pace);
            track.push(TimedPoint::new(self.position, time_s));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
    use auv_mission::Mission;
    use auv_ocean::UniformCurrent;

    fn line() -> Trajectory {
        let at = |x: f64, t: f64| TimedPoint::new(Point3::new(x, 0.0, 20.0), t);
        Trajectory::new(vec![at(0.0, 0.0), at(30.0, 20.0), at(60.0, 40.0)]).unwrap()
    }

    fn mission() -> Mission {
        let ends = [0.0, 60.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 20.0)));
        let edges = [Edge::undirected(0, 1, Task::TRANSIT)];
        let network = Network::new(&ends, &edges, 1.5).unwrap();
        Mission::new(
            network.into(),
            NodeId(0),
            NodeId(1),
            900.0,
            Vehicle::default(),
        )
    }

    fn guidance<'a>(
        trajectory: &'a Trajectory,
        mission: &'a Mission,
        until_s: f64,
        water: Option<&'a dyn CurrentField>,
    ) -> Guidance<'a> {
        Guidance {
            trajectory,
            from_s: 0.0,
            until_s,
            pace: 1.0,
            mission,
            water,
        }
    }

    #[test]
    fn follows_exactly_in_still_water() {
        let mut vehicle =
            PointVehicle::new(Vehicle::default(), line().start().position, 0.0, Seed(1));
        let mut track = Vec::new();
        vehicle.advance(&guidance(&line(), &mission(), 25.0, None), &mut track);
        assert_eq!(track.len(), 2);
        assert_eq!((vehicle.position.x, vehicle.velocity.x), (37.5, 1.5));
    }

    #[test]
    fn a_current_stronger_than_the_vehicle_carries_it_away() {
        let current = UniformCurrent::new(Vector3::new(-3.0, 0.0, 0.0));
        let mut vehicle =
            PointVehicle::new(Vehicle::default(), line().start().position, 0.0, Seed(1));
        let mut track = Vec::new();
        let water = Some(&current as &dyn CurrentField);
        vehicle.advance(&guidance(&line(), &mission(), 10.0, water), &mut track);
        assert!((vehicle.position.x + 10.0).abs() < 1e-9);
    }
}
