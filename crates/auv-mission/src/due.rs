//! The work of a mission planned in time, as it stands.

use crate::agenda::{self, due_at};
use crate::mode::{Leg, LegMode};
use crate::view::View;
use auv_graph::{NodeId, TaskPlace};
use auv_planning::TaskDone;

/// The tasks that a route from a waypoint can still do, by index in the mission's model: not done, not at the
/// waypoint itself, with a window that is not over, and after tasks that are done or can be. `doing` are done
/// by the leg being flown.
pub(crate) fn open(view: View<'_>, departs_s: f64, start: NodeId, doing: &[usize]) -> Vec<usize> {
    let Some(model) = &view.mission.time_model else {
        return Vec::new();
    };
    let done = |task: &usize| view.state.ledger.has_done(*task) || doing.contains(task);
    let is_open = |&i: &usize| {
        let task = &model.tasks[i];
        let in_time = |window: &[f64; 2]| window[1] >= departs_s;
        let has_window = task.windows.is_empty() || task.windows.iter().any(in_time);
        !done(&i) && task.place != TaskPlace::Node(start) && has_window
    };
    let mut open: Vec<usize> = (0..model.tasks.len()).filter(is_open).collect();
    loop {
        let ready = |before: &usize| done(before) || open.contains(before);
        let kept = |&i: &usize| model.tasks[i].after.iter().all(ready);
        let next: Vec<usize> = open.iter().copied().filter(kept).collect();
        if next.len() == open.len() {
            return open;
        }
        open = next;
    }
}

/// How long the leg's work takes at its end if the vehicle arrives at a mission time, seconds.
pub(crate) fn stay_of(view: View<'_>, leg: &Leg, arrives_s: f64) -> f64 {
    let begun = matches!(leg.mode, LegMode::AtTarget { .. }) || resumes(view, leg);
    if view.mission.time_model.is_none() || begun {
        return leg.task_left_s;
    }
    stay(view, &due_of(view, leg), arrives_s).0
}

/// Whether work of the leg that was interrupted goes on with what is left of it: stays do, what is flown begins
/// again.
pub(crate) fn resumes(view: View<'_>, leg: &Leg) -> bool {
    let is_flown = |task: &usize| view.mission.manners.contains_key(task);
    leg.worked && !due_of(view, leg).iter().any(is_flown)
}

/// How long a vehicle that arrives at a mission time stays for tasks, and which of them it does.
pub(crate) fn stay(view: View<'_>, due: &[usize], arrives_s: f64) -> (f64, Vec<TaskDone>) {
    let has_done = |task| view.state.ledger.has_done(task);
    agenda::stay(view.mission, due, arrives_s, has_done)
}

/// The tasks due at the end of the leg being flown.
pub(crate) fn due_of(view: View<'_>, leg: &Leg) -> Vec<usize> {
    due_at(view.mission, &view.state.due, leg.to, leg.duty.edge())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;

    #[test]
    fn open_tasks_can_still_be_done() {
        let mut fixture = Fixture::with_timed_tasks();
        let at = |fixture: &Fixture, departs_s, start| {
            fixture.view(|view| open(view, departs_s, NodeId(start), &[]))
        };
        assert_eq!(at(&fixture, 0.0, 0), [0, 1, 2]);
        assert_eq!(at(&fixture, 60.0, 0), [0, 1]);
        // What comes after a task that cannot be done any more cannot be done either.
        assert_eq!(at(&fixture, 601.0, 0), [] as [usize; 0]);
        assert_eq!(at(&fixture, 0.0, 1), [2]);
        fixture.state.ledger.done = vec![TaskDone {
            task: 0,
            start_s: 0.0,
        }];
        assert_eq!(at(&fixture, 601.0, 0), [1]);
    }
}
