//! What the vehicle flies while it works at a waypoint.

use crate::pattern_way::Way;
use crate::station_keeping::{arc, level_heading};
use auv_obstacles::TimedPoint;
use auv_planning::motion::{ConnectionEnd, Pose};
use auv_planning::polyline::rounded;
use auv_planning::{PathProblem, Trajectory, Vehicle};
use auv_types::{Point3, Vector3, Violations, libm};
use std::f64::consts::TAU;

/// A yo-yo uses this share of the vehicle's pitch, and no more than this, radians.
const PITCH_SHARE: f64 = 0.9;
const MOST_PITCH_RAD: f64 = 0.6;
/// It begins level for this and for the first change of slope, metres.
const LEAD_M: f64 = 5.0;
/// Its curves are wider than the vehicle must turn by this.
const TURN_SHARE: f64 = 1.05;
/// Ways to fly a pattern that are tried.
const VARIANTS: usize = 4;
/// Least distance between the depths of a profile, metres.
const LEAST_PROFILE_M: f64 = 1.0;

/// What the vehicle flies while it works at a waypoint. It begins there, and ends there but for a yo-yo, which
/// ends at its far end.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Pattern {
    /// From one depth to another and back to the waypoint's, on the spot or on circles.
    Profile {
        /// The first depth, metres.
        from_m: f64,
        /// The second depth, metres.
        to_m: f64,
    },
    /// Up and down between two depths on a straight course.
    Yoyo {
        /// The upper depth, metres.
        top_m: f64,
        /// The lower depth, metres.
        bottom_m: f64,
        /// How far it goes, metres.
        length_m: f64,
        /// The course, degrees from north by east.
        heading_deg: f64,
    },
    /// Round the waypoint at its depth.
    Circle {
        /// The radius, metres.
        radius_m: f64,
        /// How often.
        #[cfg_attr(feature = "serde", serde(default = "once"))]
        turns: f64,
    },
}

#[cfg(feature = "serde")]
const fn once() -> f64 {
    1.0
}

/// How a task at a waypoint is done, where it is not just stayed for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Manner {
    /// What is flown.
    pub pattern: Option<Pattern>,
    /// Speed through the water meanwhile, m/s (`None`: cruising speed).
    pub speed_mps: Option<f64>,
    /// At which depth, metres; the vehicle comes back to the waypoint's after it (`None`: the waypoint's).
    pub depth_m: Option<f64>,
}

impl Manner {
    /// The vehicle at the speed of the task.
    pub(crate) fn vehicle(&self, vehicle: &Vehicle) -> Vehicle {
        Vehicle {
            speed_mps: self.speed_mps.unwrap_or(vehicle.speed_mps),
            ..*vehicle
        }
    }

    /// How long what is flown takes at a place in still water, seconds.
    #[must_use]
    pub fn takes_s(&self, vehicle: &Vehicle, place: Point3<f64>) -> f64 {
        let vehicle = &self.vehicle(vehicle);
        let there = Point3::new(place.x, place.y, self.depth_m.unwrap_or(place.z));
        let down = profile(place.z, there.z).flown(vehicle, place, &Vector3::x(), 0);
        let pattern = self
            .pattern
            .and_then(|pattern| pattern.flown(vehicle, there, &Vector3::x(), 0));
        // The profile leads down and back up.
        let lengths = down.iter().chain(&pattern).map(|points| length_m(points));
        lengths.sum::<f64>() / vehicle.speed_mps
    }
}

/// There and back again between two depths.
pub(crate) const fn profile(from_m: f64, to_m: f64) -> Pattern {
    Pattern::Profile { from_m, to_m }
}

fn length_m(points: &[Point3<f64>]) -> f64 {
    points
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm())
        .sum()
}

/// Trajectories from a place with a velocity to another depth there, in order of preference.
pub(crate) fn changes_of_depth<'p>(
    problem: &PathProblem<'p>,
    place: TimedPoint,
    velocity: Vector3<f64>,
    depth_m: f64,
) -> impl Iterator<Item = Trajectory> + use<'p> {
    let there = PathProblem {
        departure_s: place.time_s,
        ..*problem
    };
    let at = place.position;
    let to = Pose {
        place: Point3::new(at.x, at.y, depth_m),
        direction: level_heading(&velocity),
    };
    (0..VARIANTS).filter_map(move |variant| {
        let mut way = Way::from(there.vehicle, at, &velocity, variant);
        way.lead_to(ConnectionEnd::Pose(to))?;
        there.timed(&way.points).ok()
    })
}

impl Pattern {
    /// Everything that is wrong with it for a vehicle.
    #[must_use]
    pub fn validate(&self, vehicle: &Vehicle) -> Violations {
        let mut violations = Violations::new();
        let mut within = |value: f64, (least, most): (f64, f64), name: &str, unit: &str| {
            violations.require((least..=most).contains(&value), name, || {
                format!("is {value}; give {least} to {most} {unit}")
            });
        };
        let depths = (0.0, 11_000.0);
        match *self {
            Self::Profile { from_m, to_m } => {
                within(from_m, depths, "from_m", "m");
                within(to_m, depths, "to_m", "m");
                violations.require((to_m - from_m).abs() >= LEAST_PROFILE_M, "to_m", || {
                    format!("is {to_m}; give a depth at least {LEAST_PROFILE_M} m from from_m")
                });
            }
            Self::Yoyo {
                top_m,
                bottom_m,
                length_m,
                heading_deg,
            } => {
                within(top_m, depths, "top_m", "m");
                within(
                    bottom_m,
                    (top_m + 1.0, 11_000.0),
                    "bottom_m",
                    "m, below top_m",
                );
                within(length_m, (1.0, 100_000.0), "length_m", "m");
                within(
                    heading_deg,
                    (-360.0, 360.0),
                    "heading_deg",
                    "degrees from north by east",
                );
            }
            Self::Circle { radius_m, turns } => {
                let least_m = vehicle.turn_radius_m.max(0.1);
                within(
                    radius_m,
                    (least_m, 10_000.0),
                    "radius_m",
                    "m, the turn radius or more",
                );
                within(turns, (0.1, 1_000.0), "turns", "turns");
            }
        }
        violations
    }

    /// Where it ends and on which course if it begins at a place, where that is elsewhere.
    pub(crate) fn far_end(&self, place: Point3<f64>) -> Option<(Point3<f64>, Vector3<f64>)> {
        let Self::Yoyo {
            length_m,
            heading_deg,
            ..
        } = *self
        else {
            return None;
        };
        let (sin, cos) = libm::sincos(heading_deg.to_radians());
        let direction = Vector3::new(cos, sin, 0.0);
        Some((place + direction * length_m, direction))
    }

    /// Trajectories that fly it from a place with a velocity, in order of preference. Each is made when it is asked
    /// for: the first is often the one that is taken.
    pub(crate) fn ways<'p>(
        self,
        problem: &PathProblem<'p>,
        place: TimedPoint,
        velocity: Vector3<f64>,
    ) -> impl Iterator<Item = Trajectory> + use<'p> {
        let there = PathProblem {
            departure_s: place.time_s,
            ..*problem
        };
        (0..VARIANTS).filter_map(move |variant| {
            let points = self.flown(there.vehicle, place.position, &velocity, variant)?;
            there.timed(&points).ok()
        })
    }

    fn flown(
        &self,
        vehicle: &Vehicle,
        place: Point3<f64>,
        velocity: &Vector3<f64>,
        variant: usize,
    ) -> Option<Vec<Point3<f64>>> {
        let mut way = Way::from(vehicle, place, velocity, variant);
        match *self {
            Self::Profile { from_m, to_m } => {
                let direction = level_heading(velocity);
                for depth_m in [from_m, to_m, place.z] {
                    let place = Point3::new(place.x, place.y, depth_m);
                    way.lead_to(ConnectionEnd::Pose(Pose { place, direction }))?;
                }
            }
            Self::Yoyo { heading_deg, .. } => {
                let (sin, cos) = libm::sincos(heading_deg.to_radians());
                let direction = Vector3::new(cos, sin, 0.0);
                if vehicle.turn_radius_m > 0.0 {
                    way.lead_to(ConnectionEnd::Pose(Pose { place, direction }))?;
                }
                way.points.extend(self.saw(vehicle, place, direction));
            }
            Self::Circle { radius_m, turns } => {
                let side = if variant.is_multiple_of(2) { 1.0 } else { -1.0 };
                way.variant = 0;
                way.join_circle(place, side * radius_m)?;
                let (from, heading) = (way.points[way.points.len() - 1], way.direction);
                way.points
                    .extend(arc(from, heading, side * radius_m, TAU * turns));
                way.turn_to_last();
                way.lead_to(ConnectionEnd::Place(place))?;
            }
        }
        Some(way.points)
    }

    /// The teeth of a yo-yo, its first point excluded. Corners are moved out, so that the rounded ones reach the
    /// depths.
    fn saw(
        &self,
        vehicle: &Vehicle,
        place: Point3<f64>,
        direction: Vector3<f64>,
    ) -> Vec<Point3<f64>> {
        let Self::Yoyo {
            top_m,
            bottom_m,
            length_m,
            ..
        } = *self
        else {
            return Vec::new();
        };
        let pitch_rad = (PITCH_SHARE * vehicle.max_pitch_rad).min(MOST_PITCH_RAD);
        let radius_m = TURN_SHARE * vehicle.turn_radius_m;
        let steepest = libm::tan(pitch_rad);
        let lead_m = (radius_m * libm::tan(0.5 * pitch_rad) + LEAD_M).min(0.25 * length_m);
        let at = |along_m: f64, z: f64| {
            let level = place + direction * along_m;
            Point3::new(level.x, level.y, z)
        };
        // A vehicle that is about at the bottom already goes up first: a dive so short has no room for its curves.
        let curves_m = radius_m * (libm::tan(0.5 * pitch_rad) + steepest);
        let is_down = (bottom_m - place.z).abs() < curves_m * libm::sin(pitch_rad);
        let (first, begins_m) = if is_down { (1, top_m) } else { (0, bottom_m) };
        // Whole teeth: as many as the length has room for, a little flatter than they might be.
        let run_m = length_m - 2.0 * lead_m;
        let most_m = run_m * steepest;
        let (first_m, each_m) = ((begins_m - place.z).abs(), bottom_m - top_m);
        let teeth = ((most_m - first_m) / each_m.max(1e-9)).floor().max(0.0);
        let flat = ((first_m + teeth * each_m) / run_m).min(steepest);
        let beyond_m = radius_m * (libm::hypot(1.0, flat) - 1.0);
        let climbs_m = first_m + teeth * each_m + (2.0 * teeth + 1.0) * beyond_m;
        let slope = (climbs_m / run_m).min(steepest / PITCH_SHARE);
        let goals = |k: usize| match (first + k) % 2 {
            0 => bottom_m + beyond_m,
            _ => top_m - beyond_m,
        };
        let mut corners = vec![place, at(lead_m, place.z)];
        let (mut along_m, mut z) = (lead_m, place.z);
        for k in 0..=teeth as usize {
            let dive_m = (goals(k) - z).clamp(-most_m, most_m);
            along_m += dive_m.abs() / slope.max(1e-9);
            z += dive_m;
            corners.push(at(along_m.min(lead_m + run_m), z));
        }
        // It ends level: near the top of the box no way leads on from a climb.
        let end_m = z.clamp(top_m.min(place.z), bottom_m.max(place.z));
        if let Some(last) = corners.last_mut() {
            *last = at(lead_m + run_m, end_m);
        }
        corners.push(at(length_m, end_m));
        rounded(&corners, radius_m).into_iter().skip(1).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_planning::polyline::turn_radius_m;

    fn ways(pattern: Pattern, vehicle: &Vehicle) -> Vec<Trajectory> {
        let place = Point3::new(100.0, 50.0, 20.0);
        let problem = PathProblem::new(place, place, vehicle);
        let here = TimedPoint::new(place, 40.0);
        let ways = pattern.ways(&problem, here, Vector3::x() * 1.5);
        ways.collect()
    }

    fn depths_m(way: &Trajectory) -> (f64, f64) {
        let depths = way.points().iter().map(|p| p.position.z);
        depths.fold((f64::INFINITY, 0.0), |(low, high), z| {
            (low.min(z), f64::max(high, z))
        })
    }

    #[test]
    fn a_profile_reaches_its_depths_and_ends_where_it_began() {
        let pattern = Pattern::Profile {
            from_m: 10.0,
            to_m: 45.0,
        };
        for vehicle in [Vehicle::default(), Vehicle::paper()] {
            let ways = ways(pattern, &vehicle);
            assert!(!ways.is_empty());
            for way in &ways {
                let (top_m, bottom_m) = depths_m(way);
                assert!((top_m - 10.0).abs() < 0.1 && (bottom_m - 45.0).abs() < 0.1);
                let (begin, end) = (way.points()[0].position, way.end().position);
                assert!((begin - end).norm() < 1e-6);
                let manner = Manner {
                    pattern: Some(pattern),
                    ..Manner::default()
                };
                let takes_s = manner.takes_s(&vehicle, begin);
                assert!((way.duration_s() / takes_s - 1.0).abs() < 0.3, "{takes_s}");
            }
        }
    }

    #[test]
    fn a_yoyo_goes_up_and_down_to_its_far_end() {
        let pattern = Pattern::Yoyo {
            top_m: 10.0,
            bottom_m: 30.0,
            length_m: 600.0,
            heading_deg: 90.0,
        };
        let vehicle = Vehicle::default();
        for way in ways(pattern, &vehicle) {
            let (top_m, bottom_m) = depths_m(&way);
            assert!((top_m - 10.0).abs() < 0.2 && (bottom_m - 30.0).abs() < 0.2);
            let end = way.end().position;
            assert!((end.y - 650.0).abs() < 1e-6 && (end.x - 100.0).abs() < 1e-6);
            // It ends level.
            assert!(way.end_velocity().z.abs() < 1e-9);
            for p in way.points().windows(3) {
                let radius_m = turn_radius_m(&p[0].position, &p[1].position, &p[2].position);
                assert!(radius_m > 0.99 * vehicle.turn_radius_m, "{radius_m}");
            }
        }
    }

    #[test]
    fn a_yoyo_from_about_its_lower_depth_goes_up_first_and_keeps_its_curves() {
        let vehicle = Vehicle::default();
        for bottom_m in [18.0, 19.0, 19.9, 20.0, 20.1, 21.0, 22.0, 24.0] {
            let pattern = Pattern::Yoyo {
                top_m: 8.0,
                bottom_m,
                length_m: 400.0,
                heading_deg: 0.0,
            };
            let ways = ways(pattern, &vehicle);
            assert!(!ways.is_empty(), "{bottom_m} m");
            for way in ways {
                assert!((depths_m(&way).0 - 8.0).abs() < 0.2, "{bottom_m} m");
                for p in way.points().windows(3) {
                    let radius_m = turn_radius_m(&p[0].position, &p[1].position, &p[2].position);
                    assert!(
                        radius_m > 0.99 * vehicle.turn_radius_m,
                        "{bottom_m} m: {radius_m} m"
                    );
                }
            }
        }
    }

    #[test]
    fn a_circle_leads_round_the_waypoint() {
        let pattern = Pattern::Circle {
            radius_m: 60.0,
            turns: 2.0,
        };
        for vehicle in [Vehicle::default(), Vehicle::paper()] {
            for way in ways(pattern, &vehicle) {
                let centre = Point3::new(100.0, 50.0, 20.0);
                let away = way.points().iter().map(|p| (p.position - centre).norm());
                let on_circle = away.clone().filter(|m| (m - 60.0).abs() < 0.2).count();
                assert!(on_circle > 20);
                assert!(away.fold(0.0, f64::max) < 125.0);
                assert!((way.end().position - centre).norm() < 1e-6);
                let least_s = 2.0 * TAU * 60.0 / vehicle.speed_mps;
                assert!(way.duration_s() > least_s && way.duration_s() < least_s + 300.0);
            }
        }
    }

    #[test]
    fn every_value_of_a_pattern_out_of_range_is_told_by_its_place() {
        let vehicle = Vehicle::default();
        let profile = |from_m, to_m| Pattern::Profile { from_m, to_m };
        let yoyo = |top_m, bottom_m, length_m, heading_deg| Pattern::Yoyo {
            top_m,
            bottom_m,
            length_m,
            heading_deg,
        };
        let circle = |radius_m, turns| Pattern::Circle { radius_m, turns };
        let cases: [(Pattern, &[&str]); 15] = [
            (profile(0.0, 11_000.0), &[]),
            (profile(-1.0, 20.0), &["from_m"]),
            (profile(20.0, f64::NAN), &["to_m", "to_m"]),
            (profile(20.0, 20.5), &["to_m"]),
            (yoyo(0.0, 1.0, 1.0, -360.0), &[]),
            (yoyo(-1.0, 20.0, 100.0, 0.0), &["top_m"]),
            (yoyo(20.0, 20.5, 100.0, 0.0), &["bottom_m"]),
            (yoyo(20.0, 12_000.0, 100.0, 0.0), &["bottom_m"]),
            (yoyo(20.0, 30.0, 0.5, 0.0), &["length_m"]),
            (yoyo(20.0, 30.0, 100.0, 361.0), &["heading_deg"]),
            (circle(20.0, 0.1), &[]),
            (circle(19.9, 1.0), &["radius_m"]),
            (circle(10_001.0, 1.0), &["radius_m"]),
            (circle(50.0, 0.0), &["turns"]),
            (circle(f64::NAN, f64::INFINITY), &["radius_m", "turns"]),
        ];
        for (pattern, wanted) in cases {
            let violations = pattern.validate(&vehicle);
            let told: Vec<&str> = violations.list().iter().map(|v| &*v.place).collect();
            assert_eq!(told, wanted, "{pattern:?}");
        }
    }

    #[test]
    fn a_yoyo_alone_ends_elsewhere() {
        let place = Point3::new(100.0, 50.0, 20.0);
        let yoyo = Pattern::Yoyo {
            top_m: 10.0,
            bottom_m: 30.0,
            length_m: 200.0,
            heading_deg: -90.0,
        };
        let vehicle = Vehicle::default();
        let (end, direction) = yoyo.far_end(place).unwrap();
        assert!((end - Point3::new(100.0, -150.0, 20.0)).norm() < 1e-9);
        assert!((direction + Vector3::y()).norm() < 1e-12);
        for way in ways(yoyo, &vehicle) {
            // As seen from above: its depth there is that of its last tooth.
            assert!((way.end().position - end).xy().norm() < 1e-6);
        }
        let circle = Pattern::Circle {
            radius_m: 50.0,
            turns: 1.0,
        };
        assert_eq!(circle.far_end(place), None);
        assert_eq!(profile(10.0, 30.0).far_end(place), None);
    }
}
