//! The mission flown in the sea as forecast, before its launch.
//!
//! A route at the launch is not all that is flown: later routes add work that it had no room for, fixes at the
//! surface interrupt legs and work, and fences close and open. The synchroniser knows all that, so it flies the
//! mission here: over the charted bed, in the forecast current, among the fences, without obstacles and errors.

use super::expected::Expected;
use crate::{MissionOutcome, Scenario, Simulation, Summary};
use auv_mission::driver::Stepped;
use auv_mission::{Activity, Mission, PathCall, Stop};
use auv_planning::TaskDone;
use auv_types::Violations;

/// A mission that is not home after so many budgets is not flown further.
const MOST_BUDGETS: f64 = 2.0;

/// How a rehearsed mission went.
pub(super) enum Rehearsal {
    /// It came home in time.
    InTime(Expected),
    /// It came home so many seconds late.
    Late(Expected, f64),
    /// It ended elsewhere, as told.
    Failed(String),
}

/// Rehearses a mission.
pub(super) fn rehearse(scenario: &Scenario, driver: &Stepped<'_>) -> Rehearsal {
    fly(scenario, driver).unwrap_or_else(|violations| Rehearsal::Failed(violations.to_string()))
}

fn fly(scenario: &Scenario, mut driver: &Stepped<'_>) -> Result<Rehearsal, Violations> {
    let sea = scenario.clone().in_forecast_sea()?;
    let mut simulation = Simulation::new(&sea)?.without_errors_of_place();
    let mut watch = Watch::new(&sea.mission);
    loop {
        let (activity, since_s) = (simulation.synchroniser().activity(), simulation.time_s());
        let over = simulation.step(&mut driver, &mut ())?;
        watch.passed(activity, since_s, &simulation);
        if simulation.time_s() > MOST_BUDGETS * sea.mission.budget_s {
            let text = format!("not home after {MOST_BUDGETS} times its budget_s");
            return Ok(Rehearsal::Failed(text));
        }
        let Some(Summary {
            outcome,
            reason,
            remaining_s,
            ..
        }) = over
        else {
            continue;
        };
        return Ok(match outcome {
            MissionOutcome::Docked => Rehearsal::InTime(watch.expected),
            MissionOutcome::Late => Rehearsal::Late(watch.expected, -remaining_s),
            MissionOutcome::Collided | MissionOutcome::Aborted => {
                Rehearsal::Failed(format!("{outcome}: {reason}"))
            }
        });
    }
}

/// What is seen of a mission under way.
struct Watch<'m> {
    mission: &'m Mission,
    expected: Expected,
    /// Legs seen.
    legs: usize,
    /// Of the leg being flown: when its waypoint was reached, and how long the vehicle was up for fixes and was
    /// held by the current.
    arrived_s: Option<f64>,
    fixes_s: f64,
    holds_s: f64,
}

impl<'m> Watch<'m> {
    fn new(mission: &'m Mission) -> Self {
        let start = Stop {
            node: mission.start,
            arrive_s: mission.launch_s,
            leave_s: mission.launch_s,
            timed: Vec::new(),
            fixes_s: 0.0,
            waits_s: 0.0,
        };
        Self {
            mission,
            expected: Expected::route(mission, vec![start]),
            legs: 0,
            arrived_s: None,
            fixes_s: 0.0,
            holds_s: 0.0,
        }
    }

    /// Time passed in which the vehicle did something.
    fn passed(&mut self, activity: Activity, since_s: f64, simulation: &Simulation<'_>) {
        let now_s = simulation.time_s();
        match activity {
            Activity::UnderWay { arrives_s } if arrives_s <= now_s => {
                self.arrived_s.get_or_insert(arrives_s);
            }
            Activity::AtWaypoint => {
                self.arrived_s.get_or_insert(since_s);
            }
            Activity::Surfacing => self.fixes_s += now_s - since_s,
            Activity::Holding => self.holds_s += now_s - since_s,
            _ => {}
        }
        let synchroniser = simulation.synchroniser();
        for leg in &synchroniser.path_calls()[self.legs..] {
            if leg.completed {
                self.reached(leg, now_s, synchroniser.timed_done());
            }
            self.arrived_s = None;
        }
        self.legs = synchroniser.path_calls().len();
    }

    /// A leg is over, its work done. `done` are the tasks of the time model done so far.
    fn reached(&mut self, leg: &PathCall, now_s: f64, done: &[TaskDone]) {
        let stops = &mut self.expected.stops;
        let known: usize = stops.iter().map(|stop| stop.timed.len()).sum();
        let timed = done[known..].to_vec();
        let arrive_s = self.arrived_s.map_or(now_s, |at_s| at_s.min(now_s));
        if let Some(left) = stops.last_mut() {
            left.leave_s += self.holds_s;
            left.waits_s += self.holds_s;
        }
        stops.push(Stop {
            node: leg.to,
            arrive_s,
            leave_s: now_s,
            waits_s: waits_s(self.mission, &timed, arrive_s),
            timed,
            fixes_s: self.fixes_s,
        });
        let arc = self.mission.network.arc_between(leg.from, leg.to);
        self.expected.arcs.push(arc);
        (self.fixes_s, self.holds_s) = (0.0, 0.0);
    }
}

/// How long a vehicle that arrives at a time waits for the windows of work, seconds.
fn waits_s(mission: &Mission, done: &[TaskDone], arrive_s: f64) -> f64 {
    let Some((model, (last, before))) = mission.time_model.as_ref().zip(done.split_last()) else {
        return 0.0;
    };
    let takes_s = |done: &TaskDone| model.tasks[done.task].task.completion_time_s;
    let works_s: f64 = before.iter().map(takes_s).sum();
    (last.start_s - arrive_s - works_s).max(0.0)
}
