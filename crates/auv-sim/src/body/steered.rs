//! A REMUS 100 with its autopilot, steered by set-points.

use super::autopilot::Autopilot;
use super::remus100::Remus100;
use crate::{Guidance, SimulatedVehicle};
use auv_mission::{Observation, SetPoint, set_point};
use auv_obstacles::TimedPoint;
use auv_planning::Trajectory;
use auv_types::{Point3, Vector3, libm};

/// Time between two set-points, seconds, and how far ahead they look.
const TOLD_S: f64 = 0.5;
const LOOKAHEAD_S: f64 = 4.0;
/// Below this speed the body has no way, m/s.
const AT_REST_MPS: f64 = 0.05;

/// The body, its autopilot, and the clock of the body's steps.
#[derive(Clone, Debug)]
pub(crate) struct SteeredRemus {
    body: Remus100,
    autopilot: Autopilot,
}

impl SteeredRemus {
    /// At rest, heading along a direction.
    pub(crate) fn at(position: Point3<f64>, towards: &Vector3<f64>) -> Self {
        Self {
            body: Remus100::at(position, libm::atan2(towards.y, towards.x)),
            autopilot: Autopilot::default(),
        }
    }

    fn told(&self, guidance: &Guidance<'_>, time_s: f64) -> SetPoint {
        let now = Observation {
            position_sigma_m: 0.0,
            time_s,
            position: self.body.position,
            velocity: self.velocity(),
            regions: [].into(),
        };
        let told = set_point(guidance.trajectory, guidance.mission, &now, LOOKAHEAD_S);
        let most_mps = guidance.mission.vehicle.max_speed_mps * guidance.pace;
        SetPoint {
            speed_mps: told.speed_mps.min(most_mps),
            ..told
        }
    }
}

impl SimulatedVehicle for SteeredRemus {
    /// Starts to follow a trajectory: at rest, as at the launch, its bow is turned along it.
    fn take(&mut self, trajectory: &Trajectory, _time_s: f64) {
        if self.velocity().norm() > AT_REST_MPS {
            return;
        }
        let (first, points) = (trajectory.start().position, trajectory.points());
        let ahead = points.iter().map(|point| point.position - first);
        if let Some(ahead) = ahead.into_iter().find(|ahead| ahead.xy().norm() > 1.0) {
            self.body.attitude.z = libm::atan2(ahead.y, ahead.x);
        }
    }

    fn position(&self) -> Point3<f64> {
        self.body.position
    }

    /// Over ground. At the surface the body floats: it does not rise any more.
    fn velocity(&self) -> Vector3<f64> {
        let mut velocity = self.body.velocity();
        if self.body.position.z <= 0.0 {
            velocity.z = velocity.z.max(0.0);
        }
        velocity
    }

    /// Follows its trajectory by set-points alone.
    fn advance(&mut self, guidance: &Guidance<'_>, track: &mut Vec<TimedPoint>) {
        let (from_s, until_s) = (guidance.from_s, guidance.until_s);
        let steps = libm::round((until_s - from_s) / Remus100::STEP_S).max(1.0) as u64;
        let every = (TOLD_S / Remus100::STEP_S) as u64;
        let step_s = (until_s - from_s) / steps as f64;
        let mut told = None;
        for k in 0..steps {
            let time_s = from_s + step_s * k as f64;
            let current = guidance.water.map_or_else(Vector3::zeros, |field| {
                field.velocity_at(&self.body.position, time_s)
            });
            let told = match &told {
                Some(told) if k % every != 0 => told,
                _ => told.insert(self.told(guidance, time_s)),
            };
            let through = self.body.velocity() - current;
            let asked = self.autopilot.steer(&self.body, through.norm(), told);
            self.body.step(asked, &current);
            // It floats: it does not leave the water.
            self.body.position.z = self.body.position.z.max(0.0);
            if (k + 1) % every == 0 || k + 1 == steps {
                let now_s = from_s + step_s * (k + 1) as f64;
                track.push(TimedPoint::new(self.body.position, now_s));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
    use auv_mission::Mission;
    use auv_ocean::UniformCurrent;
    use auv_planning::{PathProblem, Vehicle, polyline};
    use std::sync::Arc;

    fn mission(current: Vector3<f64>) -> Mission {
        let vehicle = Vehicle {
            turn_radius_m: 25.0,
            max_speed_mps: 2.5,
            ..Vehicle::default()
        };
        let ends = [0.0, 900.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 20.0)));
        let edges = [Edge::undirected(0, 1, Task::TRANSIT)];
        let network = Network::new(&ends, &edges, vehicle.speed_mps).expect("sound");
        let mut mission = Mission::new(Arc::new(network), NodeId(0), NodeId(1), 5e3, vehicle);
        mission.current = Some(Arc::new(UniformCurrent::new(current)));
        mission
    }

    /// A course with turns, climbs and a current from ahead, abeam and astern: 95 % of the time within 3 m of the timed
    /// place, and never farther than 5 m once it has gathered way. A current asks for wider turns.
    #[test]
    fn it_keeps_to_the_timed_place() {
        for (radius_m, current) in [(25.0, [0.0, 0.0]), (30.0, [0.3, 0.3]), (30.0, [-0.4, 0.2])] {
            let current = Vector3::new(current[0], current[1], 0.0);
            let mission = mission(current);
            let corners = [
                [0.0, 0.0, 20.0],
                [200.0, 0.0, 20.0],
                [260.0, 150.0, 30.0],
                [60.0, 240.0, 30.0],
                [60.0, 320.0, 22.0],
                [400.0, 320.0, 22.0],
            ]
            .map(Point3::from);
            let points = polyline::rounded(&corners, radius_m);
            let problem = PathProblem {
                current: mission.current.as_deref(),
                ..PathProblem::new(corners[0], corners[5], &mission.vehicle)
            };
            let way = problem.timed(&points).expect("flyable");
            let mut vehicle = SteeredRemus::at(corners[0], &Vector3::x());
            let mut track = Vec::new();
            let end_s = way.end().time_s;
            let water = mission.current.as_deref();
            let flown = Guidance {
                trajectory: &way,
                from_s: 0.0,
                until_s: end_s,
                pace: 1.0,
                mission: &mission,
                water,
            };
            vehicle.advance(&flown, &mut track);
            let mut off: Vec<f64> = track
                .iter()
                .filter(|at| at.time_s > 20.0)
                .map(|at| (at.position - way.at(at.time_s).0).norm())
                .collect();
            off.sort_by(f64::total_cmp);
            let (usual, most) = (off[off.len() * 95 / 100], off[off.len() - 1]);
            assert!(
                usual < 3.0 && most < 5.0,
                "{current:?}: {usual} m, at most {most} m"
            );
        }
    }
}
