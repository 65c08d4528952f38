//! What to do when the mission has to be given up away from its destination.
//!
//! While a way home is left, the mission goes home by the quickest one: that is no contingency, it
//! docks. The ladder begins where no way leads there, or the time has run out far beyond the budget.

use crate::stay::{level_heading, stays};
use crate::synchroniser::Phase;
use crate::{AbortReason, Command, Outcome, Synchroniser, check, reflex};
use auv_planning::polyline::rounded;
use auv_planning::{PathProblem, Trajectory};
use auv_types::{Point3, Vector3, libm};
use std::fmt;

/// A rung of the ladder. Each is flown only along a trajectory that the vehicle can fly and that is
/// clear of everything predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Contingency {
    /// Up to the top of the box, or to the surface where there is no box: straight up, or on a helix.
    Surface,
    /// Back to the start through the waypoints already reached: water known to be free.
    ReturnAlongTrack,
    /// Stay here, hovering or on a circle.
    Loiter {
        /// For how long, seconds: at most [`Contingency::LONGEST_S`].
        for_s: f64,
    },
}

/// A contingency under way.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Fall {
    pub(crate) reason: AbortReason,
    /// How often a way was sought again because the one in force was not clear any more.
    pub(crate) sought: u32,
}

/// Ways are sought again so often at most.
const MOST_SOUGHT: u32 = 50;

/// Corrections of the turn onto a line.
const TURN_CORRECTIONS: u32 = 10;

impl Contingency {
    /// The default ladder: surface; where that is not clear, loiter for an hour.
    pub const LADDER: [Self; 2] = [Self::Surface, Self::Loiter { for_s: 3600.0 }];
    /// The longest loiter, seconds: circles are held in memory as they are to be flown.
    pub const LONGEST_S: f64 = 604_800.0;
}

impl fmt::Display for Contingency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Surface => "surfaced",
            Self::ReturnAlongTrack => "returned along the track",
            Self::Loiter { .. } => "loitered",
        })
    }
}

impl Synchroniser {
    /// Gives the mission up: the first rung of the ladder that can be flown is.
    pub(crate) fn abort(&mut self, reason: AbortReason, commands: &mut Vec<Command>) {
        self.state.leg = None;
        self.fall(Fall { reason, sought: 0 }, commands);
    }

    /// A tick on the way down the ladder.
    pub(crate) fn keep_falling(&mut self, fall: Fall, commands: &mut Vec<Command>) {
        let on_a_rung = self.state.contingency.is_some();
        if on_a_rung && self.in_force_is_over() {
            return self.finish(Outcome::Aborted(fall.reason), commands);
        }
        if self.in_force_is_over() || !self.in_force_is_clear() {
            let sought = fall.sought.saturating_add(1);
            self.fall(Fall { sought, ..fall }, commands);
        }
    }

    /// The first rung that can be flown; while none can, out of the way for a moment.
    fn fall(&mut self, fall: Fall, commands: &mut Vec<Command>) {
        let rungs = &self.mission.contingencies;
        let rung = rungs
            .iter()
            .find_map(|&rung| Some((Some(rung), self.way_of(rung)?)));
        let chosen = rung.or_else(|| {
            if rungs.is_empty() {
                return None;
            }
            let request = self.bare_problem_request();
            let for_s = self.settings.retry_s;
            let way = reflex::evade(&request.problem(), self.state.velocity, for_s)?;
            Some((None, way))
        });
        match chosen {
            Some((rung, way)) if fall.sought <= MOST_SOUGHT => {
                self.state.contingency = rung;
                self.state.phase = Phase::Falling(fall);
                self.follow(way, commands);
            }
            _ => self.finish(Outcome::Aborted(fall.reason), commands),
        }
    }

    /// A verified way of a rung from here, if there is one.
    fn way_of(&self, rung: Contingency) -> Option<Trajectory> {
        let request = self.bare_problem_request();
        let problem = request.problem();
        let here = self.here();
        let velocity = self.state.velocity;
        let candidates: Vec<Trajectory> = match rung {
            Contingency::Surface => {
                let top_m = self.mission.bounds.map_or(0.0, |bounds| bounds.low.z);
                [1.0, -1.0, 2.0, -2.0]
                    .iter()
                    .filter_map(|side| {
                        problem
                            .timed(&ascent(&problem, velocity, top_m, *side))
                            .ok()
                    })
                    .collect()
            }
            Contingency::ReturnAlongTrack => self
                .tracks_back()
                .iter()
                .filter_map(|points| problem.timed(points).ok())
                .collect(),
            Contingency::Loiter { for_s } => stays(&problem, here, velocity, for_s),
        };
        let until_s = here.time_s + self.settings.lookahead_s;
        candidates
            .into_iter()
            .find(|way| self.is_clear(way, until_s, 0.0) && check::is_flyable(&problem, way))
    }

    /// From here through the waypoints reached, last first, to the start; begun by a turn to either
    /// side.
    fn tracks_back(&self) -> Vec<Vec<Point3<f64>>> {
        let mut back = Vec::new();
        let mut later = None;
        for &node in self.state.visited.iter().rev() {
            let arc = later.and_then(|later| self.mission.network.arc_between(node, later));
            let guide = arc.and_then(|arc| self.mission.guides.get(&arc));
            back.extend(guide.into_iter().flat_map(|way| way.iter().rev().copied()));
            back.push(self.mission.position_of(node));
            later = Some(node);
        }
        let turn_m = self.mission.vehicle.turn_radius_m;
        let (here, velocity) = (self.state.position, self.state.velocity);
        let from = |side: f64| {
            let mut points = vec![here];
            if turn_m > 0.0 && velocity.norm() > 0.0 {
                // The turn ends on the line to the next point: found by a few corrections.
                let mut turned = here;
                for _ in 0..TURN_CORRECTIONS {
                    let direction = back[0] - turned;
                    points.truncate(1);
                    points.extend(reflex::turn_towards(
                        here,
                        velocity,
                        &direction,
                        side * turn_m,
                    ));
                    turned = points[points.len() - 1];
                }
            }
            // Level for a moment, so that a climb or dive can set in gently.
            let end = points[points.len() - 1];
            let level = level_heading(&(back[0] - end)) * turn_m;
            let corners: Vec<_> = [end, end + level].into_iter().chain(back.clone()).collect();
            points.extend(rounded(&corners, turn_m).into_iter().skip(1));
            points
        };
        vec![from(1.0), from(-1.0)]
    }
}

/// Up to a depth: straight up for a vehicle that can, else on a helix to the right (positive side) or
/// left, whose slope sets in and ends gently.
fn ascent(
    problem: &PathProblem<'_>,
    velocity: Vector3<f64>,
    top_m: f64,
    side: f64,
) -> Vec<Point3<f64>> {
    let start = problem.start;
    let rise_m = (start.z - top_m).max(0.0);
    let vehicle = problem.vehicle;
    if vehicle.turn_radius_m <= 0.0 && vehicle.max_pitch_rad >= std::f64::consts::FRAC_PI_2 {
        return vec![start, start - Vector3::z() * rise_m];
    }
    let radius_m = 1.5 * vehicle.turn_radius_m.max(5.0) * side.abs();
    // With the slope a raised cosine over the way, the steepest part is twice the mean.
    let slope = libm::tan(0.9 * vehicle.max_pitch_rad.min(1.0));
    let length_m = (2.0 * rise_m / slope).max(4.0 * radius_m);
    let heading = level_heading(&velocity);
    let right = Vector3::new(-heading.y, heading.x, 0.0) * side.signum();
    let count = (length_m / (0.1 * radius_m)).ceil().max(1.0);
    (0..=count as usize)
        .map(|k| {
            let share = k as f64 / count;
            let angle_rad = share * length_m / radius_m;
            let turn = std::f64::consts::TAU * share;
            let risen_m = rise_m * (share - libm::sin(turn) / std::f64::consts::TAU);
            start
                + right * (radius_m * (1.0 - libm::cos(angle_rad)))
                + heading * (radius_m * libm::sin(angle_rad))
                - Vector3::z() * risen_m
        })
        .collect()
}
