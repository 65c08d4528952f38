//! The trajectory in force: what may go into it, and whether it is still good.

use crate::{Acceptance, Command, PathRequest, Synchroniser, check, stay};
use auv_obstacles::TimedPoint;
use auv_planning::motion::least_clearance;
use auv_planning::{Planned, Trajectory};
use auv_types::Point3;
use std::sync::Arc;

/// Times as near as this are the same, seconds.
const MOMENT_S: f64 = 1e-9;

impl Synchroniser {
    /// The whole trajectory, stay included, if it may go into force, and when its stay begins.
    pub(crate) fn accepted(
        &self,
        asked: &PathRequest,
        planned: &Planned<Trajectory>,
    ) -> Option<(Trajectory, f64)> {
        let leg = self.state.leg.as_ref()?;
        let path = &planned.best;
        let now_s = self.state.now_s;
        let too_late = asked.departure_s < now_s
            && (self.state.position - path.at(now_s).0).norm() > self.settings.off_track_m;
        // What is flown meanwhile may have changed: the path must begin on it.
        let elsewhere = self.state.in_force.as_ref().is_some_and(|in_force| {
            asked.departure_s > now_s
                && asked.departure_s <= in_force.end().time_s
                && (in_force.at(asked.departure_s).0 - asked.start).norm() > 1e-6
        });
        if too_late || elsewhere {
            return None;
        }
        let arrival_s = path.end().time_s;
        let (stay_s, docking) = match leg.departure.stand_off {
            Some(_) => (self.settings.retry_s, false),
            None => (leg.task_left_s, leg.to == self.mission.destination),
        };
        if self.settings.acceptance == Acceptance::AsClaimed {
            let stay = Trajectory::hover(path.end(), stay_s);
            return Some((path.clone().then(&stay).ok()?, arrival_s));
        }
        let problem = asked.problem();
        let lead = self.lead_to(path.start());
        let leads_there = lead.is_none_or(|lead| self.is_clear(&lead, lead.end().time_s, 0.0));
        if planned.violation > 0.0 || !leads_there || !check::path_is_valid(&problem, path) {
            return None;
        }
        stay::stays(&problem, path.end(), path.end_velocity(), stay_s)
            .into_iter()
            .find_map(|stay| {
                let until_s = stay.end().time_s;
                let clear = least_clearance(
                    &stay,
                    &self.state.regions,
                    (arrival_s, until_s),
                    self.mission.clearance_m,
                );
                let free =
                    docking && stay_s <= 0.0 || clear.clearance_m >= self.mission.clearance_m;
                let whole = path.clone().then(&stay).ok()?;
                (free && (stay.points().len() < 2 || check::is_flyable(&problem, &whole)))
                    .then_some((whole, arrival_s))
            })
    }

    /// Puts a trajectory in force, with what is flown until it begins before it.
    pub(crate) fn follow(&mut self, trajectory: Trajectory, commands: &mut Vec<Command>) {
        let whole = match self.lead_to(trajectory.start()) {
            Some(lead) => lead.then(&trajectory).unwrap_or(trajectory),
            None => trajectory,
        };
        commands.push(Command::Follow(Arc::new(whole.clone())));
        self.state.in_force = Some(whole);
    }

    /// What is flown until a trajectory that begins later does: along what is in force where that leads
    /// there, else straight.
    fn lead_to(&self, start: TimedPoint) -> Option<Trajectory> {
        let now_s = self.state.now_s;
        if start.time_s <= now_s {
            return None;
        }
        let on_the_way = self.state.in_force.as_ref().filter(|in_force| {
            start.time_s <= in_force.end().time_s && in_force.at(start.time_s).0 == start.position
        });
        match on_the_way {
            Some(in_force) => Some(in_force.until(start.time_s).after(now_s)),
            None => Trajectory::new(vec![self.here(), start]).ok(),
        }
    }

    /// Whether the rest of the trajectory in force keeps the mission's clearance as far ahead as is
    /// looked. A vehicle that is off it may be anywhere as near to it as that.
    pub(crate) fn in_force_is_clear(&self) -> bool {
        let until_s = self.state.now_s + self.settings.lookahead_s;
        let off_m = self.off_track_m();
        let lag_m = if off_m > self.settings.off_track_m {
            off_m
        } else {
            0.0
        };
        let in_force = self.state.in_force.as_ref();
        in_force.is_some_and(|in_force| self.is_clear(in_force, until_s, lag_m))
    }

    /// Whether a trajectory keeps the mission's clearance, or what is left of it where the vehicle is,
    /// and `lag_m` more, from now until a time.
    pub(crate) fn is_clear(&self, trajectory: &Trajectory, until_s: f64, lag_m: f64) -> bool {
        let here_m = self.clearance_to_ask_m(self.here());
        let wanted_m = self.mission.clearance_m.min(here_m) + lag_m;
        let (now_s, until_s) = (self.state.now_s, trajectory.end().time_s.min(until_s));
        let nearest = least_clearance(trajectory, &self.state.regions, (now_s, until_s), wanted_m);
        nearest.clearance_m >= wanted_m
    }

    /// Whether the trajectory in force is flown to its end, or there is none.
    pub(crate) fn in_force_is_over(&self) -> bool {
        self.state.now_s >= self.due_s() - MOMENT_S
    }

    /// Whether the vehicle is where the trajectory in force has it now, or as good as there.
    pub(crate) fn is_on_track(&self) -> bool {
        self.off_track_m() <= self.settings.off_track_m
    }

    /// How far the vehicle is from where the trajectory in force has it now, metres.
    fn off_track_m(&self) -> f64 {
        self.state
            .in_force
            .as_ref()
            .map_or(f64::INFINITY, |in_force| {
                (self.state.position - in_force.at(self.state.now_s).0).norm()
            })
    }

    /// The vehicle's place now.
    pub(crate) fn here(&self) -> TimedPoint {
        TimedPoint::new(self.state.position, self.state.now_s)
    }

    /// Time to a place straight through still water, seconds.
    pub(crate) fn straight_s(&self, place: &Point3<f64>) -> f64 {
        (place - self.state.position).norm() / self.mission.vehicle.speed_mps
    }
}
