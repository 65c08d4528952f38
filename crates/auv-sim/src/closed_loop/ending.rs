//! How the mission ended.

use crate::closed_loop::ClosedLoop;
use crate::{EndReason, MissionOutcome, Summary};
use auv_mission::Outcome;

impl ClosedLoop<'_> {
    /// The result of the mission, judged by the truth.
    pub(crate) fn summary(&self) -> Summary {
        let synchroniser = &self.synchroniser;
        let ended = synchroniser.outcome().unwrap_or(Outcome::Late);
        let judgement = &self.judgement;
        let (outcome, reason) = match ended {
            _ if judgement.collisions > 0 => (MissionOutcome::Collided, EndReason::TouchedObstacle),
            _ if judgement.groundings > 0 => (MissionOutcome::Collided, EndReason::TouchedSeaBed),
            Outcome::Docked => (MissionOutcome::Docked, EndReason::InTime),
            Outcome::Aborted(reason) => {
                let contingency = synchroniser.contingency();
                let reason = EndReason::Aborted {
                    reason,
                    contingency,
                };
                (MissionOutcome::Aborted, reason)
            }
            _ => (MissionOutcome::Late, EndReason::AfterBudget),
        };
        Summary {
            outcome,
            reason,
            visited: synchroniser.visited().to_vec(),
            mission_weight: synchroniser.weight(),
            tasks: synchroniser.tasks(),
            time_s: self.time_s,
            remaining_s: synchroniser.available_s(),
            route_calls: synchroniser.route_calls().to_vec(),
            path_calls: synchroniser.path_calls().to_vec(),
            climbs: synchroniser.climbs(),
            raised: synchroniser.raised().to_vec(),
            dock_error_m: (ended == Outcome::Docked).then(|| {
                let dock = synchroniser
                    .mission()
                    .position_of(synchroniser.mission().destination);
                (self.vehicle.position() - dock).norm()
            }),
            following: self.following.clone(),
            judgement: judgement.clone(),
        }
    }
}
