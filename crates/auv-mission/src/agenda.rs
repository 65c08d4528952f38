//! Work with windows and order: what a route is asked to do, and what a leg does at its end.

use crate::{Mission, RouteRequest};
use auv_graph::{EdgeId, NodeId, Route, TaskPlace, TimeModel, TimedTask};
use auv_planning::{Schedule, TaskDone};

/// The tasks of a route that departs at a mission time and may do the open tasks. In flight a mandatory task is
/// worth more than all others together: if one cannot be done any more the rest still is.
pub(crate) fn tasks(whole: &TimeModel, open: &[usize], departs_s: f64) -> Vec<TimedTask> {
    let of_choice = whole.tasks.iter().filter(|task| !task.mandatory);
    let all = 1.0 + of_choice.map(|task| task.task.weight()).sum::<f64>();
    let tasks = open.iter().map(|&i| {
        let mut task: TimedTask = whole.tasks[i].clone();
        task.windows.retain(|window| window[1] >= departs_s);
        for window in &mut task.windows {
            *window = window.map(|time_s| time_s - departs_s);
        }
        if task.mandatory {
            task.mandatory = false;
            task.task.priority += all * task.task.risk;
        }
        let before = task.after.iter();
        task.after = before
            .filter_map(|before| open.iter().position(|task| task == before))
            .collect();
        task
    });
    tasks.collect()
}

/// The first of the tasks that the route in force does which are done at the end of a leg.
pub(crate) fn due_at(
    mission: &Mission,
    due: &[usize],
    to: NodeId,
    edge: Option<EdgeId>,
) -> Vec<usize> {
    let Some(model) = &mission.time_model else {
        return Vec::new();
    };
    let is_here = |task: &&usize| is_at(&model.tasks[**task], to, edge);
    due.iter().take_while(is_here).copied().collect()
}

fn is_at(task: &TimedTask, to: NodeId, edge: Option<EdgeId>) -> bool {
    match task.place {
        TaskPlace::Node(node) => node == to,
        TaskPlace::Edge(on) => Some(on) == edge,
    }
}

/// The same tasks of a request's model with those at one place in the order in which their windows close.
pub(crate) fn by_deadline(asked: &RouteRequest, due: &[usize]) -> Vec<usize> {
    let tasks = asked.time_model.as_ref().map_or(&[][..], |m| &m.tasks);
    let mut due: Vec<usize> = due.iter().copied().filter(|&i| i < tasks.len()).collect();
    let may_swap = |&a: &usize, &b: &usize| {
        let is_free = |i: usize| tasks[i].chain.is_none();
        tasks[a].place == tasks[b].place && is_free(a) && is_free(b)
    };
    let closes_s = |i: usize| tasks[i].windows.last().map_or(f64::INFINITY, |w| w[1]);
    for here in due.chunk_by_mut(may_swap) {
        here.sort_by(|&a, &b| closes_s(a).total_cmp(&closes_s(b)));
    }
    due
}

/// The earliest times of a route that does these tasks of a request's model, in order, as [`stay`] does: without
/// those whose windows are over and those that come after them. `None` where it does not pass the tasks so.
pub(crate) fn schedule(asked: &RouteRequest, route: &Route, mut due: &[usize]) -> Option<Schedule> {
    let (model, network) = (asked.time_model.as_ref()?, &asked.network);
    let mut schedule = Schedule::default();
    let mut now_s = 0.0;
    for pair in route.nodes().windows(2) {
        schedule.departures_s.push(now_s);
        let arc = network.arc_between(pair[0], pair[1])?;
        let edge = Some(network.arcs()[arc.index()].edge);
        now_s += match model.profiles.of(arc) {
            // Edges carry no tasks of their own.
            Some(profile) => profile.travel_s(now_s),
            None => network.arc_time_s(arc, asked.times.as_deref()),
        };
        while let Some((&task, others)) = due.split_first() {
            let known = model.tasks.get(task)?;
            if !is_at(known, pair[1], edge) {
                break;
            }
            due = others;
            let is_done = |before: &usize| schedule.done.iter().any(|done| done.task == *before);
            let is_ready = known.after.iter().all(is_done);
            if let Some(start_s) = begins_s(known, now_s).filter(|_| is_ready) {
                schedule.done.push(TaskDone { task, start_s });
                now_s = start_s + known.task.completion_time_s;
            }
        }
    }
    schedule.end_s = now_s;
    due.is_empty().then_some(schedule)
}

/// How long a vehicle that arrives at a mission time stays for tasks, waiting for their windows included, and
/// which of them it does: those whose windows are not over, after the tasks that they come after.
pub(crate) fn stay(
    mission: &Mission,
    due: &[usize],
    arrives_s: f64,
    has_done: impl Fn(usize) -> bool,
) -> (f64, Vec<TaskDone>) {
    let (mut now_s, mut done) = (arrives_s, Vec::<TaskDone>::new());
    let tasks = mission.time_model.as_ref().map(|model| &model.tasks[..]);
    for &i in due {
        let Some(task) = tasks.and_then(|tasks| tasks.get(i)) else {
            continue;
        };
        let is_done = |&before: &usize| has_done(before) || done.iter().any(|d| d.task == before);
        let begins_s = begins_s(task, now_s).filter(|_| task.after.iter().all(is_done));
        let Some(begins_s) = begins_s else {
            continue;
        };
        now_s = begins_s + task.task.completion_time_s;
        done.push(TaskDone {
            task: i,
            start_s: begins_s,
        });
    }
    // Work without a duration takes no stay, unless its window is waited for.
    (now_s - arrives_s, done)
}

/// When work begins that could begin at a time; `None` if its windows are over.
fn begins_s(task: &TimedTask, now_s: f64) -> Option<f64> {
    if task.windows.is_empty() {
        return Some(now_s);
    }
    let mut windows = task.windows.iter();
    let next = windows.find(|window| window[1] >= now_s)?;
    Some(now_s.max(next[0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;

    #[test]
    fn a_model_counts_from_the_departure_and_prefers_mandatory_tasks() {
        let fixture = Fixture::with_timed_tasks();
        let whole = fixture.mission.time_model.as_ref().unwrap();
        let tasks = tasks(whole, &[0, 1], 400.0);
        assert_eq!(tasks[0].windows, [[100.0, 200.0]]);
        assert_eq!(tasks[1].after, [0]);
        assert!(tasks[0].task.weight() > tasks[1].task.weight() + 2.0);
        assert!(!tasks[0].mandatory);
    }

    #[test]
    fn a_stay_waits_for_windows_and_leaves_out_what_is_over() {
        let mission = &Fixture::with_timed_tasks().mission;
        let stays = |arrives_s| {
            let (stay_s, done) = stay(mission, &[0, 1], arrives_s, |_| false);
            let done = done.iter().map(|done| (done.task, done.start_s));
            (stay_s, done.collect::<Vec<_>>())
        };
        assert_eq!(stays(90.0), (60.0, vec![(0, 90.0), (1, 120.0)]));
        assert_eq!(stays(450.0), (110.0, vec![(0, 500.0), (1, 530.0)]));
        // What comes after work that is left out is left out too, unless that was done before.
        assert_eq!(stays(601.0), (0.0, vec![]));
        let (stay_s, done) = stay(mission, &[0, 1], 601.0, |task| task == 0);
        assert_eq!((stay_s, done.len(), done[0].task), (30.0, 1, 1));
        let due = due_at(mission, &[0, 1, 2], NodeId(1), None);
        assert_eq!(due, [0, 1]);
        assert_eq!(due_at(mission, &[2], NodeId(2), Some(EdgeId(1))), [2]);
    }
}
