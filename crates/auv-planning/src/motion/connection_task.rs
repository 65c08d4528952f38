//! Solves for the connections of each kind: a level curve, made longer where its change of depth needs that.

use super::curve::{Goal, KINDS, Lengthening, LevelCurve, curves, heading_of, lengthened};
use super::curve_points::{sampled, without_straight_points};
use super::descent::{Descent, EndSlopes};
use super::pose::{ConnectionEnd, ConnectionStart, Pose};
use crate::Vehicle;
use auv_types::{Point3, Vector3, libm};
use std::f64::consts::TAU;

/// Circles of a vehicle that turns on the spot have this radius, metres.
const LEAST_RADIUS_M: f64 = 5.0;
/// Radii that are tried, in turn radii. A vehicle that turns as tightly as it can has little left to pitch.
pub(super) const RADII: [f64; 3] = [1.0005, 1.03, 1.08];
/// The share of the steepest slope that is used: rounding must not exceed it.
const SLOPE_SHARE: f64 = 1.0 - 1e-6;
/// A pitch limit above this is none, radians. No slope that is used is steeper.
pub(crate) const STEEPEST_RAD: f64 = 1.5;
/// Tries to make a curve long enough for its change of depth, and the most circles it may get.
const TRIES: usize = 6;
const MOST_CIRCLES: f64 = 200.0;
/// Chords are shorter than their arcs by at most this share.
const CHORD_LOSS: f64 = 1.2e-3;
/// A direction shorter than this is none.
const LEAST_DIRECTION: f64 = 1e-6;
/// Two places closer than this are one, metres.
const SAME_PLACE_M: f64 = 1e-6;

/// A polyline that the vehicle can fly in still water.
#[derive(Clone, Debug, PartialEq)]
pub struct Connection {
    /// Which turns it makes; connections to other places have the same turns by the same number.
    pub kind: usize,
    /// Its points, at most a chord error of [`crate::Trajectory::CHORD_ERROR_M`] off the curve.
    pub points: Vec<Point3<f64>>,
    /// The first point on the straight that it ends with, if it does.
    pub straight_from: Option<usize>,
    /// Its length, metres.
    pub length_m: f64,
}

/// What is to be connected.
pub(super) struct Task<'a> {
    vehicle: &'a Vehicle,
    pub(super) from: Point3<f64>,
    /// The direction flown at the start, if it binds.
    pub(super) direction: Option<Vector3<f64>>,
    pub(super) heading: f64,
    to: Point3<f64>,
    pub(super) goal: Goal,
    ends: EndSlopes,
    pub(super) radius_m: f64,
    steepest: f64,
}

impl<'a> Task<'a> {
    pub(super) fn new(vehicle: &'a Vehicle, from: ConnectionStart, to: ConnectionEnd) -> Self {
        let turns = vehicle.turn_radius_m > 0.0;
        let binds = |direction: &Vector3<f64>| turns && direction.norm() > LEAST_DIRECTION;
        let pose_of = |pose: Pose| (pose.place, Some(pose.direction).filter(binds));
        let (start, direction) = match from {
            ConnectionStart::Pose(pose) => pose_of(pose),
            ConnectionStart::Place(place) => (place, None),
        };
        let (place, arrival) = match to {
            ConnectionEnd::Pose(pose) => pose_of(pose),
            ConnectionEnd::Place(place) => (place, None),
        };
        let steepest = libm::tan(vehicle.max_pitch_rad.min(STEEPEST_RAD)) * SLOPE_SHARE;
        let slope = |direction: Vector3<f64>| slope_of(&direction).clamp(-steepest, steepest);
        Self {
            vehicle,
            from: start,
            direction,
            heading: heading_of(&direction.unwrap_or(place - start)),
            to: place,
            goal: Goal {
                place,
                heading: arrival.map(|arrival| heading_of(&arrival)),
            },
            ends: EndSlopes {
                start: direction.map(slope),
                end: arrival.map(slope),
            },
            radius_m: if turns {
                vehicle.turn_radius_m
            } else {
                LEAST_RADIUS_M
            },
            steepest,
        }
    }

    fn dive_m(&self) -> f64 {
        self.to.z - self.from.z
    }

    /// The straight line, where neither a direction nor the pitch forbids it.
    pub(super) fn straight(&self) -> Option<Connection> {
        if self.direction.is_some() || self.goal.heading.is_some() {
            return None;
        }
        let line = self.to - self.from;
        let flat_enough = self.vehicle.max_pitch_rad >= STEEPEST_RAD
            || line.z.abs() <= self.steepest * line.xy().norm();
        flat_enough.then(|| Connection {
            kind: KINDS,
            points: vec![self.from, self.to],
            straight_from: Some(0),
            length_m: line.norm(),
        })
    }

    /// The shortest connections of a kind. Where it is too short for the change of depth: for each way to
    /// make it longer, since one may need room that is not there.
    pub(super) fn of_kind(&self, kind: usize) -> Vec<Connection> {
        let level = self.dive_m() == 0.0 && self.ends.start.is_none_or(|slope| slope == 0.0);
        let radii = if level { &RADII[..1] } else { &RADII[..] };
        let bare =
            |wider: &f64| curves(self.from, self.heading, &self.goal, wider * self.radius_m)[kind];
        let bare: Vec<LevelCurve> = radii.iter().filter_map(bare).collect();
        let shortest = |lengthening: Option<Lengthening>| {
            let mut best: Option<Connection> = None;
            for curve in &bare {
                // No polyline along it is shorter than the curve as seen from above, less the chords.
                let least_m = curve.length_m() * (1.0 - CHORD_LOSS);
                if best.as_ref().is_some_and(|best| best.length_m < least_m) {
                    continue;
                }
                if let Some(found) = self.flown(kind, curve, lengthening)
                    && best
                        .as_ref()
                        .is_none_or(|best| found.length_m < best.length_m)
                {
                    best = Some(found);
                }
            }
            best
        };
        if let Some(found) = shortest(None) {
            return vec![found];
        }
        let ways = [Lengthening::Ahead, Lengthening::Aside, Lengthening::Circles];
        ways.into_iter()
            .filter_map(|way| shortest(Some(way)))
            .collect()
    }

    /// A connection along a curve of a kind, made longer if it needs to be and may.
    fn flown(
        &self,
        kind: usize,
        bare: &LevelCurve,
        longer: Option<Lengthening>,
    ) -> Option<Connection> {
        let radius_m = bare.radius_m;
        let side = if self.dive_m() < 0.0 { -1.0 } else { 1.0 };
        let most_m = MOST_CIRCLES * TAU * radius_m + bare.length_m();
        let mut curve = *bare;
        for _ in 0..TRIES {
            let mut points = sampled(&curve, self.blend_m());
            let limit_m = self.vehicle.turn_radius_m;
            let descent = Descent::new(&points, self.direction, limit_m, self.steepest);
            let reach_m = descent.most_m(self.ends, side);
            if reach_m.is_some_and(|reach_m| reach_m >= self.dive_m().abs())
                && let Some(slopes) = descent.steady(self.ends, self.dive_m())
            {
                descent.apply(&slopes, &mut points);
                return Some(self.finished(kind, &curve, &points));
            }
            let short_m = reach_m.map_or(radius_m, |reach_m| self.dive_m().abs() - reach_m);
            let longer_m = short_m.max(SAME_PLACE_M) / self.steepest + SAME_PLACE_M;
            let length_m = curve.length_m() + longer_m;
            if length_m > most_m {
                return None;
            }
            let how = (longer?, 0.5 * self.blend_m());
            curve = lengthened(bare, kind, &self.goal, length_m, how)?;
        }
        None
    }

    /// The distance over which the pitch can change from one limit to the other on a straight, metres.
    fn blend_m(&self) -> f64 {
        2.2 * self.vehicle.turn_radius_m * self.vehicle.max_pitch_rad.min(STEEPEST_RAD)
    }

    fn finished(&self, kind: usize, curve: &LevelCurve, points: &[Point3<f64>]) -> Connection {
        let mut points = without_straight_points(points);
        // Rounding of the turns must not move the end.
        if let Some(last) = points.last_mut() {
            *last = self.to;
        }
        let begins_m = curve.last_straight_m();
        let straight_from = begins_m.and_then(|begins_m| {
            let mut gone_m = 0.0;
            points.windows(2).position(|pair| {
                let before_m = gone_m;
                gone_m += (pair[1] - pair[0]).xy().norm();
                before_m >= begins_m - CHORD_LOSS * before_m
            })
        });
        let length_m = points.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        Connection {
            kind,
            points,
            straight_from,
            length_m,
        }
    }
}

/// Depth gained per horizontal metre along a direction; 0 for a vertical one.
fn slope_of(direction: &Vector3<f64>) -> f64 {
    let across = direction.xy().norm();
    if across > 1e-6 {
        direction.z / across
    } else {
        0.0
    }
}
