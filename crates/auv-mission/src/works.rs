//! Flying what is done at a waypoint: waits for windows, patterns, stays.

use crate::mode::{Leg, LegMode};
use crate::pattern::changes_of_depth;
use crate::view::View;
use crate::{Manner, due, station_keeping};
use auv_obstacles::TimedPoint;
use auv_planning::{PathProblem, Trajectory};
use auv_types::Vector3;

/// Work that takes no longer is not stayed for, seconds.
const MOMENT_S: f64 = 0.5;
/// Ways to fly the work that are tried: patterns and circles to the right, to the left, wider.
const VARIANTS: usize = 4;

/// Trajectories that do the work at the end of a leg's path, in order of preference; `None` where the vehicle only
/// stays. Each is made when it is asked for.
pub(crate) fn flown<'a>(
    view: View<'a>,
    leg: &Leg,
    asked: &'a PathProblem<'a>,
    path: &'a Trajectory,
) -> Option<impl Iterator<Item = Trajectory> + use<'a>> {
    let manners = &view.mission.manners;
    let due = due::due_of(view, leg);
    let begun = matches!(leg.mode, LegMode::AtTarget { .. });
    if begun || !due.iter().any(|task| manners.contains_key(task)) {
        return None;
    }
    let (_, works) = due::stay(view, &due, path.end().time_s);
    let flown = (0..VARIANTS).filter_map(move |variant| {
        let mut flight = Flight {
            variant,
            whole: Trajectory::hover(path.end(), 0.0),
            velocity: path.end_velocity(),
        };
        for work in &works {
            flight.wait_until(asked, work.start_s)?;
            let task = view.mission.time_model.as_ref()?.tasks.get(work.task)?;
            let manner = manners.get(&work.task).copied().unwrap_or_default();
            flight.work(asked, &manner, task.task.completion_time_s)?;
        }
        Some(flight.whole)
    });
    Some(flown)
}

/// Work that is put together.
struct Flight {
    /// Which of the ways is taken.
    variant: usize,
    whole: Trajectory,
    /// Velocity at its end.
    velocity: Vector3<f64>,
}

impl Flight {
    fn end(&self) -> TimedPoint {
        self.whole.end()
    }

    /// Does a task that takes so long with what is flown in still water.
    fn work(&mut self, asked: &PathProblem<'_>, manner: &Manner, takes_s: f64) -> Option<()> {
        let place = self.end().position;
        let vehicle = &manner.vehicle(asked.vehicle);
        let problem = &PathProblem { vehicle, ..*asked };
        let stay_s = takes_s - manner.takes_s(asked.vehicle, place);
        let change = |flight: &mut Self, depth_m: f64| {
            let ways = changes_of_depth(problem, flight.end(), flight.velocity, depth_m);
            flight.fly(ways)
        };
        if let Some(depth_m) = manner.depth_m {
            change(self, depth_m)?;
        }
        if let Some(pattern) = manner.pattern {
            self.fly(pattern.ways(problem, self.end(), self.velocity))?;
        }
        self.wait_until(problem, self.end().time_s + stay_s)?;
        manner.depth_m.map_or(Some(()), |_| change(self, place.z))
    }

    /// Stays until a time, as nearly as circles allow; at once where that is now.
    fn wait_until(&mut self, problem: &PathProblem<'_>, time_s: f64) -> Option<()> {
        let stay_s = time_s - self.end().time_s;
        if stay_s <= MOMENT_S {
            return Some(());
        }
        let stays = station_keeping::stays(problem, self.end(), self.velocity, stay_s);
        self.fly(stays)
    }

    fn fly(&mut self, ways: impl Iterator<Item = Trajectory>) -> Option<()> {
        let way = ways.take(self.variant + 1).last()?;
        self.whole = self.whole.clone().then(&way).ok()?;
        self.velocity = way.end_velocity();
        Some(())
    }
}
