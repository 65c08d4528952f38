//! How long a leg takes, against what was expected and what the way home leaves.

use crate::leg::Leg;
use crate::{Acceptance, ComputeCharge, ExpectedTime, ReplanPolicy, Synchroniser};

impl Synchroniser {
    /// The time expected of a leg with such a way and task, seconds.
    pub(crate) fn expected_s(&self, travel_s: f64, task_s: f64) -> f64 {
        let charge_s = match self.settings.compute {
            ComputeCharge::None => 0.0,
            ComputeCharge::Fixed { path_s, .. } => path_s,
            ComputeCharge::Measured => {
                let legs = self.state.path_calls.len().max(1) as f64;
                self.state
                    .path_calls
                    .iter()
                    .map(|call| call.compute_s)
                    .sum::<f64>()
                    / legs
            }
        };
        match &self.settings.expected_time {
            ExpectedTime::Strict | ExpectedTime::TravelVsEstimate => travel_s + task_s,
            ExpectedTime::Slack { kappa } => (1.0 + kappa) * travel_s + task_s + charge_s,
            ExpectedTime::Given(list) => list
                .get(self.state.path_calls.len())
                .copied()
                .unwrap_or(f64::INFINITY),
        }
    }

    /// Time of a leg by Eq. 12 so far.
    pub(crate) fn leg_s(&self, leg: &Leg) -> f64 {
        self.state.now_s - leg.started_s + leg.charged_s
    }

    /// Whether the leg has taken longer than expected.
    pub(crate) fn is_late(&self, leg: &Leg) -> bool {
        let task_s = match (&self.settings.expected_time, leg.edge) {
            (ExpectedTime::TravelVsEstimate, Some(edge)) if !leg.task_skipped => {
                self.mission.network.task(edge).completion_time_s
            }
            _ => 0.0,
        };
        // A leg exactly as long as expected is not late, whatever rounding did to its end.
        self.leg_s(leg) - task_s > leg.expected_s + 1e-6
    }

    /// Whether the leg is going to be late for the first time, under the policy that asks then.
    pub(crate) fn is_projected_late(&self, leg: &Leg) -> bool {
        let asks = self.settings.replan == ReplanPolicy::Projected
            && !leg.projected
            && !leg.approaching
            && !self.state.homeward
            && leg.to != self.mission.destination;
        let ahead_s = self.due_s() - self.state.now_s;
        let at_the_end = Leg {
            charged_s: leg.charged_s + ahead_s,
            ..leg.clone()
        };
        asks && self.is_late(&at_the_end)
    }

    /// Whether the rest of the way to the target takes much longer than the straight way would.
    pub(crate) fn goes_a_long_way(&self) -> bool {
        self.state.leg.as_ref().is_some_and(|leg| {
            let straight_s = self.straight_s(&self.mission.position_of(leg.to));
            let rest_s = leg
                .stays_from_s
                .map_or(0.0, |stays_from_s| stays_from_s - self.state.now_s);
            rest_s > (1.0 + self.settings.long_way) * straight_s + 1.0
        })
    }

    /// Whether finishing the leg would leave less time than the quickest way home needs, and leaving
    /// it now would leave more.
    pub(crate) fn runs_short_of_time(&self) -> bool {
        let (Some(leg), Some(in_force)) = (&self.state.leg, &self.state.in_force) else {
            return false;
        };
        if self.state.homeward || self.settings.acceptance == Acceptance::AsClaimed {
            return false;
        }
        let rest_s = if leg.waiting || leg.approaching {
            self.straight_s(&self.mission.position_of(leg.to)) + leg.task_left_s
        } else {
            in_force.end().time_s - self.state.now_s
        };
        let onward_s = self.home_s[leg.to.index()] * (1.0 + self.settings.detour_margin);
        let home_s = rest_s + onward_s + self.settings.planning_s;
        let nothing_to_drop = leg.to == self.mission.destination && leg.task_left_s <= 0.0;
        !nothing_to_drop
            && home_s > self.available_s() - self.mission.reserve_s
            && self.home_from_here_s() < home_s - 1.0
    }

    /// Time of the quickest way home that begins here, seconds.
    fn home_from_here_s(&self) -> f64 {
        self.anchors()
            .into_iter()
            .map(|node| {
                self.straight_s(&self.mission.position_of(node)) + self.home_s[node.index()]
            })
            .fold(f64::INFINITY, f64::min)
            * (1.0 + self.settings.detour_margin)
            + self.settings.planning_s
    }
}
