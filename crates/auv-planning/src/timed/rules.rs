//! The rules of a route in time that have nothing to do with the clock.

use super::timed_network::{Step, TimedNetwork};

/// Memory of [`keeps_rules`].
#[derive(Clone, Debug, Default)]
pub(super) struct Marks {
    is_on: Vec<bool>,
    /// The place of each task among those done, from 1; 0 if it is not done.
    place: Vec<u32>,
    /// The tasks done, in order.
    order: Vec<u32>,
}

/// Whether steps visit no node twice (a route may end where it starts), do each task once and at its
/// place, after those that it comes after, and keep the chains.
pub(super) fn keeps_rules(tables: &TimedNetwork<'_>, steps: &[Step], marks: &mut Marks) -> bool {
    marks.is_on.clear();
    marks.is_on.resize(tables.nodes(), false);
    marks.place.clear();
    marks.place.resize(tables.works.len(), 0);
    marks.order.clear();
    visits_once(steps, &mut marks.is_on)
        && (0..steps.len()).all(|i| is_done_in_place(tables, steps, i, marks))
        && (0..tables.model.chains.len()).all(|chain| keeps_chain(tables, chain, marks))
}

fn visits_once(steps: &[Step], is_on: &mut [bool]) -> bool {
    let Some(first) = steps.first() else {
        return false;
    };
    let last = steps.len() - 1;
    let end = (0..=last)
        .rev()
        .find(|&i| i == 0 || steps[i - 1].node != steps[i].node);
    let mut at = None;
    for (i, step) in steps.iter().enumerate() {
        if at != Some(step.node) {
            let closes = Some(i) == end && i > 0 && step.node == first.node;
            if std::mem::replace(&mut is_on[step.node as usize], true) && !closes {
                return false;
            }
            at = Some(step.node);
        }
    }
    true
}

fn is_done_in_place(
    tables: &TimedNetwork<'_>,
    steps: &[Step],
    i: usize,
    marks: &mut Marks,
) -> bool {
    let step = steps[i];
    if !step.works() {
        return true;
    }
    let task = step.task as usize;
    let work = &tables.works[task];
    let at_place = if work.is_on_edge {
        let from = steps[..i].iter().rposition(|s| s.node != step.node);
        from.is_some_and(|from| {
            let is_along = |s: &Step| {
                s.works() && tables.works[s.task as usize].is_along(steps[from].node, s.node)
            };
            steps[from + 1..=i].iter().all(is_along)
        })
    } else {
        work.ends[0] == step.node
    };
    let is_taken_earlier =
        is_taken_at_start(tables, steps, i, marks) || is_taken_on_the_way_out(tables, steps, i);
    if !at_place || marks.place[task] != 0 || is_taken_earlier {
        return false;
    }
    let before = &tables.model.tasks[task].after;
    if before.iter().any(|&other| marks.place[other] == 0) {
        return false;
    }
    marks.order.push(step.task);
    marks.place[task] = marks.order.len() as u32;
    true
}

/// Whether a task that is done where the route ends would be taken for one done where it starts, the same
/// node: no task elsewhere comes before it.
fn is_taken_at_start(tables: &TimedNetwork<'_>, steps: &[Step], i: usize, marks: &Marks) -> bool {
    let start = steps[0].node;
    let at_start = |task: u32| {
        let work = &tables.works[task as usize];
        !work.is_on_edge && work.ends[0] == start
    };
    at_start(steps[i].task)
        && steps[..i].iter().any(|step| step.node != start)
        && marks.order.iter().all(|&task| at_start(task))
}

/// Whether a task on an edge that is passed back at once would be taken for one done on the way out: no
/// task at the far node comes before it.
fn is_taken_on_the_way_out(tables: &TimedNetwork<'_>, steps: &[Step], i: usize) -> bool {
    let start = steps[0].node;
    let work = |step: &Step| &tables.works[step.task as usize];
    let mut before = steps[..i]
        .iter()
        .filter(|step| step.node != start)
        .peekable();
    let ends = work(&steps[i]).ends;
    work(&steps[i]).is_on_edge
        && !work(&steps[i]).is_one_way
        && steps[i].node == start
        && before.peek().is_some()
        && before.all(|s| ends.contains(&s.node) && (!s.works() || work(s).is_on_edge))
}

/// Whether the tasks done of a chain are neighbours, in the order listed or reversed, with no other task
/// between; and all of them, unless the chain may be split.
fn keeps_chain(tables: &TimedNetwork<'_>, chain: usize, marks: &Marks) -> bool {
    let places = tables
        .model
        .chain_tasks(chain)
        .map(|task| marks.place[task]);
    let places: Vec<u32> = places.collect();
    let Some(first) = places.iter().position(|&place| place != 0) else {
        return true;
    };
    let done = places.iter().filter(|&&place| place != 0).count();
    let run = &places[first..(first + done).min(places.len())];
    let forwards = run.windows(2).all(|pair| pair[0] + 1 == pair[1]);
    let backwards = run.windows(2).all(|pair| pair[0] == pair[1] + 1);
    let is_run = run.len() == done && run.iter().all(|&place| place != 0);
    is_run
        && (forwards || backwards)
        && (tables.model.chains[chain].may_split || done == places.len())
}
