//! What became of a mission with faults, and whether that is in order.

use super::FaultResponse;
use crate::oracle::{Sea, Verdict};
use crate::{MissionOutcome, Summary};
use auv_mission::RouteReason;

/// One run with faults, judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// What the faults led to.
    pub response: FaultResponse,
    /// Everything that should not have happened; empty: the run is in order.
    pub failures: Vec<String>,
    /// When the faults began, seconds of mission time; `None`: on loading, or the mission ended before.
    pub started_s: Option<f64>,
    /// How the mission went, if it was flown.
    pub summary: Option<Summary>,
    /// Of a vehicle that touched an obstacle: when, whatever had been done since the faults began, it
    /// had done so at the latest, mission time in seconds, as the [oracle](crate::oracle) proves. Such a
    /// collision is no failure.
    pub unavoidable_by_s: Option<f64>,
}

impl Trial {
    /// A fault met on loading.
    pub(super) fn loaded(response: FaultResponse, failures: Vec<String>) -> Self {
        Self {
            response,
            failures,
            started_s: None,
            summary: None,
            unavoidable_by_s: None,
        }
    }

    /// A mission flown; `expected` is the most severe outcome in order.
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
            failures.push("the summary holds what is not a number".into());
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

    /// Judges a vehicle that touched an obstacle: whether there was a way out of the sea as it was since
    /// the faults began.
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
        let way_out = until.map_or_else(
            || "no way out is found, nor that there was none".into(),
            |time_s| format!("there was a way out until {time_s:.0} s"),
        );
        self.failures
            .push(format!("collided: touched an obstacle; {way_out}"));
    }

    /// Whether nothing happened that should not have.
    #[must_use]
    pub fn is_in_order(&self) -> bool {
        self.failures.is_empty()
    }
}

/// What the tables say since the faults began.
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
