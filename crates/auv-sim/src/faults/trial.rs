//! The judgement of a run with faults.

use super::FaultResponse;
use crate::oracle::{Sea, Verdict};
use crate::{MissionOutcome, Summary};
use auv_mission::RouteReason;

/// A run with faults, judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The response to the faults.
    pub response: FaultResponse,
    /// Everything that must not happen and did; empty for a successful run.
    pub failures: Vec<String>,
    /// When the faults started, mission time in seconds. `None` for a fault on loading, or if the mission
    /// ended before.
    pub started_s: Option<f64>,
    /// The summary of the mission, if it was flown.
    pub summary: Option<Summary>,
    /// For a collision that no manoeuvre since the start of the faults could have avoided, as the
    /// [oracle](crate::oracle) proves: the latest time by which the vehicle must have collided, mission time
    /// in seconds. Such a collision is not a failure.
    pub unavoidable_by_s: Option<f64>,
}

impl Trial {
    /// The judgement of a fault on loading.
    pub(super) fn loaded(response: FaultResponse, failures: Vec<String>) -> Self {
        Self {
            response,
            failures,
            started_s: None,
            summary: None,
            unavoidable_by_s: None,
        }
    }

    /// The judgement of a flown mission; `expected` is the most severe response allowed.
    pub(super) fn flown(
        summary: Summary,
        started_s: Option<f64>,
        expected: FaultResponse,
        mut failures: Vec<String>,
    ) -> Self {
        let response = response_of(&summary, started_s);
        match summary.outcome {
            MissionOutcome::Collided if summary.judgement.groundings > 0 => {
                failures.push(format!("collided: {}", summary.reason));
            }
            MissionOutcome::Late | MissionOutcome::Aborted
                if expected < FaultResponse::FellBack =>
            {
                failures.push(format!("{}: {}", summary.outcome, summary.reason));
            }
            _ => {}
        }
        let numbers = [
            summary.time_s,
            summary.remaining_s,
            summary.mission_weight,
            summary.judgement.min_clearance_m,
        ];
        if numbers.iter().any(|x| x.is_nan()) {
            failures.push("the summary holds a value that is not a number".into());
        }
        failures.extend(super::witness::check_tables(
            &summary.route_calls,
            &summary.path_calls,
        ));
        Self {
            response,
            failures,
            started_s,
            summary: Some(summary),
            unavoidable_by_s: None,
        }
    }

    /// Judges a collision: whether the vehicle could have escaped after the faults started.
    pub(super) fn ask_oracle(&mut self, sea: &Sea) {
        let Some(judgement) = self.summary.as_ref().map(|summary| &summary.judgement) else {
            return;
        };
        if judgement.collisions == 0 {
            return;
        }
        let hit_s = judgement.first_collision_s;
        let since_faults = self.started_s.is_some_and(|started_s| hit_s >= started_s);
        if let (true, Verdict::NoEscape { by_s }) = (since_faults, sea.escape(0)) {
            self.unavoidable_by_s = Some(by_s);
            return;
        }
        let until = sea.last_escape_s(hit_s);
        let escape = until.map_or_else(
            || "the oracle can neither find an escape nor rule it out".into(),
            |time_s| format!("an escape existed until {time_s:.0} s"),
        );
        self.failures
            .push(format!("collided: touched an obstacle; {escape}"));
    }

    /// Whether the run has no failures.
    #[must_use]
    pub fn is_in_order(&self) -> bool {
        self.failures.is_empty()
    }
}

/// The response to the faults according to the tables of calls.
fn response_of(summary: &Summary, started_s: Option<f64>) -> FaultResponse {
    let Some(started_s) = started_s else {
        return FaultResponse::Unchanged;
    };
    let fell_back = summary.outcome != MissionOutcome::Docked
        || summary.route_calls.iter().any(|call| {
            let way_home = !call.valid && !call.adopted && call.route_weight <= 0.0;
            call.at_s >= started_s && (way_home || call.reason == RouteReason::SonarLost)
        });
    let replanned = summary.path_calls.iter().any(|leg| {
        leg.at_s + leg.leg_s >= started_s
            && (leg.replanned_paths > 0 || leg.leg_s > leg.expected_s + 1e-6)
    });
    if fell_back {
        FaultResponse::FellBack
    } else if replanned {
        FaultResponse::Replanned
    } else {
        FaultResponse::Unchanged
    }
}
