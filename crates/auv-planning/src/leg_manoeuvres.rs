//! What a leg needs beyond its guide: turns, changes of depth, circles.

use crate::Vehicle;
use crate::leg_outline::{Arrival, LegOutline, UnderWay};
use crate::motion::{
    ConnectionEnd, ConnectionStart, LEVELLING_RADII, LevelWay, Pose, STEEPEST_RAD, begins_level,
    connections_between, level_heading, shortest_level, tightest_circle_m,
};
use crate::polyline::rounded_length_m;
use auv_types::{Point3, Vector3, libm};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A turn is over before this distance, in turn radii: so far along the guide it aims.
const AIM_RADII: f64 = 8.0;
/// A guide no farther from a straight line than this leads straight, metres.
const STRAIGHT_M: f64 = 2.0;
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
        match leg.arrives {
            Some(arrival) if vehicle.turn_radius_m > 0.0 => arriving(vehicle, leg, arrival),
            _ => Self::in_any_direction(vehicle, leg),
        }
    }

    fn in_any_direction(vehicle: &Vehicle, leg: &LegOutline<'_>) -> Self {
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
                let from = leg.from.map_or(*first, |from| from.place);
                let turn_m = turn(vehicle, leg.from, *first, aim).length_m;
                let turns_m = libm::hypot(turn_m, aim.z - from.z) - to_aim_m;
                let length_m = leg.length_m + turns_m;
                let rise_m = last.z - first.z;
                let across_m = (length_m * length_m - rise_m * rise_m).max(0.0).sqrt();
                let climbs_m = stretched_m(vehicle, across_m, rise_m);
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

/// A leg whose guide is a straight line: the shortest connection, as path planners fly it.
fn straight(
    vehicle: &Vehicle,
    leg: &LegOutline<'_>,
    first: Point3<f64>,
    last: Point3<f64>,
) -> LegManoeuvres {
    let turn = turn(vehicle, leg.from, first, last);
    let from = leg.from.map_or(first, |from| from.place);
    let dive_m = last.z - from.z;
    let climbs_m = stretched_m(vehicle, turn.length_m, dive_m);
    if climbs_m > 0.0 {
        // No closed form has the length of what is too steep for the turn and too flat for a circle.
        let start = begins(leg.from, first);
        let flown = connections_between(vehicle, start, ConnectionEnd::Place(last));
        if let Some(shortest) = flown.first() {
            let level_m = libm::hypot(turn.length_m, dive_m);
            return LegManoeuvres {
                turns_m: level_m - leg.length_m,
                climbs_m: shortest.length_m - level_m,
                arrival: last_direction(&shortest.points),
            };
        }
    }
    let steepest = libm::tan(vehicle.max_pitch_rad.min(STEEPEST_RAD));
    let slope = (dive_m / turn.length_m.max(1e-9)).clamp(-steepest, steepest);
    let (sin, cos) = libm::sincos(turn.heading);
    LegManoeuvres {
        // What the guide itself takes is counted as travel.
        turns_m: libm::hypot(turn.length_m, dive_m) - leg.length_m,
        climbs_m,
        arrival: Vector3::new(cos, sin, slope).normalize(),
    }
}

/// A leg that arrives in a direction: its last part is the shortest connection to where its straight end begins;
/// all of it, where the guide leads straight or is short.
fn arriving(vehicle: &Vehicle, leg: &LegOutline<'_>, arrival: Arrival) -> LegManoeuvres {
    let free = LegManoeuvres::in_any_direction(vehicle, leg);
    let &[first, .., last] = leg.guide else {
        return free;
    };
    let end = ConnectionEnd::Pose(Pose {
        place: last - arrival.direction * arrival.lead_m,
        direction: arrival.direction,
    });
    let part_m = AIM_RADII * vehicle.turn_radius_m + arrival.lead_m;
    let is_whole = is_straight_across(leg.guide) || leg.length_m < 2.0 * part_m;
    let (start, replaced_m) = if is_whole {
        let free_m = free.turns_m + free.climbs_m;
        (begins(leg.from, first), leg.length_m + free_m)
    } else {
        let back: Vec<_> = leg.guide.iter().rev().copied().collect();
        let (place, replaced_m) = aim(&back, part_m);
        let (ahead, _) = aim(&back, part_m - vehicle.turn_radius_m);
        let direction = ahead - place;
        (ConnectionStart::Pose(Pose { place, direction }), replaced_m)
    };
    let flown = connections_between(vehicle, start, end);
    flown.first().map_or(free, |flown| LegManoeuvres {
        turns_m: free.turns_m + flown.length_m + arrival.lead_m - replaced_m,
        arrival: arrival.direction,
        ..free
    })
}

/// The turn from the start of a leg to a place, as seen from above.
fn turn(
    vehicle: &Vehicle,
    from: Option<UnderWay>,
    first: Point3<f64>,
    aim: Point3<f64>,
) -> LevelWay {
    shortest_level(vehicle, begins(from, first), aim)
}

/// How a leg begins.
fn begins(from: Option<UnderWay>, first: Point3<f64>) -> ConnectionStart {
    from.map_or(ConnectionStart::Place(first), |from| {
        ConnectionStart::Pose(Pose {
            place: from.place,
            direction: from.velocity,
        })
    })
}

/// How much longer than a way of `length_m` seen from above a way must be for a change of depth, metres; 0
/// where it is long enough. A vehicle with a turn radius takes a little more until it is pitched.
fn stretched_m(vehicle: &Vehicle, length_m: f64, rise_m: f64) -> f64 {
    let pitch_rad = vehicle.max_pitch_rad.min(STEEPEST_RAD);
    if vehicle.max_pitch_rad >= FRAC_PI_2 || rise_m == 0.0 {
        return 0.0;
    }
    let way_m = libm::hypot(length_m, rise_m);
    let steep_m = rise_m.abs() / libm::sin(pitch_rad);
    if steep_m <= way_m * (1.0 + 1e-9) {
        return 0.0;
    }
    steep_m + vehicle.turn_radius_m * libm::tan(0.5 * pitch_rad) - way_m
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
