//! What the summaries read from a line.

use crate::origin::Origin;
use crate::run_list::Run;
use auv_sim::{LimitBroken, MissionOutcome};
use serde::Deserialize;

/// The part of a line that summaries need. A campaign is summed up from its lines, so that joined parts
/// give the same summary as one process.
#[derive(Deserialize)]
pub(crate) struct Facts {
    pub(crate) mission: u64,
    pub(crate) seed: Option<u64>,
    /// Why the mission could not be flown.
    pub(crate) error: Option<String>,
    pub(crate) outcome: Option<MissionOutcome>,
    pub(crate) reason: Option<String>,
    /// Missing where a mission was refused before the start.
    pub(crate) reason_code: Option<String>,
    pub(crate) remaining_s: Option<f64>,
    pub(crate) mission_weight: Option<f64>,
    /// The limits that the true track broke.
    #[serde(default)]
    pub(crate) limits_broken: Vec<LimitBroken>,
    #[serde(default)]
    faults: Vec<String>,
    intensity: Option<u8>,
    /// The letter of the response to a fault.
    pub(crate) class: Option<char>,
    #[serde(default)]
    pub(crate) failures: Vec<String>,
    pub(crate) unavoidable_by_s: Option<f64>,
}

impl Facts {
    /// Reads a line.
    pub(crate) fn read(line: &str) -> Result<Self, String> {
        serde_json::from_str(line).map_err(|error| format!("is not a line of a campaign ({error})"))
    }

    /// How the mission ended, unless it was not flown at all.
    pub(crate) fn flown(&self) -> Option<MissionOutcome> {
        self.outcome.filter(|_| self.reason_code.is_some())
    }

    /// Refuses a line of another run, and one without the values that summaries need.
    pub(crate) fn check(&self, run: Run<'_>, origin: &Origin) -> Result<(), String> {
        if self.mission != run.mission {
            let (is, should) = (self.mission, run.mission);
            return Err(format!("is mission {is} and should be mission {should}"));
        }
        if self.error.is_some() {
            return Ok(());
        }
        let seed = origin.seed_of(run.mission);
        if self.seed != Some(seed) {
            let has = self.seed.map_or("none".into(), |seed| seed.to_string());
            return Err(format!("has seed {has} and should have seed {seed}"));
        }
        let names = run.kind.map_or(Vec::new(), |kind| kind.names());
        let degree = run.kind.map(|kind| kind.intensity.degree());
        if self.faults != names || self.intensity != degree {
            return Err("has other faults than the campaign".into());
        }
        let complete = self.outcome.is_some() && (run.kind.is_none() || self.class.is_some());
        if complete {
            Ok(())
        } else {
            Err("lacks its outcome".into())
        }
    }
}
