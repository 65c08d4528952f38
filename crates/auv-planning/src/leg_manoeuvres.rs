//! What a leg needs beyond its guide: turns, changes of depth, circles.

use crate::departure::{DepartureManoeuvre, circuits, is_too_steep, turns};
use crate::leg_outline::{LegOutline, UnderWay};
use crate::motion::{LEVELLING_RADII, begins_level, level_heading, tightest_circle_m};
use crate::polyline::rounded_length_m;
use crate::{PathProblem, Vehicle};
use auv_types::{Point3, Vector3, libm};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A turn is over before this distance, in turn radii: so far along the guide it aims.
const AIM_RADII: f64 = 8.0;
/// A guide no farther from a straight line than this leads straight, metres.
const STRAIGHT_M: f64 = 2.0;
/// Share of the steepest slope that a climb along a bent guide uses where the guide is too steep.
const CLIMB_SLOPE: f64 = 0.65;
/// On circuits a shorter path is planned so often, seconds: the default of the synchroniser's `improve_s`.
const IMPROVED_S: f64 = 60.0;
/// Most such plans that are counted.
const MOST_IMPROVEMENTS: usize = 500;
/// What a leg needs beyond its guide in still, empty water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LegManoeuvres {
    /// Added by the turn from the direction flown, metres.
    pub(crate) turns_m: f64,
    /// Added by climbing or diving no more steeply than the pitch allows, metres.
    pub(crate) climbs_m: f64,
    /// The direction of arrival.
    arrival: Vector3<f64>,
}

impl LegManoeuvres {
    /// Those of a leg. A vehicle that turns on the spot and pitches freely needs none.
    pub(crate) fn of(vehicle: &Vehicle, leg: &LegOutline<'_>) -> Self {
        let none = Self {
            turns_m: 0.0,
            climbs_m: 0.0,
            arrival: last_direction(leg.guide),
        };
        let free = vehicle.turn_radius_m <= 0.0 && vehicle.max_pitch_rad >= FRAC_PI_2;
        match leg.guide {
            [_, _, ..] if free => none,
            &[first, .., last] if is_straight_across(leg.guide) => {
                straight(vehicle, leg, first, last)
            }
            [first, .., last] => {
                let (aim, to_aim_m) = aim(leg.guide, AIM_RADII * vehicle.turn_radius_m);
                let problem = leaving(vehicle, leg.from, *first, aim);
                let turn = turned(&problem, false);
                let turns_m = turn.map_or(0.0, |way| way.length_m - to_aim_m);
                let climbs_m =
                    stretched_m(vehicle, leg.length_m + turns_m.max(0.0), last.z - first.z);
                Self {
                    turns_m,
                    climbs_m,
                    ..none
                }
            }
            _ => none,
        }
    }

    /// How long the vehicle stays at the end for work of `stay_s`, seconds. A vehicle that cannot hover
    /// flies whole circles, after levelling out where it arrives pitched.
    pub(crate) fn stay_s(&self, vehicle: &Vehicle, stay_s: f64) -> f64 {
        if stay_s <= 0.0 || vehicle.can_hover() {
            return stay_s;
        }
        let circle_s = TAU * tightest_circle_m(vehicle) / vehicle.speed_mps;
        stay_s.max(circle_s) + self.levelling(vehicle).0 / vehicle.speed_mps
    }

    /// Where the vehicle is, and which way it goes, after the leg and its stay; `None`: at rest.
    pub(crate) fn leaves(
        &self,
        vehicle: &Vehicle,
        end: Point3<f64>,
        stay_s: f64,
    ) -> Option<UnderWay> {
        if stay_s <= 0.0 {
            return Some(UnderWay {
                place: end,
                velocity: self.arrival * vehicle.speed_mps,
            });
        }
        let level = level_heading(&self.arrival).unwrap_or_else(Vector3::x);
        (!vehicle.can_hover()).then(|| UnderWay {
            place: end + self.levelling(vehicle).1,
            velocity: level * vehicle.speed_mps,
        })
    }

    /// Length in metres and displacement of levelling out from the direction of arrival.
    fn levelling(&self, vehicle: &Vehicle) -> (f64, Vector3<f64>) {
        if begins_level(&self.arrival, tightest_circle_m(vehicle)) {
            return (0.0, Vector3::zeros());
        }
        let level = level_heading(&self.arrival).unwrap_or_else(Vector3::x);
        let lead_m = LEVELLING_RADII * vehicle.turn_radius_m;
        let knee = Point3::from(self.arrival * lead_m);
        let end = knee + level * lead_m;
        let length_m = rounded_length_m(&[Point3::origin(), knee, end], vehicle.turn_radius_m);
        (length_m.unwrap_or(2.0 * lead_m), end.coords)
    }
}

/// A way from the start of a leg to where it aims.
struct Way {
    length_m: f64,
    arrival: Vector3<f64>,
}

/// Whether a guide leads straight from end to end as seen from above. Its depths do not matter: a path changes
/// depth as steadily as it may.
fn is_straight_across(guide: &[Point3<f64>]) -> bool {
    let (Some(first), Some(last)) = (guide.first(), guide.last()) else {
        return false;
    };
    let line = (last - first).xy();
    let aside_m = |p: &Point3<f64>| {
        let offset = (p - first).xy();
        (line.x * offset.y - line.y * offset.x).abs() / line.norm().max(1e-9)
    };
    guide.len() == 2 || guide.iter().all(|p| aside_m(p) <= STRAIGHT_M)
}

/// A leg whose guide is a straight line: the first departure that can be flown, as path planners do.
fn straight(
    vehicle: &Vehicle,
    leg: &LegOutline<'_>,
    first: Point3<f64>,
    last: Point3<f64>,
) -> LegManoeuvres {
    let problem = leaving(vehicle, leg.from, first, last);
    // What the guide itself takes is counted as travel.
    let guide_m = leg.length_m;
    let steep = is_too_steep(&problem, 1.0);
    let turn = if steep { None } else { turned(&problem, true) };
    if let Some(way) = turn {
        return LegManoeuvres {
            turns_m: way.length_m - guide_m,
            climbs_m: 0.0,
            arrival: way.arrival,
        };
    }
    let climb = circled(&problem).or_else(|| turned(&problem, true));
    climb.map_or_else(
        || LegManoeuvres {
            turns_m: 0.0,
            climbs_m: stretched_m(vehicle, guide_m, last.z - first.z),
            arrival: last_direction(&[first, last]),
        },
        |way| LegManoeuvres {
            turns_m: 0.0,
            climbs_m: way.length_m - guide_m,
            arrival: way.arrival,
        },
    )
}

/// The problem of leaving for a place in still, empty water.
fn leaving<'a>(
    vehicle: &'a Vehicle,
    from: Option<UnderWay>,
    first: Point3<f64>,
    aim: Point3<f64>,
) -> PathProblem<'a> {
    PathProblem {
        start_velocity: from.map(|from| from.velocity),
        ..PathProblem::new(from.map_or(first, |from| from.place), aim, vehicle)
    }
}

/// The first turn that has room for its arcs, and whose climb is flat enough if `climbs`.
fn turned(problem: &PathProblem<'_>, climbs: bool) -> Option<Way> {
    turns(problem)
        .iter()
        .find_map(|departure| along(problem, departure, climbs))
}

/// Circuits to the depth of the target. Every [`IMPROVED_S`] a shorter path is planned from where the vehicle
/// is then, and flown if it is shorter: a direct one, or other circuits.
fn circled(problem: &PathProblem<'_>) -> Option<Way> {
    let vehicle = problem.vehicle;
    let piece_m = IMPROVED_S * vehicle.speed_mps;
    let (mut in_force, mut whole) = circuit(problem)?;
    // How long the vehicle has flown in all, and on the circuits in force.
    let (mut gone_m, mut on_these_m) = (0.0, 0.0);
    for _ in 0..MOST_IMPROVEMENTS {
        (gone_m, on_these_m) = (gone_m + piece_m, on_these_m + piece_m);
        let Some((place, side)) = walked(vehicle, &in_force, on_these_m) else {
            break;
        };
        let from = PathProblem {
            start: place,
            start_velocity: (vehicle.turn_radius_m > 0.0).then_some(side),
            ..*problem
        };
        let total_m = |way: &Way| gone_m + way.length_m;
        let direct = if is_too_steep(&from, 1.0) {
            None
        } else {
            turned(&from, true)
        };
        if let Some(direct) = direct.filter(|way| total_m(way) < whole.length_m) {
            let length_m = total_m(&direct);
            return Some(Way { length_m, ..direct });
        }
        let others = circuit(&from).filter(|(_, way)| total_m(way) < whole.length_m);
        if let Some((departure, way)) = others {
            let length_m = total_m(&way);
            (in_force, whole, on_these_m) = (departure, Way { length_m, ..way }, 0.0);
        }
    }
    Some(whole)
}

/// The first circuits that can be flown, and the way along them.
fn circuit(problem: &PathProblem<'_>) -> Option<(DepartureManoeuvre, Way)> {
    circuits(problem).into_iter().find_map(|departure| {
        let way = along(problem, &departure, false)?;
        Some((departure, way))
    })
}

/// Where a departure leads after so many metres with its corners rounded, and in which direction; `None`
/// beyond its end.
fn walked(
    vehicle: &Vehicle,
    departure: &DepartureManoeuvre,
    piece_m: f64,
) -> Option<(Point3<f64>, Vector3<f64>)> {
    // Each square corner saves the same.
    let saved_m = (2.0 - FRAC_PI_2) * vehicle.turn_radius_m;
    let mut corners = departure.corners.clone();
    corners.push(departure.end);
    let mut left_m = piece_m;
    for pair in corners.windows(2) {
        let side = pair[1] - pair[0];
        let side_m = side.norm() - saved_m;
        if left_m <= side_m {
            let share = (left_m / side_m).clamp(0.0, 1.0);
            return Some((pair[0] + side * share, side));
        }
        left_m -= side_m;
    }
    None
}

/// A departure and the straight rest to the target; `None` if a corner has no room for its arc, or if the
/// rest is too steep when `climbs`.
fn along(problem: &PathProblem<'_>, departure: &DepartureManoeuvre, climbs: bool) -> Option<Way> {
    let vehicle = problem.vehicle;
    let mut corners = departure.corners.clone();
    corners.extend([departure.end, problem.target]);
    let length_m = rounded_length_m(&corners, vehicle.turn_radius_m)?;
    let rest = problem.target - departure.end;
    let flat_enough = !climbs || stretched_m(vehicle, rest.norm(), rest.z) <= 0.0;
    flat_enough.then(|| Way {
        length_m,
        arrival: last_direction(&corners),
    })
}

/// How much longer than `length_m` a way must be for a change of depth, metres; 0 where it is long enough.
fn stretched_m(vehicle: &Vehicle, length_m: f64, rise_m: f64) -> f64 {
    let steepest = libm::sin(vehicle.max_pitch_rad.min(FRAC_PI_2));
    if rise_m.abs() <= steepest * length_m * (1.0 + 1e-9) {
        return 0.0;
    }
    let slope = CLIMB_SLOPE * libm::tan(vehicle.max_pitch_rad.min(FRAC_PI_2));
    libm::hypot(rise_m / slope, rise_m) - length_m
}

/// The first point of a guide that lies at least `least_m` along it, else its end, and how far that is.
fn aim(guide: &[Point3<f64>], least_m: f64) -> (Point3<f64>, f64) {
    let mut gone_m = 0.0;
    for pair in guide.windows(2) {
        let step = pair[1] - pair[0];
        let step_m = step.norm();
        if gone_m + step_m >= least_m && step_m > 0.0 {
            let share = (least_m - gone_m) / step_m;
            return (pair[0] + step * share, least_m);
        }
        gone_m += step_m;
    }
    (guide[guide.len() - 1], gone_m)
}

/// The direction of the last step of a polyline; north where there is none.
fn last_direction(points: &[Point3<f64>]) -> Vector3<f64> {
    let steps = points.windows(2).rev().map(|pair| pair[1] - pair[0]);
    let mut directions = steps.filter_map(|step| step.try_normalize(1e-9));
    directions.next().unwrap_or_else(Vector3::x)
}
