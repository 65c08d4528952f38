//! One mission flown and judged.

use crate::CoastalMission;
use crate::other_bed::OtherBed;
use auv_examples::Clock;
use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::{Log, MissionOutcome, Scenario, Summary, simulate};
use auv_types::Seed;
use serde_json::{Value, json};

/// A mission and how it went.
pub(crate) struct Flight {
    pub(crate) mission: CoastalMission,
    /// The summary and the log's hash, or why the mission was refused.
    pub(crate) flown: Result<(Summary, String), String>,
    /// Computing time of the flight, milliseconds; the scenario's is not in it.
    pub(crate) elapsed_ms: f64,
}

impl Flight {
    /// Flies a mission as `mission --seed S` flies its file, over another bed.
    pub(crate) fn fly(mission: CoastalMission, bed: OtherBed, seed: Seed) -> Self {
        let clock = Clock::start();
        let scenario = scenario(&mission, seed);
        let built_ms = clock.elapsed_ms();
        let flown = scenario.and_then(|mut scenario| {
            bed.put_under(&mission, &mut scenario);
            let routes = GaRoute::new(GaSettings::default());
            let paths = PsoPath::new(PathSearch::default());
            let driver = Stepped::new(&routes, &paths);
            let mut log = Log::hash_only();
            let summary = simulate(&scenario, &driver, &mut log);
            let summary = summary.map_err(|error| error.to_string())?;
            Ok((summary, log.sha256()))
        });
        Self {
            mission,
            flown,
            elapsed_ms: clock.elapsed_ms() - built_ms,
        }
    }

    /// How it ended; `None` if it was refused.
    pub(crate) fn outcome(&self) -> Option<MissionOutcome> {
        self.flown.as_ref().ok().map(|(summary, _)| summary.outcome)
    }

    /// The flight as a JSON line.
    pub(crate) fn line(&self) -> Value {
        let traits = self.mission.traits();
        let mut line = json!({
            "mission": self.mission.number,
            "seed": self.mission.seed.0,
            "landscape": traits.landscape.as_str(),
            "empty": traits.empty,
            "at_limit": traits.at_limit,
            "slope_at_limit_deg": traits.slope_at_limit_deg,
        });
        let more = match &self.flown {
            Err(reason) => json!({ "outcome": "refused", "reason": reason }),
            Ok((summary, log_sha256)) => {
                let judgement = &summary.judgement;
                json!({
                    "outcome": summary.outcome,
                    "reason": summary.reason.to_string(),
                    "collisions": judgement.collisions,
                    "groundings": judgement.groundings,
                    "limits_broken": judgement.limits_broken,
                    "min_altitude_m": judgement.min_altitude_m,
                    "time_s": summary.time_s,
                    "remaining_s": summary.remaining_s,
                    "mission_weight": summary.mission_weight,
                    "tasks": summary.tasks,
                    "climbs": summary.climbs,
                    "raised": summary.raised.len(),
                    "route_calls": summary.route_calls.len(),
                    "path_calls": summary.path_calls.len(),
                    "elapsed_ms": self.elapsed_ms,
                    "log_sha256": log_sha256,
                })
            }
        };
        if let (Some(line), Value::Object(more)) = (line.as_object_mut(), more) {
            line.extend(more);
        }
        line
    }
}

/// The scenario that the mission's file describes.
fn scenario(mission: &CoastalMission, seed: Seed) -> Result<Scenario, String> {
    let file = MissionFile::from_toml(&mission.to_toml()).map_err(|error| error.to_string())?;
    let scenario = file.scenario(&MissionData::default(), seed);
    scenario.map_err(|error| error.to_string())
}
