//! The summary of a campaign without faults.

use crate::facts::Facts;
use crate::origin::Origin;
use auv_sim::MissionOutcome;
use auv_sim::faults::FailureRate;
use serde_json::{Value, json};

/// The most missions noted that did not dock or broke a limit.
const NOTED: usize = 20;

/// The counts of a campaign, line by line. Its size does not grow with the lines but by 8 bytes each.
pub(crate) struct MissionTally {
    origin: Origin,
    obstacles: Option<usize>,
    reserve_s: f64,
    missions: u64,
    docked: u64,
    late: u64,
    collided: u64,
    /// Of the collided, those that no way could have avoided.
    unavoidable: u64,
    aborted: u64,
    failed: u64,
    /// Missions that broke a limit.
    limits_broken: u64,
    weight: f64,
    /// Time left above the reserve, seconds.
    remaining_s: Vec<f64>,
    notes: Vec<String>,
}

impl MissionTally {
    pub(crate) const fn new(origin: Origin, obstacles: Option<usize>, reserve_s: f64) -> Self {
        Self {
            origin,
            obstacles,
            reserve_s,
            missions: 0,
            docked: 0,
            late: 0,
            collided: 0,
            unavoidable: 0,
            aborted: 0,
            failed: 0,
            limits_broken: 0,
            weight: 0.0,
            remaining_s: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Counts a line; lines come in order.
    pub(crate) fn count(&mut self, facts: &Facts) {
        self.missions += 1;
        let what = match (facts.flown(), &facts.error) {
            (Some(outcome), _) => {
                self.weight += facts.mission_weight.unwrap_or(0.0);
                let remaining_s = facts.remaining_s.unwrap_or(f64::NAN);
                self.remaining_s.push(remaining_s - self.reserve_s);
                *self.of(outcome) += 1;
                self.unavoidable += u64::from(facts.unavoidable_by_s.is_some());
                self.limits_broken += u64::from(!facts.limits_broken.is_empty());
                format!("{outcome}: {}", facts.reason.as_deref().unwrap_or("-"))
            }
            (None, error) => {
                self.failed += 1;
                format!("{:?}", error.as_deref().unwrap_or("no outcome"))
            }
        };
        let broken = facts.limits_broken.iter();
        let broken: String = broken
            .map(|limit| format!("; limit broken: {limit}"))
            .collect();
        let in_order = facts.flown() == Some(MissionOutcome::Docked) && broken.is_empty();
        if !in_order && self.notes.len() < NOTED {
            let (k, command) = (facts.mission, self.origin.command(facts.mission));
            self.notes
                .push(format!("mission {k} {what}{broken} ({command})"));
        }
    }

    const fn of(&mut self, outcome: MissionOutcome) -> &mut u64 {
        match outcome {
            MissionOutcome::Docked => &mut self.docked,
            MissionOutcome::Late => &mut self.late,
            MissionOutcome::Collided => &mut self.collided,
            MissionOutcome::Aborted => &mut self.aborted,
        }
    }

    /// The first missions that did not dock or broke a limit, with the command that flies each again.
    pub(crate) fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The summary.
    pub(crate) fn json(&mut self) -> Value {
        self.remaining_s.sort_by(f64::total_cmp);
        let flown = self.remaining_s.len();
        let median = self.remaining_s.get(flown / 2).copied().unwrap_or(0.0);
        let rate = FailureRate {
            failures: self.missions - self.docked,
            runs: self.missions,
        };
        let (low, high) = rate.bounds_95();
        json!({
            "missions": self.missions,
            "docked": self.docked,
            "late": self.late,
            "collided": self.collided,
            // Only missions of a file are flown again to find out.
            "unavoidable": self.obstacles.is_none().then_some(self.unavoidable),
            "aborted": self.aborted,
            "failed": self.failed,
            "limits_broken": self.limits_broken,
            "not_docked_95": [low, high],
            "obstacles": self.obstacles,
            "mean_weight": self.weight / flown.max(1) as f64,
            "median_remaining_above_reserve_s": median,
        })
    }

    /// The summary as text.
    pub(crate) fn text(&mut self) -> String {
        let json = self.json();
        let percent = |i: usize| 100.0 * json["not_docked_95"][i].as_f64().unwrap_or(0.0);
        let number = |key: &str| json[key].as_f64().unwrap_or(0.0);
        let mut rows: Vec<(&str, String)> = vec![
            ("missions", self.missions.to_string()),
            ("docked in time", self.docked.to_string()),
            ("late", self.late.to_string()),
            ("collided", self.collided.to_string()),
            ("aborted", self.aborted.to_string()),
            ("failed (no outcome)", self.failed.to_string()),
            ("limits broken", self.limits_broken.to_string()),
            (
                "not docked in time, 95 % bounds",
                format!("{:.3} to {:.3} %", percent(0), percent(1)),
            ),
            (
                "mean weight of tasks done",
                format!("{:.3}", number("mean_weight")),
            ),
            (
                "median time left above the reserve",
                format!("{:.1} s", number("median_remaining_above_reserve_s")),
            ),
        ];
        match self.obstacles {
            Some(obstacles) => rows.push(("obstacles in each sea", obstacles.to_string())),
            None => rows.insert(4, ("of these unavoidable", self.unavoidable.to_string())),
        }
        let line = |(name, value): (&str, String)| format!("{name:<36}{value}\n");
        rows.into_iter().map(line).collect()
    }
}
