//! A mission stopped after any event, saved, and resumed with the same decisions.

use crate::fingerprint::{self, Fnv};
use crate::synchroniser::{Phase, RouteFrom, State};
use crate::{Acceptance, Mission, SyncSettings, Synchroniser, here};
use auv_graph::NodeId;
use auv_obstacles::TimedPoint;
use auv_types::{Seed, Violations};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use thiserror::Error;

/// Everything a synchroniser knows besides its mission: plain data, saved after an event.
///
/// [`Checkpoint::to_text`] is the form to store: a checksum stands before it, so that a damaged file
/// is never resumed. Any serde format that keeps every bit of a number works as well.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checkpoint {
    version: u32,
    mission: u64,
    settings: SyncSettings,
    seed: Seed,
    state: State,
}

/// Why a checkpoint was not resumed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ResumeError {
    /// The text is not a whole, undamaged checkpoint.
    #[error("the checkpoint is damaged: {0}; take an older one")]
    Damaged(String),
    /// It was written by another version of this library.
    #[error(
        "the checkpoint has version {found}; this library reads version {}",
        Checkpoint::VERSION
    )]
    Version {
        /// The version found.
        found: u32,
    },
    /// It belongs to another mission: network, times, vehicle, chart or forecast differ.
    #[error(
        "the checkpoint belongs to another mission (fingerprint {found:016x}, this one has {expected:016x})"
    )]
    WrongMission {
        /// Fingerprint in the checkpoint.
        found: u64,
        /// Fingerprint of the mission given.
        expected: u64,
    },
    /// The mission itself, or the settings in the checkpoint, cannot be flown.
    #[error("the mission cannot be flown: {0}")]
    Invalid(Violations),
    /// Its parts contradict each other or the mission.
    #[error("the checkpoint is inconsistent: {0}")]
    Inconsistent(Violations),
}

impl Checkpoint {
    /// Version of the format.
    pub const VERSION: u32 = 1;

    const HEADER: &'static str = "auv-checkpoint";

    /// The checkpoint as two lines of text: version and checksum, and the data in JSON.
    ///
    /// # Errors
    /// [`ResumeError::Damaged`] when the data cannot be written as JSON (it always can).
    pub fn to_text(&self) -> Result<String, ResumeError> {
        let data = serde_json::to_string(self).map_err(|e| ResumeError::Damaged(e.to_string()))?;
        let (version, sum) = (self.version, checksum(&data));
        Ok(format!("{} {version} {sum:016x}\n{data}\n", Self::HEADER))
    }

    /// Reads what [`Checkpoint::to_text`] wrote.
    ///
    /// # Errors
    /// [`ResumeError::Damaged`] for anything that is not exactly such a text,
    /// [`ResumeError::Version`] for one of another version.
    pub fn from_text(text: &str) -> Result<Self, ResumeError> {
        let damaged = |what: &str| ResumeError::Damaged(what.to_owned());
        let (header, rest) = text
            .split_once('\n')
            .ok_or_else(|| damaged("it is cut short"))?;
        let data = rest
            .strip_suffix('\n')
            .ok_or_else(|| damaged("it is cut short"))?;
        let words: Vec<&str> = header.split(' ').collect();
        let [Self::HEADER, version, sum] = words[..] else {
            return Err(damaged("its first line is not that of a checkpoint"));
        };
        if sum != format!("{:016x}", checksum(data)) {
            return Err(damaged("its checksum does not match"));
        }
        let found = version
            .parse()
            .map_err(|_| damaged("its version is no number"))?;
        if found != Self::VERSION {
            return Err(ResumeError::Version { found });
        }
        serde_json::from_str(data).map_err(|e| ResumeError::Damaged(e.to_string()))
    }
}

fn checksum(data: &str) -> u64 {
    let mut hash = Fnv::new();
    hash.bytes(data.as_bytes());
    hash.finish()
}

impl Synchroniser {
    /// What is needed to go on from here after a restart. Save it after an event was taken in.
    #[must_use]
    pub fn save(&self) -> Checkpoint {
        Checkpoint {
            version: Checkpoint::VERSION,
            mission: fingerprint::of(&self.mission),
            settings: self.settings.clone(),
            seed: self.seed,
            state: self.state.clone(),
        }
    }

    /// A synchroniser that goes on where the checkpoint was saved, with the same decisions.
    ///
    /// Commands that were not carried out before the stop are not given again: follow
    /// [`Synchroniser::trajectory`], answer [`Synchroniser::outstanding`], look at
    /// [`Synchroniser::outcome`].
    ///
    /// # Errors
    /// Another version or another mission; settings out of range; a state whose parts do not fit
    /// each other: unknown waypoints, a route that is not connected, numbers that no mission has.
    pub fn resume(mission: Arc<Mission>, checkpoint: Checkpoint) -> Result<Self, ResumeError> {
        let Checkpoint {
            version,
            mission: found,
            settings,
            seed,
            state,
        } = checkpoint;
        if version != Checkpoint::VERSION {
            return Err(ResumeError::Version { found: version });
        }
        let mut invalid = mission.validate();
        invalid.absorb("settings.", settings.validate());
        invalid.into_result().map_err(ResumeError::Invalid)?;
        let expected = fingerprint::of(&mission);
        if found != expected {
            return Err(ResumeError::WrongMission { found, expected });
        }
        let scripted = settings.acceptance == Acceptance::AsClaimed;
        inconsistencies(&mission, scripted, &state)
            .into_result()
            .map_err(ResumeError::Inconsistent)?;
        let leg = state.leg.as_ref();
        let since_s = leg.map_or(mission.launch_s, |leg| leg.started_s);
        let home_s = here::home_times_s(&mission, since_s);
        Ok(Self {
            mission,
            settings,
            seed,
            home_s,
            state,
        })
    }
}

/// Everything that keeps a state from being one of this mission.
fn inconsistencies(mission: &Mission, scripted: bool, state: &State) -> Violations {
    let mut wrong = Violations::new();
    let is_node = |node: &NodeId| mission.network.has_node(*node);
    // The vehicle's own place counts as a waypoint where a leg begins there.
    let is_place = |node: &NodeId| node.index() <= mission.network.num_nodes();
    let finite = [
        state.started_s,
        state.now_s,
        state.fixed_s,
        state.altitude_s.unwrap_or(0.0),
        state.charged_s,
        state.weight,
    ];
    let moving = state.position.iter().chain(state.velocity.iter());
    wrong.require(finite.iter().chain(moving).all(plausible), "state", || {
        "has times, place or weight that no mission has".into()
    });
    // A measured battery may have any number of joules.
    wrong.require(state.used_j.is_finite(), "state", || {
        "has used energy that is no number".into()
    });
    wrong.require(
        state.started_s <= state.now_s
            && state.fixed_s <= state.now_s
            && state.charged_s >= 0.0
            && state.weight >= 0.0,
        "state",
        || "has times or a weight below zero".into(),
    );
    for (i, region) in state.regions.iter().enumerate() {
        region.validate_into(&format!("regions[{i}]"), &mut wrong);
    }
    let ends = [state.visited.first(), state.visited.last()];
    wrong.require(
        ends == [Some(&mission.start), Some(&state.at)] && state.visited.iter().all(is_node),
        "visited",
        || "does not lead from the start to the last waypoint reached".into(),
    );
    let edges = mission.network.num_edges();
    wrong.require(
        state.removed.iter().all(|edge| edge.index() < edges),
        "removed",
        || format!("names an edge beyond the {edges} there are"),
    );
    let legs = state
        .path_calls
        .iter()
        .filter(|call| call.completed)
        .count();
    wrong.require(
        state.visited.len() == legs + 1 && state.tasks <= legs,
        "tasks",
        || format!("does not fit the {legs} legs completed"),
    );
    let tables_known = state
        .path_calls
        .iter()
        .all(|c| is_place(&c.from) && is_node(&c.to))
        && state
            .route_calls
            .iter()
            .all(|c| is_place(&c.start) && c.route.iter().all(is_place));
    wrong.require(tables_known, "tables", || "name unknown waypoints".into());
    let mut points = state.in_force.iter().flat_map(|way| way.points());
    let possible = |p: &TimedPoint| p.position.iter().chain([&p.time_s]).all(plausible);
    wrong.require(points.all(possible), "in_force", || {
        "leads where no mission does".into()
    });
    check_phase(mission, scripted, state, &mut wrong);
    wrong
}

/// A number that occurs: finite, and no longer, further or faster than any mission.
fn plausible(value: &f64) -> bool {
    value.abs() <= 1e9
}

/// What each phase needs: a leg and a route to fly, a request that was made.
fn check_phase(mission: &Mission, scripted: bool, state: &State, wrong: &mut Violations) {
    let known = |request: u64| request < state.next_request;
    match state.phase {
        Phase::Ready => wrong.require(state.next_request == 0, "phase", || {
            "is before the start of a mission that has begun".into()
        }),
        Phase::Routing { request, from, .. } => {
            wrong.require(known(request), "phase", || {
                format!("waits for request {request}, which was never made")
            });
            let has_leg = from != RouteFrom::Target || state.leg.is_some();
            wrong.require(has_leg, "leg", || "is missing in flight".into());
        }
        Phase::Flying => {
            wrong.require(state.leg.is_some(), "leg", || "is missing in flight".into());
        }
        Phase::Falling(_) | Phase::Finished(_) => {}
    }
    if let Some(leg) = &state.leg {
        let numbers = [
            leg.started_s,
            leg.charged_s,
            leg.booked_s,
            leg.task_left_s,
            leg.waited_s,
            leg.asked_s,
        ];
        let departure = &leg.departure;
        let others = [leg.stays_from_s.unwrap_or(0.0), departure.place.time_s];
        let moving = departure
            .place
            .position
            .iter()
            .chain(departure.velocity.iter())
            .chain(departure.stand_off.iter().flat_map(|p| p.iter()));
        wrong.require(
            numbers.iter().chain(&others).chain(moving).all(plausible),
            "leg",
            || "has times that no mission has".into(),
        );
        let past = [leg.started_s, leg.booked_s, leg.asked_s];
        wrong.require(past.iter().all(|&s| s <= state.now_s), "leg", || {
            "has times after the last tick".into()
        });
        let arc = mission.network.arc_between(leg.from, leg.to);
        let edge = arc.map(|arc| mission.network.arcs()[arc.index()].edge);
        let task_s = edge.map_or(0.0, |edge| mission.network.task(edge).completion_time_s);
        wrong.require((0.0..=task_s).contains(&leg.task_left_s), "leg", || {
            format!("has {} s of a task of {task_s} s to do", leg.task_left_s)
        });
        let on_route = state.route.len() >= 2 && state.route[..2] == [leg.from, leg.to];
        wrong.require(on_route && edge == leg.edge, "leg", || {
            "is not the first of the route".into()
        });
        wrong.require(leg.pending.is_none_or(known), "leg", || {
            "waits for a path that was never asked for".into()
        });
        wrong.require(
            leg.pending.is_some() || state.in_force.is_some(),
            "leg",
            || "has no trajectory and waits for none".into(),
        );
    }
    let here = NodeId(mission.network.num_nodes() as u32);
    let connected = state.route.windows(2).enumerate().all(|(i, pair)| {
        let straight = state.homeward || scripted || (i == 0 && pair[0] == here);
        let known = mission.network.has_node(pair[1])
            && (mission.network.has_node(pair[0]) || (i == 0 && pair[0] == here));
        known && (straight || mission.network.arc_between(pair[0], pair[1]).is_some())
    });
    let over = matches!(state.phase, Phase::Finished(_));
    let whole = state.route.is_empty()
        || over
        || (state.route.len() >= 2
            && (scripted || state.route.last() == Some(&mission.destination)));
    wrong.require(connected && whole, "route", || {
        "is not connected or does not lead to the destination".into()
    });
}
