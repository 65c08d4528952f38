//! How the mission ended.

use crate::closed_loop::ClosedLoop;
use crate::{EndReason, MissionOutcome, Summary};
use auv_mission::{Contingency, Event, Navigation, Outcome};

impl ClosedLoop<'_> {
    /// The result of the mission, judged by the truth.
    pub(crate) fn summary(&self) -> Summary {
        let synchroniser = &self.synchroniser;
        let ended = synchroniser.outcome().unwrap_or(Outcome::Late);
        let judgement = &self.judgement;
        let (outcome, reason) = match ended {
            _ if judgement.collisions > 0 => (MissionOutcome::Collided, EndReason::TouchedObstacle),
            _ if judgement.groundings > 0 => (MissionOutcome::Collided, EndReason::TouchedSeaBed),
            Outcome::Docked | Outcome::Late if self.is_off_dock() => {
                (MissionOutcome::Aborted, EndReason::OffDock)
            }
            Outcome::Docked => (MissionOutcome::Docked, EndReason::InTime),
            Outcome::Aborted(reason) => {
                let contingency = synchroniser.contingency();
                let contingency =
                    contingency.filter(|c| *c != Contingency::Surface || self.is_up());
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
            timed_done: synchroniser.timed_done().to_vec(),
            mission_weight: synchroniser.weight(),
            tasks: synchroniser.tasks(),
            time_s: self.time_s,
            remaining_s: synchroniser.available_s(),
            route_calls: synchroniser.route_calls().to_vec(),
            path_calls: synchroniser.path_calls().to_vec(),
            climbs: synchroniser.climbs(),
            raised: synchroniser.raised().to_vec(),
            dock_error_m: (ended == Outcome::Docked).then(|| self.dock_error_m()),
            following: self.following.clone(),
            judgement: judgement.clone(),
        }
    }

    /// Distance of the true place from the nearest dock, metres.
    fn dock_error_m(&self) -> f64 {
        let mission = &self.scenario.mission;
        let away_m = mission.all_docks().map(|dock| {
            let place = mission.position_of(dock);
            (self.vehicle.position() - place).norm()
        });
        away_m.fold(f64::INFINITY, f64::min)
    }

    /// Whether the vehicle that believes to have docked was never there by the truth. One that cannot hover leaves
    /// the dock again while it works on a task there.
    fn is_off_dock(&self) -> bool {
        let tolerance_m = self.scenario.mission.docking.tolerance_m;
        self.nearest_dock_m.min(self.dock_error_m())
            > tolerance_m + Navigation::SIGMAS * self.sigma_m()
    }

    /// What the vehicle feels of the dock where it may try more than once.
    pub(in crate::closed_loop) fn dock_contact(&self) -> Option<Event> {
        let mission = &self.scenario.mission;
        let next = self.synchroniser.route().get(1);
        let docks = mission.docking.tries > 1 && next.is_some_and(|&next| mission.is_dock(next));
        docks.then(|| Event::DockContact {
            docked: !self.is_off_dock(),
        })
    }

    /// Takes in the track on the way to the dock.
    pub(in crate::closed_loop) fn note_dock(&mut self) {
        let mission = &self.scenario.mission;
        let next = self.synchroniser.route().get(1);
        let Some(&dock) = next.filter(|&&next| mission.is_dock(next)) else {
            self.nearest_dock_m = f64::INFINITY;
            return;
        };
        let dock = mission.position_of(dock);
        for point in &self.track {
            let away_m = (point.position - dock).norm();
            self.nearest_dock_m = self.nearest_dock_m.min(away_m);
        }
    }

    /// Whether the vehicle is at the surface by the truth.
    fn is_up(&self) -> bool {
        self.vehicle.position().z <= self.scenario.mission.docking.tolerance_m
    }
}
