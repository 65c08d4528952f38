//! Set-points for an autopilot: heading, speed and depth from the trajectory in force.

use crate::{Mission, Observation};
use auv_planning::Trajectory;
use auv_types::{Point3, Vector3, libm};

/// Set-points for a vehicle that steers by heading, speed through the water and depth.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SetPoint {
    /// Heading through the water, clockwise from north, in radians from 0 to 2 pi. `None`: keep the
    /// present heading (hovering in still water, or going straight up or down).
    pub heading_rad: Option<f64>,
    /// Speed through the water, m/s, within what the vehicle can do.
    pub speed_mps: f64,
    /// Depth to be at when the set-point ends, metres.
    pub depth_m: f64,
    /// Pitch of the way through the water, nose up positive, radians, within the vehicle's limit.
    pub pitch_rad: f64,
    /// Change of depth, down positive, m/s.
    pub vertical_rate_mps: f64,
    /// The place to be at when the set-point ends, for a vehicle that steers to places itself.
    pub aim: Point3<f64>,
    /// Mission time until which the set-point holds, seconds. Then ask for the next.
    pub valid_until_s: f64,
}

/// Time in which an error of place is to be made good, seconds. An autopilot turns within some 3 s.
const CORRECT_S: f64 = 4.0;
/// A vehicle that is ahead of its time flies at least at this share of the trajectory's speed.
const LEAST_SHARE: f64 = 0.5;

/// The set-point for a vehicle where it is: it follows the trajectory from where that is now to where it is `lookahead_s`
/// later (less near its end), makes an error of place good within some seconds, and takes off the current as forecast.
/// Across the trajectory it steers back by at most 45 degrees. A vehicle that is ahead of its time flies at half the
/// trajectory's speed at least, one that is behind as quickly as it can. After the end it is held there against the current.
///
/// All numbers of the result are finite. A non-finite time is replaced by the start of the trajectory, a non-finite
/// position by the trajectory's, a non-finite `lookahead_s` by 1 s, a non-finite current by still water.
#[must_use]
pub fn set_point(
    trajectory: &Trajectory,
    mission: &Mission,
    now: &Observation,
    lookahead_s: f64,
) -> SetPoint {
    let usable = |value: f64, otherwise: f64| if value.is_finite() { value } else { otherwise };
    let time_s = usable(now.time_s, trajectory.start().time_s);
    let lookahead_s = usable(lookahead_s, 1.0).clamp(1e-3, 1e6);
    let place = trajectory.at(time_s).0;
    let aim = trajectory.at(time_s + lookahead_s).0;
    let left_s = trajectory.end().time_s - time_s;
    let span_s = if left_s > 1e-3 {
        lookahead_s.min(left_s)
    } else {
        lookahead_s
    };
    let off = place - now.position;
    let off = if off.iter().all(|x| x.is_finite()) {
        off
    } else {
        Vector3::zeros()
    };
    let ground = corrected((aim - place) / span_s, off);
    let middle_s = time_s + 0.5 * span_s;
    let current = mission.current.as_ref();
    let current = current.map(|current| current.velocity_at(&place, middle_s));
    let current = current.filter(|v| v.iter().all(|x| x.is_finite()));
    let water = current.map_or(ground, |current| ground - current);
    let level_mps = libm::hypot(water.x, water.y);
    let vehicle = &mission.vehicle;
    let pitch_rad = if water.norm() > 1e-6 {
        libm::atan2(-water.z, level_mps)
    } else {
        0.0
    };
    SetPoint {
        heading_rad: (level_mps > 1e-6).then(|| compass(libm::atan2(water.y, water.x))),
        speed_mps: water
            .norm()
            .max(vehicle.min_speed_mps)
            .min(vehicle.max_speed_mps),
        depth_m: aim.z,
        pitch_rad: pitch_rad
            .max(-vehicle.max_pitch_rad)
            .min(vehicle.max_pitch_rad),
        vertical_rate_mps: ground.z,
        aim,
        valid_until_s: time_s + span_s,
    }
}

/// A velocity over ground along the trajectory, with what makes an error of place good. Depth is left to the autopilot,
/// which gets it as a set-point of its own.
fn corrected(along: Vector3<f64>, off: Vector3<f64>) -> Vector3<f64> {
    let off = Vector3::new(off.x, off.y, 0.0);
    let speed_mps = libm::hypot(along.x, along.y);
    if speed_mps < 1e-6 {
        return along + off / CORRECT_S;
    }
    let course = Vector3::new(along.x, along.y, 0.0) / speed_mps;
    let behind_m = off.dot(&course);
    let quick_mps = (speed_mps + behind_m / CORRECT_S).max(LEAST_SHARE * speed_mps);
    let across = (off - course * behind_m) / CORRECT_S;
    let across = across * (quick_mps / across.norm().max(quick_mps));
    course * quick_mps + across + Vector3::new(0.0, 0.0, along.z)
}

/// An angle in radians brought to 0 up to, not including, 2 pi.
fn compass(angle_rad: f64) -> f64 {
    let turned = if angle_rad < 0.0 {
        angle_rad + std::f64::consts::TAU
    } else {
        angle_rad
    };
    if turned < std::f64::consts::TAU {
        turned
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
    use auv_ocean::UniformCurrent;
    use auv_planning::{PathProblem, Vehicle};
    use auv_types::Vector3;
    use std::f64::consts::{FRAC_PI_2, PI};
    use std::sync::Arc;

    fn mission(vehicle: Vehicle, current: Option<Vector3<f64>>) -> Mission {
        let waypoints = [0.0, 900.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 20.0)));
        let edges = [Edge::undirected(0, 1, Task::TRANSIT)];
        let network = Network::new(&waypoints, &edges, vehicle.speed_mps).unwrap();
        let (start, end) = (NodeId(0), NodeId(1));
        let mut mission = Mission::new(Arc::new(network), start, end, 5_000.0, vehicle);
        mission.current = current.map(|v| Arc::new(UniformCurrent::new(v)) as _);
        mission
    }

    fn way(mission: &Mission, target: Point3<f64>) -> Trajectory {
        let start = Point3::new(0.0, 0.0, 20.0);
        let problem = PathProblem {
            current: mission.current.as_deref(),
            ..PathProblem::new(start, target, &mission.vehicle)
        };
        problem.timed(&[start, target]).unwrap()
    }

    fn seen(time_s: f64, position: Point3<f64>) -> Observation {
        Observation {
            position_sigma_m: 0.0,
            time_s,
            position,
            velocity: Vector3::zeros(),
            regions: [].into(),
        }
    }

    /// For a vehicle that is on the trajectory at a time.
    fn on_time(way: &Trajectory, mission: &Mission, time_s: f64, lookahead_s: f64) -> SetPoint {
        set_point(way, mission, &seen(time_s, way.at(time_s).0), lookahead_s)
    }

    /// Flown by its set-points alone through the same current, the vehicle stays on the line.
    #[test]
    fn leads_along_the_trajectory_through_the_current() {
        let vehicle = Vehicle::default();
        for water in [
            None,
            Some(Vector3::new(0.3, 0.6, 0.0)),
            Some(Vector3::new(-0.7, 0.1, 0.0)),
        ] {
            let mission = mission(vehicle, water);
            for target in [
                (900.0, 0.0, 20.0),
                (-500.0, 700.0, 60.0),
                (0.0, -400.0, 5.0),
            ] {
                let target = Point3::new(target.0, target.1, target.2);
                let way = way(&mission, target);
                let (mut place, mut time_s) = (way.start().position, 0.0);
                while time_s < way.end().time_s - 2.0 {
                    let told = set_point(&way, &mission, &seen(time_s, place), 2.0);
                    let heading = told.heading_rad.unwrap();
                    let level = told.speed_mps * libm::cos(told.pitch_rad);
                    let down = -told.speed_mps * libm::sin(told.pitch_rad);
                    let through =
                        Vector3::new(level * libm::cos(heading), level * libm::sin(heading), down);
                    let span_s = told.valid_until_s - time_s;
                    place += (through + water.unwrap_or_default()) * span_s;
                    time_s = told.valid_until_s;
                    assert!((told.speed_mps - vehicle.speed_mps).abs() < 1e-6);
                    assert!((place.z - told.depth_m).abs() < 1e-6);
                    assert!((place - told.aim).norm() < 1e-6);
                }
                assert!((place - way.at(time_s).0).norm() < 1e-6);
            }
        }
    }

    #[test]
    fn heading_is_a_compass_course_and_pitch_is_up() {
        let mission = mission(Vehicle::paper(), None);
        let courses = [((100.0, 0.0, 20.0), 0.0), ((0.0, 100.0, 20.0), FRAC_PI_2)];
        for ((x, y, z), heading) in courses {
            let told = on_time(&way(&mission, Point3::new(x, y, z)), &mission, 1.0, 5.0);
            assert!((told.heading_rad.unwrap() - heading).abs() < 1e-12);
        }
        let west = on_time(
            &way(&mission, Point3::new(0.0, -90.0, 20.0)),
            &mission,
            1.0,
            5.0,
        );
        assert!((west.heading_rad.unwrap() - 1.5 * PI).abs() < 1e-12);
        let up = on_time(
            &way(&mission, Point3::new(10.0, 0.0, 10.0)),
            &mission,
            1.0,
            1.0,
        );
        assert!(up.pitch_rad > 0.7 && up.vertical_rate_mps < 0.0);
    }

    #[test]
    fn holds_the_end_against_the_current_and_never_asks_for_more_than_the_vehicle_can() {
        let still = mission(Vehicle::paper(), None);
        let target = Point3::new(90.0, 0.0, 20.0);
        let over = on_time(&way(&still, target), &still, 1e4, 5.0);
        assert_eq!(
            (over.heading_rad, over.speed_mps, over.aim),
            (None, 0.0, target)
        );
        let stream = mission(Vehicle::paper(), Some(Vector3::new(0.0, 0.5, 0.0)));
        let over = on_time(&way(&stream, target), &stream, 1e4, 5.0);
        assert!((over.heading_rad.unwrap() - 1.5 * PI).abs() < 1e-12);
        assert_eq!(over.speed_mps, 0.5);
        let mut broken = mission(Vehicle::paper(), Some(Vector3::new(f64::NAN, 0.5, 0.0)));
        assert_eq!(
            on_time(&way(&still, target), &broken, 1.0, 5.0).speed_mps,
            3.0
        );
        broken.vehicle.min_speed_mps = 5.0;
        let most_mps = broken.vehicle.max_speed_mps;
        assert_eq!(
            on_time(&way(&still, target), &broken, 1.0, 5.0).speed_mps,
            most_mps
        );
        let cruising = mission(Vehicle::default(), None);
        let over = on_time(&way(&cruising, target), &cruising, 1e4, 5.0);
        assert_eq!(over.speed_mps, Vehicle::default().min_speed_mps);
        for (time_s, lookahead_s) in [
            (f64::NAN, 1.0),
            (3.0, f64::NAN),
            (f64::INFINITY, -1.0),
            (-1e9, 0.0),
        ] {
            let told = on_time(&way(&stream, target), &stream, time_s, lookahead_s);
            let numbers = [
                told.speed_mps,
                told.depth_m,
                told.pitch_rad,
                told.valid_until_s,
            ];
            assert!(numbers.iter().all(|x| x.is_finite()), "{told:?}");
        }
    }

    /// 3 m/s to the north: off to the side it turns back by at most 45 degrees, behind it hurries, ahead it goes on slowly.
    #[test]
    fn an_error_of_place_is_made_good() {
        let mission = mission(
            Vehicle {
                max_speed_mps: 5.0,
                ..Vehicle::paper()
            },
            None,
        );
        let way = way(&mission, Point3::new(900.0, 0.0, 20.0));
        let told = |north_m: f64, east_m: f64| {
            let place = Point3::new(300.0 + north_m, east_m, 20.0);
            let told = set_point(&way, &mission, &seen(100.0, place), 2.0);
            let heading = told.heading_rad.unwrap();
            (libm::remainder(heading, 2.0 * PI), told.speed_mps)
        };
        let near = told(0.0, 3.0).0;
        assert!(near < -0.1 && near > -0.3, "{near}");
        assert!((told(0.0, 500.0).0 + PI / 4.0).abs() < 1e-9);
        assert_eq!(told(-6.0, 0.0), (0.0, 4.5));
        assert_eq!(told(100.0, 0.0), (0.0, 1.5));
        assert_eq!(told(-100.0, 0.0), (0.0, 5.0));
        assert_eq!(told(f64::NAN, 0.0), (0.0, 3.0));
    }
}
