//! A mission is stopped after any event, saved, and resumed with the same decisions.

use crate::consistency;
use crate::fingerprint::{self, Fnv};
use crate::state::State;
use crate::{Mission, SyncSettings, Synchroniser};
use auv_types::{Seed, Violations};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use thiserror::Error;

/// Everything a synchroniser knows, except its mission: plain data, saved after an event.
///
/// Store the text of [`Checkpoint::to_text`]: it starts with a checksum, so that a damaged file is never
/// resumed. Any serde format that keeps every bit of a number works as well.
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
    pub const VERSION: u32 = 2;

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
            .map_err(|_| damaged("its version is not a number"))?;
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
    /// Everything needed to resume from here. Call it after [`Synchroniser::step`].
    #[must_use]
    pub fn save(&self) -> Checkpoint {
        let view = self.view();
        Checkpoint {
            version: Checkpoint::VERSION,
            mission: fingerprint::of(self.mission()),
            settings: view.settings.clone(),
            seed: view.seed,
            state: view.state.clone(),
        }
    }

    /// A synchroniser that goes on where the checkpoint was saved, with the same decisions.
    ///
    /// Commands that were not carried out before the stop are not given again: follow
    /// [`Synchroniser::trajectory`], answer [`Synchroniser::outstanding`], and check
    /// [`Synchroniser::outcome`].
    ///
    /// # Errors
    /// Another version or another mission; settings out of range; a state whose parts do not fit
    /// each other: unknown waypoints, a route that is not connected, numbers out of range.
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
        consistency::check(&mission, &state)
            .into_result()
            .map_err(ResumeError::Inconsistent)?;
        Ok(Self::with_state(mission, settings, seed, state))
    }
}
