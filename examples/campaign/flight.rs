//! How a run of a campaign is flown.

use crate::faults;
use crate::fleet::Fleet;
use crate::line::line;
use crate::run_list::RunList;
use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_report::MissionPicture;
use auv_sim::{Log, Recorder, Summary, simulate};
use serde_json::{Value, json};

/// The runs of a campaign and what they fly.
pub(crate) struct Flight {
    pub(crate) fleet: Fleet,
    pub(crate) list: RunList,
    /// Whether every mission is flown twice.
    pub(crate) doublecheck: bool,
}

impl Flight {
    /// Flies run `i` and gives its line, without the end of line.
    pub(crate) fn fly(&self, i: u64) -> String {
        let run = self.list.run(i);
        let line = match run.kind {
            Some(kind) => faults::fly(&self.fleet, run.mission, kind, self.doublecheck),
            None => self.mission(run.mission),
        };
        line.to_string()
    }

    /// Flies run `i` for its replay.
    pub(crate) fn watch(&self, i: u64, picture: &mut MissionPicture) -> Result<(), String> {
        let run = self.list.run(i);
        let Some(kind) = run.kind else {
            return watch(&self.fleet, run.mission, picture).map(|_| ());
        };
        let names = kind.names().join(", ");
        picture.note(format!("Faults: {names}, {}.", kind.intensity));
        faults::watch(&self.fleet, run.mission, kind, picture).map(|_| ())
    }

    fn mission(&self, k: u64) -> Value {
        let line = fly_once(&self.fleet, k);
        if self.doublecheck && fly_once(&self.fleet, k) != line {
            return json!({ "mission": k, "error": "flown twice, the logs differ" });
        }
        line
    }
}

fn fly_once(fleet: &Fleet, k: u64) -> Value {
    let mut log = Log::hash_only();
    let seed = fleet.origin().seed_of(k);
    match watch(fleet, k, &mut log) {
        Ok(summary) => {
            let mut flown = line((k, seed), &summary, &log.sha256(), &[]);
            let unavoidable_s = match fleet {
                Fleet::File { .. } => unavoidable_s(fleet, k, &summary),
                Fleet::Table2(_) => None,
            };
            if let (Some(line), Some(by_s)) = (flown.as_object_mut(), unavoidable_s) {
                line.insert("unavoidable_by_s".into(), json!(by_s));
            }
            flown
        }
        Err(error) => json!({ "mission": k, "error": error }),
    }
}

/// When a mission collided, if no way could have avoided that.
fn unavoidable_s(fleet: &Fleet, k: u64, summary: &Summary) -> Option<f64> {
    let (routes, paths) = planners();
    let driver = Stepped::new(&routes, &paths);
    let scenario = fleet.scenario(k).ok()?;
    auv_sim::unavoidable_s(&scenario, &driver, &summary.judgement).ok()?
}

fn planners() -> (GaRoute, PsoPath) {
    (
        GaRoute::new(GaSettings::default()),
        PsoPath::new(PathSearch::default()),
    )
}

fn watch(fleet: &Fleet, k: u64, recorder: &mut dyn Recorder) -> Result<Summary, String> {
    let (routes, paths) = planners();
    let driver = Stepped::new(&routes, &paths);
    let scenario = fleet.scenario(k)?;
    simulate(&scenario, &driver, recorder).map_err(|error| error.to_string())
}
